#include "tensions.h"

int tensions_all_clamped(const fingerfem_segment *segment, const double *tensions, double *held)
{
    int inside = 1;
    for (int k = 0; k < segment->tensions; k++) {
        held[k] = tensions_clamped(segment, k, tensions[k]);
        inside &= held[k] == tensions[k];
    }
    return inside;
}

/* Products, (monomials), of a value of each tension's table, (tensions, TENSIONS_POWERS). */
__attribute__((always_inline)) static inline void products(int t, int monomials, const int32_t *powers, const double *const *tables,
                                                           double *found)
{
    for (int m = 0; m < monomials; m++, powers += t) {
        double product = tables[0][powers[0]];
#pragma GCC unroll 2
        for (int k = 1; k < t; k++) product *= tables[k][powers[k]];
        found[m] = product;
    }
}

void tensions_monomials(const fingerfem_segment *segment, const double *tensions, double *found)
{
    const int t = segment->tensions, all = segment->monomials;
    double values[TENSIONS_MOST][TENSIONS_POWERS], slopes[TENSIONS_MOST][TENSIONS_POWERS];
    const double *tables[TENSIONS_MOST];
    for (int k = 0; k < t; k++) {
        const double scale = 2.0 / (segment->upper[k] - segment->lower[k]);
        tensions_chebyshev(scale * (tensions[k] - segment->lower[k]) - 1.0, segment->most_powers[k], values[k], slopes[k]);
        for (int j = 0; j <= segment->most_powers[k]; j++) slopes[k][j] *= scale;
    }
    for (int j = 0; j <= t; j++) { /* the products, then their derivatives by the tensions */
        for (int k = 0; k < t; k++) tables[k] = k == j - 1 ? slopes[k] : values[k];
        if (t == 2) products(2, all, segment->tension_powers, tables, found + all * j);
        else products(t, all, segment->tension_powers, tables, found + all * j);
    }
}

void tensions_corners(const fingerfem_segment *segment, const double *monomials, double *corners)
{
    double found[FINGERFEM_CORNERS] = {0.0};
    for (int m = 0; m < segment->corner_monomials; m++)
        for (int i = 0; i < FINGERFEM_CORNERS; i++)
            found[i] += monomials[m] * segment->corner_coefficients[FINGERFEM_CORNERS * m + i];
    memcpy(corners, found, sizeof found);
}

void tensions_bent(const fingerfem_segment *segment, const double *corners, const double *p, double *off)
{
    off[0] = off[1] = off[2] = 0.0;
    for (int k = 0; k < FINGERFEM_CORNERS / 3; k++) {
        double share = 1.0;
        for (int i = 0; i < 3; i++) share *= 0.5 * (1.0 + (k >> i & 1 ? 1.0 : -1.0) * p[i] / segment->half_lengths[i]);
        for (int i = 0; i < 3; i++) off[i] += share * corners[3 * k + i];
    }
}

#include "tensions.h"

int tensions_all_held(const fingerfem_segment *segment, const double *tensions, double *held)
{
    int inside = 1;
    for (int k = 0; k < segment->tensions; k++) {
        held[k] = tensions_held(segment, k, tensions[k]);
        inside &= held[k] == tensions[k];
    }
    return inside;
}

void tensions_monomials(const fingerfem_segment *segment, const double *tensions, double *found)
{
    const int t = segment->tensions, all = segment->monomials;
    double values[TENSIONS_MOST][TENSIONS_POWERS], slopes[TENSIONS_MOST][TENSIONS_POWERS];
    for (int k = 0; k < t; k++) {
        const double scale = 2.0 / (segment->upper[k] - segment->lower[k]);
        tensions_chebyshev(scale * (tensions[k] - segment->lower[k]) - 1.0, segment->most_powers[k], values[k], slopes[k]);
        for (int j = 0; j <= segment->most_powers[k]; j++) slopes[k][j] *= scale;
    }
    for (int m = 0; m < all; m++) {
        const int32_t *powers = segment->tension_powers + m * t;
        for (int j = 0; j <= t; j++) { /* the product, then its derivatives by the tensions */
            double product = 1.0;
            for (int k = 0; k < t; k++) product *= (k == j - 1 ? slopes : values)[k][powers[k]];
            found[all * j + m] = product;
        }
    }
}

eight tensions_summed(int monomials, const double *weights, const double *coefficients)
{
    eight even = {0.0}, odd = {0.0};
    int m = 0;
    for (; m + 1 < monomials; m += 2) {
        even += weights[m] * eight_load(coefficients + FINGERFEM_POSE * m);
        odd += weights[m + 1] * eight_load(coefficients + FINGERFEM_POSE * (m + 1));
    }
    for (; m < monomials; m++) even += weights[m] * eight_load(coefficients + FINGERFEM_POSE * m);
    return even + odd;
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

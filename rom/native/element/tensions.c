#include "tensions.h"

int tensions_all_clamped(int count, const double *lower, const double *upper, const double *tensions, double *held)
{
    int inside = 1;
    for (int k = 0; k < count; k++) {
        held[k] = tensions_clamped(lower[k], upper[k], tensions[k]);
        inside &= held[k] == tensions[k];
    }
    return inside;
}

/* Monomials: prod_k table_k[power_mk] over the combinations, with tables (combinations, TENSIONS_POWERS). */
__attribute__((always_inline)) static inline void products(int c, int monomials, const int32_t *powers, const double *const *tables,
                                                           double *found)
{
    for (int m = 0; m < monomials; m++, powers += c) {
        double product = tables[0][powers[0]];
#pragma GCC unroll 2
        for (int k = 1; k < c; k++) product *= tables[k][powers[k]];
        found[m] = product;
    }
}

/* The same products, added to what is there. */
static void add_products(int c, int monomials, const int32_t *powers, const double *const *tables, double *found)
{
    for (int m = 0; m < monomials; m++, powers += c) {
        double product = tables[0][powers[0]];
        for (int k = 1; k < c; k++) product *= tables[k][powers[k]];
        found[m] += product;
    }
}

/* z_k: combination k of the tensions, scaled to [-1, 1]. */
static double combined(const fingerfem_segment *segment, int k, const double *tensions)
{
    const double *row = segment->tension_map + segment->tensions * k;
    double sum = 0.0;
    for (int j = 0; j < segment->tensions; j++) sum += row[j] * tensions[j];
    return 2.0 * (sum - segment->combined_lower[k]) / (segment->combined_upper[k] - segment->combined_lower[k]) - 1.0;
}

void tensions_monomials(const fingerfem_segment *segment, const double *tensions, int rates, double *found)
{
    const int t = rates ? segment->tensions : 0, c = segment->combinations, all = segment->monomials;
    double values[TENSIONS_MOST][TENSIONS_POWERS], slopes[TENSIONS_MOST][TENSIONS_POWERS], by_tension[TENSIONS_MOST][TENSIONS_POWERS];
    const double *tables[TENSIONS_MOST];
    /* Chebyshev polynomials of every z_k, and their slopes */
    for (int k = 0; k < c; k++) {
        tensions_chebyshev(combined(segment, k, tensions), segment->most_powers[k], values[k], slopes[k]);
        tables[k] = values[k];
    }
    /* M_m = prod_k T(z_k); unrolled for two combinations */
    if (c == 2) products(2, all, segment->tension_powers, tables, found);
    else products(c, all, segment->tension_powers, tables, found);
    for (int j = 0; j < t; j++) { /* dM/dF_j = sum_k dM/dz_k dz_k/dF_j, over combinations with F_j */
        double *sum = found + all * (1 + j);
        int first = 1;
        for (int k = 0; k < c; k++) {
            /* scale = dz_k/dF_j */
            const double scale = 2.0 * segment->tension_map[segment->tensions * k + j] / (segment->combined_upper[k] - segment->combined_lower[k]);
            if (scale == 0.0) continue;
            /* products with the derivatives by F_j in place of table k */
            for (int i = 0; i <= segment->most_powers[k]; i++) by_tension[k][i] = scale * slopes[k][i];
            tables[k] = by_tension[k];
            if (first && c == 2) products(2, all, segment->tension_powers, tables, sum);
            else if (first) products(c, all, segment->tension_powers, tables, sum);
            else add_products(c, all, segment->tension_powers, tables, sum);
            tables[k] = values[k];
            first = 0;
        }
        /* a tension in no combination */
        if (first) memset(sum, 0, (size_t)all * sizeof *sum);
    }
}

void tensions_corners(const fingerfem_segment *segment, const double *monomials, double *corners)
{
    double found[FINGERFEM_CORNERS] = {0.0};
    /* corners = sum_m M_m coefficients_m */
    for (int m = 0; m < segment->corner_monomials; m++)
        for (int i = 0; i < FINGERFEM_CORNERS; i++)
            found[i] += monomials[m] * segment->corner_coefficients[FINGERFEM_CORNERS * m + i];
    memcpy(corners, found, sizeof found);
}

void tensions_bent(const fingerfem_segment *segment, const double *corners, const double *p, double *off)
{
    off[0] = off[1] = off[2] = 0.0;
    /* trilinear interpolation: corner k has the share prod_i (1 +- p_i / h_i) / 2 */
    for (int k = 0; k < FINGERFEM_CORNERS / 3; k++) {
        double share = 1.0;
        for (int i = 0; i < 3; i++) share *= 0.5 * (1.0 + (k >> i & 1 ? 1.0 : -1.0) * p[i] / segment->half_lengths[i]);
        for (int i = 0; i < 3; i++) off[i] += share * corners[3 * k + i];
    }
}

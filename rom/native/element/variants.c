/* Every variant deviates by a polynomial of the tensions and the wrench, sum_k coefficients_k M_k(F) P_k(w), as an
 * outline does. The terms of one product of the wrench lie next to each other, so that the tensions are contracted
 * first: this leaves one row of coefficients for every product. Coefficients are single, sums double. */
#include "variants.h"

enum { POSE = FINGERFEM_POSE, W = FINGERFEM_WRENCH };
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias)); /* a pose, among plain numbers */
typedef float singles __attribute__((vector_size(32), aligned(4), may_alias));

int variants_work(const fingerfem_segment *segment)
{
    /* the largest need of any law: its products, and a contracted row for each */
    int found = 0;
    for (int k = 0; k < segment->laws && segment->deviating; k++) {
        const fingerfem_variants *own = segment->variants[k];
        const int size = own->products * (1 + POSE * segment->deviating);
        found = size > found ? size : found;
    }
    return found;
}

/* Products P_p of Chebyshev polynomials, (products), at the wrench clipped to the trained box. */
static void wrench_products(const fingerfem_variants *variants, const double *wrench, double *products)
{
    double values[W][TENSIONS_POWERS], slopes[TENSIONS_POWERS];
    const int32_t *powers = variants->wrench_powers;
    /* polynomials of every component of the clipped wrench */
    for (int i = 0; i < W; i++) {
        const double lower = variants->lower[i], upper = variants->upper[i];
        const double held = wrench[i] < lower ? lower : wrench[i] > upper ? upper : wrench[i];
        tensions_chebyshev(2.0 * (held - lower) / (upper - lower) - 1.0, variants->most_power, values[i], slopes);
    }
    /* P_p = prod_i T(w_i) */
    for (int p = 0; p < variants->products; p++, powers += W)
        products[p] = values[0][powers[0]] * values[1][powers[1]] * values[2][powers[2]] *
                      (values[3][powers[3]] * values[4][powers[4]] * values[5][powers[5]]);
}

/* Add terms first ... last - 1 to all variants, (count, POSE): weight sum_k M_k(F) coefficients_k. The sums are in memory: gcc 12 makes
 * wrong code for such vectors in local variables, without AVX. */
static void add_terms(const fingerfem_variants *variants, int first, int last, double weight, const double *monomials, double *found)
{
    const int count = variants->count;
    const float *from = variants->coefficients + (ptrdiff_t)POSE * count * first;
    /* term k: its weight, times its coefficients of every variant */
    for (int k = first; k < last; k++) {
        const double own = weight * monomials[variants->term_monomials[k]];
        for (int v = 0; v < count; v++, from += POSE)
            *(eight *)(found + POSE * v) += own * __builtin_convertvector(*(const singles *)from, eight);
    }
}

void variants_at(const fingerfem_variants *variants, const double *monomials, const double *wrench, double *work, double *found)
{
    wrench_products(variants, wrench, work);
    memset(found, 0, (size_t)(POSE * variants->count) * sizeof *found);
    /* sum_p P_p times the terms of product p */
    for (int p = 0; p < variants->products; p++)
        if (work[p] != 0.0) add_terms(variants, variants->starts[p], variants->starts[p + 1], work[p], monomials, found);
}

void variants_contract(const fingerfem_variants *variants, const double *monomials, double *work)
{
    const int row = POSE * variants->count;
    double *rows = work + variants->products;
    memset(rows, 0, (size_t)(row * variants->products) * sizeof *rows);
    /* row p: sum of M_k(F) coefficients_k over the terms of product p */
    for (int p = 0; p < variants->products; p++)
        add_terms(variants, variants->starts[p], variants->starts[p + 1], 1.0, monomials, rows + (ptrdiff_t)row * p);
}

void variants_under(const fingerfem_variants *variants, const double *wrench, double *work, double *found)
{
    const int count = variants->count;
    const double *rows = work + variants->products;
    wrench_products(variants, wrench, work);
    memset(found, 0, (size_t)(POSE * count) * sizeof *found);
    /* sum_p P_p(w) row_p */
    for (int p = 0; p < variants->products; p++)
        for (int v = 0; v < count; v++, rows += POSE) *(eight *)(found + POSE * v) += work[p] * *(const eight *)rows;
}

#include "outline.h"
#include <string.h>

enum { W = FINGERFEM_WRENCH, EIGHT = 8, MOST_ROWS = 6 /* eights of a sum that registers hold */ };
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias)); /* among plain numbers */
typedef float singles __attribute__((vector_size(32), aligned(4), may_alias));

/* The largest numbers of corners, products, and contracted coefficients of all laws. */
static void most_of(const fingerfem_segment *segment, int *numbers, int *products, int *contracted)
{
    *numbers = *products = *contracted = 0;
    for (int k = 0; k < segment->laws && segment->knots; k++) {
        const fingerfem_outline *own = segment->outline[k];
        const int all = own->products * own->numbers;
        *products = own->products > *products ? own->products : *products;
        *numbers = own->numbers > *numbers ? own->numbers : *numbers;
        *contracted = all > *contracted ? all : *contracted;
    }
}

int outline_contracted(const fingerfem_segment *segment)
{
    int numbers, products, found;
    most_of(segment, &numbers, &products, &found);
    return found;
}

int outline_work(const fingerfem_segment *segment)
{
    int numbers, products, contracted;
    most_of(segment, &numbers, &products, &contracted);
    return OUTLINE_KNOT * segment->knots + numbers + products + contracted;
}

/* `rows` times eight contracted coefficients of all products from number `first` on: sum of coefficients_k M_k(F) over the terms k of each. */
__attribute__((always_inline)) static inline void contract_rows(const fingerfem_outline *outline, int first, int rows, const double *monomials,
                                                                double *contracted)
{
    const float *from = outline->coefficients + first;
    for (int k = 0; k < outline->terms;) {
        const int product = outline->term_products[k];
        double *own = contracted + outline->numbers * product + first;
        eight sums[MOST_ROWS] = {{0.0}};
        for (; k < outline->terms && outline->term_products[k] == product; k++, from += outline->numbers) {
            const double weight = monomials[outline->term_monomials[k]];
#pragma GCC unroll 6
            for (int i = 0; i < rows; i++) sums[i] += weight * __builtin_convertvector(*(const singles *)(from + EIGHT * i), eight);
        }
#pragma GCC unroll 6
        for (int i = 0; i < rows; i++) *(eight *)(own + EIGHT * i) = sums[i];
    }
}

/* How many eights of those left are computed at once: six, three or one, as registers hold them. */
static int rows_of(int left) { return left >= MOST_ROWS ? MOST_ROWS : left >= 3 ? 3 : 1; }

void outline_contract(const fingerfem_outline *outline, const double *monomials, double *contracted)
{
    for (int first = 0, rows; first < outline->numbers; first += rows * EIGHT) {
        rows = rows_of((outline->numbers - first) / EIGHT);
        if (rows == MOST_ROWS) contract_rows(outline, first, MOST_ROWS, monomials, contracted);
        else if (rows == 3) contract_rows(outline, first, 3, monomials, contracted);
        else contract_rows(outline, first, 1, monomials, contracted);
    }
}

/* Products P_k of Chebyshev polynomials of the wrench, (products); linear beyond the box. */
static void wrench_products(const fingerfem_outline *outline, const double *wrench, double *products)
{
    double values[W][TENSIONS_POWERS], slopes[W][TENSIONS_POWERS], beyond[W];
    const int32_t *powers = outline->wrench_powers;
    int inside = 1;
    /* polynomials of the wrench clipped to the box, and the scaled rest beyond it */
    for (int i = 0; i < W; i++) {
        const double lower = outline->lower[i], upper = outline->upper[i], scale = 2.0 / (upper - lower);
        const double held = wrench[i] < lower ? lower : wrench[i] > upper ? upper : wrench[i];
        tensions_chebyshev(scale * (held - lower) - 1.0, outline->most_power, values[i], slopes[i]);
        beyond[i] = scale * (wrench[i] - held);
        inside &= beyond[i] == 0.0;
    }
    /* P_k = prod_i T(w_i) */
    for (int k = 0; k < outline->products; k++, powers += W)
        products[k] = values[0][powers[0]] * values[1][powers[1]] * values[2][powers[2]] *
                      (values[3][powers[3]] * values[4][powers[4]] * values[5][powers[5]]);
    powers = outline->wrench_powers;
    /* beyond the box: P_k += sum_i dP_k/dw_i beyond_i */
    for (int k = 0; k < outline->products && !inside; k++, powers += W)
        for (int i = 0; i < W; i++) {
            double change = beyond[i];
            for (int j = 0; j < W; j++) change *= j == i ? slopes[j][powers[j]] : values[j][powers[j]];
            products[k] += change;
        }
}

/* Corners, `rows` times eight numbers from number `first` on: sum_k contracted_k P_k(w). */
__attribute__((always_inline)) static inline void sum_products(const fingerfem_outline *outline, int first, int rows,
                                                               const double *contracted, const double *products, double *corners)
{
    const double *from = contracted + first;
    eight sums[MOST_ROWS] = {{0.0}};
    for (int k = 0; k < outline->products; k++, from += outline->numbers)
#pragma GCC unroll 6
        for (int i = 0; i < rows; i++) sums[i] += products[k] * *(const eight *)(from + EIGHT * i);
#pragma GCC unroll 6
    for (int i = 0; i < rows; i++) *(eight *)(corners + first + EIGHT * i) = sums[i];
}

void outline_under(const fingerfem_outline *outline, const double *contracted, const double *wrench, int first, int last, double *work,
                   double *corners)
{
    first -= first % EIGHT;
    wrench_products(outline, wrench, work);
    for (int rows; first < last; first += rows * EIGHT) {
        rows = rows_of((last - first + EIGHT - 1) / EIGHT);
        if (rows == MOST_ROWS) sum_products(outline, first, MOST_ROWS, contracted, work, corners);
        else if (rows == 3) sum_products(outline, first, 3, contracted, work, corners);
        else sum_products(outline, first, 1, contracted, work, corners);
    }
}

void outline_free(const fingerfem_outline *outline, const double *monomials, double *corners)
{
    /* eight numbers at once: sum_m M_m coefficients_m */
    for (int row = 0; row < outline->numbers; row += EIGHT) {
        const double *from = outline->free_coefficients + row;
        eight sum = {0.0};
        for (int m = 0; m < outline->monomials; m++, from += outline->numbers) sum += monomials[m] * *(const eight *)from;
        *(eight *)(corners + row) = sum;
    }
}

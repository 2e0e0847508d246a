#include "element.h"

enum { POSE = FINGERFEM_POSE, BLOCK = FINGERFEM_BLOCK, ROW = FINGERFEM_BLOCK_ROW, W = FINGERFEM_WRENCH, P = ELEMENT_PRODUCT };
enum { THREE = ROW / POSE /* eights of a block's row */, MOST_SETS = 3 /* of sums at once, which registers hold */ };
typedef double four __attribute__((vector_size(32), aligned(8)));

int element_contracted(const fingerfem_segment *segment, const fingerfem_law *law)
{
    return POSE * (law->groups + law->pulled * segment->tensions);
}

int element_products(const fingerfem_segment *segment, const fingerfem_law *law)
{
    (void)segment;
    return P * (law->forces + law->moments);
}

/* Sums of a block's four groups as rows, (4, 8), of which the last two numbers have no meaning. */
static inline void rows_of(const eight *sums, eight *rows)
{
    rows[0] = sums[0];
    rows[1] = EIGHT_OF(sums[0], sums[1], 6, 7, 8, 9, 10, 11, 12, 13);
    rows[2] = EIGHT_OF(sums[1], sums[2], 4, 5, 6, 7, 8, 9, 10, 11);
    rows[3] = EIGHT_OF(sums[2], sums[2], 2, 3, 4, 5, 6, 7, 0, 1);
}

/* Sums of a block by some weights of the monomials at once, (count, stride): a value, if there is any, goes to `places` of
 * `values`, derivatives to those of sets of `slopes`, (rows, 8). The first monomial is 1, and its derivatives are 0. */
__attribute__((always_inline)) static inline void contract_block(const double *from, int count, int monomials, const double *weights,
                                                                 int stride, double *values, const int32_t *places, double *slopes,
                                                                 int set, const int32_t *pulled)
{
    eight sums[MOST_SETS * THREE], rows[BLOCK];
#pragma GCC unroll 9
    for (int i = 0; i < THREE * count; i++) sums[i] = values && i < THREE ? eight_load(from + POSE * i) : (eight){0.0};
    for (int m = 1; m < monomials; m++)
#pragma GCC unroll 3
        for (int i = 0; i < THREE; i++) {
            const eight own = eight_load(from + ROW * m + POSE * i);
#pragma GCC unroll 3
            for (int k = 0; k < count; k++) sums[THREE * k + i] += weights[stride * k + m] * own;
        }
#pragma GCC unroll 3
    for (int k = 0; k < count; k++) {
        rows_of(sums + THREE * k, rows);
#pragma GCC unroll 4
        for (int g = 0; g < BLOCK; g++) {
            if (values && !k) eight_store(values + POSE * places[g], rows[g]);
            else eight_store(slopes + set * (k - !!values) + POSE * pulled[g], rows[g]);
        }
    }
}

void element_contract(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, double *contracted)
{
    const int all = segment->monomials, t = segment->tensions, set = POSE * law->pulled;
    const double *from = law->coefficients;
    double *slopes = contracted + POSE * law->groups;
    for (int block = 0; block < law->groups / BLOCK; block++) {
        const int own = law->block_monomials[block];
        const int32_t *places = law->rows + BLOCK * block, *pulled = law->pulled_rows + BLOCK * block;
        if (own == 1) contract_block(from, 1, 1, monomials, all, contracted, places, slopes, set, pulled);
        else if (t == 1) contract_block(from, 2, own, monomials, all, contracted, places, slopes, set, pulled);
        else contract_block(from, 3, own, monomials, all, contracted, places, slopes, set, pulled);
        for (int j = 2; j < t && own > 1; j += 2) {
            const double *weights = monomials + all * (1 + j);
            if (j + 1 < t) contract_block(from, 2, own, weights, all, NULL, places, slopes + set * j, set, pulled);
            else contract_block(from, 1, own, weights, all, NULL, places, slopes + set * j, set, pulled);
        }
        from += ROW * own;
    }
}

/* Factors of products of a force, and of a moment, (power, 3, 4): the polynomial of component i at number 0, and wherever
 * products have derivatives by other components; its derivative at 1 + i. */
typedef double factors[TENSIONS_POWERS][3][P];

/* Of a wrench inside the box. */
static inline void factors_of(const fingerfem_law *law, const double *wrench, factors force, factors moment)
{
    static const four own[3] = {{0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
    static const four others[3] = {{1.0, 0.0, 1.0, 1.0}, {1.0, 1.0, 0.0, 1.0}, {1.0, 1.0, 1.0, 0.0}};
    const eight lower = eight_load(law->lower), scale = 2.0 / (eight_load(law->upper) - lower);
    const eight z = scale * (eight_load(wrench) - lower) - 1.0;
    eight value = {0.0}, slope = value, before = value, slope_before = value;
    for (int k = 0; k <= law->most_power; k++) { /* T_0 = 1, T_1 = z, T_k = 2 z T_k-1 - T_k-2 */
        const double twice = k > 1 ? 2.0 : 1.0;
        const eight next = k ? twice * z * value - before : value + 1.0;
        const eight slope_next = twice * (scale * value + z * slope) - slope_before;
        double values[POSE], slopes[POSE];
        before = value;
        slope_before = slope;
        eight_store(values, value = next);
        eight_store(slopes, slope = slope_next);
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            const four one = values[i] * others[i] + slopes[i] * own[i], other = values[3 + i] * others[i] + slopes[3 + i] * own[i];
            memcpy(force[k][i], &one, sizeof one);
            memcpy(moment[k][i], &other, sizeof other);
        }
    }
}

/* Products of three factors: value, then derivatives by the three. */
static inline void products_of(int count, const int32_t *places, const factors of, double *products)
{
    const double *from = of[0][0];
    for (int n = 0; n < count; n++, places += 3, products += P) {
        four one, two, three;
        memcpy(&one, from + places[0], sizeof one);
        memcpy(&two, from + places[1], sizeof two);
        memcpy(&three, from + places[2], sizeof three);
        one *= two * three;
        memcpy(products, &one, sizeof one);
    }
}

void element_pose(const fingerfem_law *law, const double *contracted, const double *wrench, double *products, double *pose,
                  double *by_wrench)
{
    factors force, moment;
    double held[POSE] = {0.0}, *moments = products + P * law->forces;
    for (int i = 0; i < W; i++)
        held[i] = wrench[i] < law->lower[i] ? law->lower[i] : wrench[i] > law->upper[i] ? law->upper[i] : wrench[i];
    factors_of(law, held, force, moment);
    products_of(law->forces, law->force_factors, force, products);
    products_of(law->moments, law->moment_factors, moment, moments);
    eight sums[1 + W] = {{0.0}};
    int a = 0;
    for (; a < law->forces && law->moments_of[a] > 1; a++) {
        const double *own = products + P * a;
        const int count = law->moments_of[a];
        eight even[P] = {eight_load(contracted)}, odd[P] = {{0.0}}; /* the first product of the moment is 1 */
        int b = 1;
        for (; b + 1 < count; b += 2) {
            const eight one = eight_load(contracted + POSE * b), next = eight_load(contracted + POSE * (b + 1));
#pragma GCC unroll 4
            for (int i = 0; i < P; i++) {
                odd[i] += moments[P * b + i] * one;
                even[i] += moments[P * (b + 1) + i] * next;
            }
        }
        if (b < count) {
            const eight one = eight_load(contracted + POSE * b);
#pragma GCC unroll 4
            for (int i = 0; i < P; i++) odd[i] += moments[P * b + i] * one;
        }
        contracted += POSE * count;
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) even[i] += odd[i];
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) sums[i] += own[i] * even[0];
#pragma GCC unroll 3
        for (int i = 1; i < P; i++) sums[3 + i] += own[0] * even[i];
    }
    for (; a < law->forces; a++, contracted += POSE) { /* with no moment */
        const eight own = eight_load(contracted);
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) sums[i] += products[P * a + i] * own;
    }
#pragma GCC unroll 6
    for (int i = 0; i < W; i++) {
        sums[0] += (wrench[i] - held[i]) * sums[1 + i];
        eight_store(by_wrench + POSE * i, sums[1 + i]);
    }
    eight_store(pose, sums[0]);
}

void element_by_tensions(const fingerfem_segment *segment, const fingerfem_law *law, const double *contracted,
                         const double *products, double *by_tensions)
{
    const double *moments = products + P * law->forces;
    for (int j = 0; j < segment->tensions; j++) {
        const double *rows = contracted + POSE * (law->groups + law->pulled * j);
        eight sum = {0.0};
        for (int a = 0; a < law->forces; a++) {
            const int count = law->pulled_moments_of[a];
            eight even = {0.0}, odd = {0.0};
            int b = 0;
            for (; b + 1 < count; b += 2) {
                even += moments[P * b] * eight_load(rows + POSE * b);
                odd += moments[P * (b + 1)] * eight_load(rows + POSE * (b + 1));
            }
            if (b < count) even += moments[P * b] * eight_load(rows + POSE * b);
            sum += products[P * a] * (even + odd);
            rows += POSE * count;
        }
        eight_store(by_tensions + POSE * j, sum);
    }
}

/* Sums by some weights of the monomials at once, (count, stride), into (count, 8). */
__attribute__((always_inline)) static inline void free_sums(const fingerfem_law *law, int count, const double *weights, int stride,
                                                            double *found)
{
    eight even[MOST_SETS] = {{0.0}}, odd[MOST_SETS] = {{0.0}};
    int m = 0;
    for (; m + 1 < law->monomials; m += 2) {
        const eight one = eight_load(law->free_coefficients + POSE * m), next = eight_load(law->free_coefficients + POSE * (m + 1));
#pragma GCC unroll 3
        for (int k = 0; k < count; k++) {
            even[k] += weights[stride * k + m] * one;
            odd[k] += weights[stride * k + m + 1] * next;
        }
    }
    for (; m < law->monomials; m++)
#pragma GCC unroll 3
        for (int k = 0; k < count; k++) even[k] += weights[stride * k + m] * eight_load(law->free_coefficients + POSE * m);
#pragma GCC unroll 3
    for (int k = 0; k < count; k++) eight_store(found + POSE * k, even[k] + odd[k]);
}

void element_free(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, double *found)
{
    const int all = segment->monomials, sets = 1 + segment->tensions;
    int k = 0;
    for (; k + 2 < sets; k += 3) free_sums(law, 3, monomials + all * k, all, found + POSE * k);
    for (; k < sets; k++) free_sums(law, 1, monomials + all * k, all, found + POSE * k);
}

int element_inside(const fingerfem_law *law, const double *wrench)
{
    double square = 0.0, largest = 0.0;
    int inside = 1;
    for (int i = 0; i < 3; i++) {
        square += wrench[i] * wrench[i];
        if (law->upper[i] > largest) largest = law->upper[i];
    }
    for (int i = 0; i < W; i++) inside &= law->lower[i] <= wrench[i] && wrench[i] <= law->upper[i];
    return inside && square <= largest * largest * (1.0 + 1e-12);
}

#include "element.h"

enum { POSE = FINGERFEM_POSE, BLOCK = FINGERFEM_BLOCK, ROW = FINGERFEM_BLOCK_ROW, W = FINGERFEM_WRENCH, P = ELEMENT_PRODUCT };
enum { MOST_SETS = 3, THREE = 3 /* wides of each, sums that registers hold */, HALVES = P > WIDE ? 2 : 1 };
typedef double half __attribute__((vector_size(8 * (WIDE < P ? WIDE : P)), aligned(8), may_alias)); /* of a product, or all */

int element_contracted(const fingerfem_segment *segment, const fingerfem_law *law)
{
    return POSE * (law->groups + law->slope_count * segment->tensions);
}

int element_products(const fingerfem_segment *segment, const fingerfem_law *law)
{
    (void)segment;
    return P * (law->forces + law->moments);
}

/* Write the sums of a block, (BLOCK, 6), to its rows of 8 numbers, of which the last two have no meaning. */
static inline void scatter(const double *sums, const int32_t *places, double *rows)
{
#if WIDE == 8 && (defined(__clang__) || __GNUC__ >= 12)
    /* rows of six numbers, out of three vectors of eight */
    const wide one = wide_load(sums), two = wide_load(sums + 8), three = wide_load(sums + 16);
    wide_store(rows + POSE * places[0], one);
    wide_store(rows + POSE * places[1], __builtin_shufflevector(one, two, 6, 7, 8, 9, 10, 11, 12, 13));
    wide_store(rows + POSE * places[2], __builtin_shufflevector(two, three, 4, 5, 6, 7, 8, 9, 10, 11));
    wide_store(rows + POSE * places[3], __builtin_shufflevector(three, three, 2, 3, 4, 5, 6, 7, 0, 1));
#else
    /* row by row, two numbers at once */
#pragma GCC unroll 4
    for (int g = 0; g < BLOCK; g++)
#pragma GCC unroll 3
        for (int i = 0; i < W; i += 2) memcpy(rows + POSE * places[g] + i, sums + W * g + i, 2 * sizeof *rows);
#endif
}

/* Contract a block by `count` sets of weights of the monomials at once, (count, stride): sum_m weight_m coefficients_m.
 * Set 0 gives values in rows `places`, unless `values` is NULL. Every other set gives derivatives in rows
 * `slope_places` of its own set of `slopes`, (rows, 8). The first monomial is 1, and its derivatives are 0. */
__attribute__((always_inline)) static inline void contract_block(const double *from, int count, int monomials,
                                                                 const double *weights, int stride, double *values,
                                                                 const int32_t *places, double *slopes, int set,
                                                                 const int32_t *slope_places)
{
    double found[MOST_SETS][ROW];
#pragma GCC unroll 4
    for (int part = 0; part < ROW; part += THREE * WIDE) {
        wide sums[MOST_SETS * THREE];
        /* begin with the coefficients of the monomial 1 for values, with 0 for derivatives */
#pragma GCC unroll 9
        for (int i = 0; i < THREE * count; i++) sums[i] = values && i < THREE ? wide_load(from + part + WIDE * i) : (wide){0.0};
        /* add the other monomials: sums_k += weight_km coefficients_m */
        for (int m = 1; m < monomials; m++)
#pragma GCC unroll 3
            for (int i = 0; i < THREE; i++) {
                const wide own = wide_load(from + ROW * m + part + WIDE * i);
#pragma GCC unroll 3
                for (int k = 0; k < count; k++) sums[THREE * k + i] += weights[stride * k + m] * own;
            }
#pragma GCC unroll 9
        for (int i = 0; i < THREE * count; i++) wide_store(found[i / THREE] + part + WIDE * (i % THREE), sums[i]);
    }
    /* to the rows of the block's groups */
#pragma GCC unroll 3
    for (int k = 0; k < count; k++) {
        if (values && !k) scatter(found[k], places, values);
        else scatter(found[k], slope_places, slopes + set * (k - !!values));
    }
}

void element_contract(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, int rates, double *contracted)
{
    const int all = segment->monomials, t = rates ? segment->tensions : 0, set = POSE * law->slope_count;
    const double *from = law->coefficients;
    double *slopes = contracted + POSE * law->groups;
    for (int block = 0; block < law->groups / BLOCK; block++) {
        const int own = law->block_monomials[block];
        const int32_t *places = law->rows + BLOCK * block, *slope_places = law->slope_rows + BLOCK * block;
        /* values and derivatives by the first two tensions; with the monomial 1 alone these are 0 */
        if (own == 1 || !rates) contract_block(from, 1, own, monomials, all, contracted, places, slopes, set, slope_places);
        else if (t == 1) contract_block(from, 2, own, monomials, all, contracted, places, slopes, set, slope_places);
        else contract_block(from, 3, own, monomials, all, contracted, places, slopes, set, slope_places);
        /* derivatives by tensions j and j + 1 */
        for (int j = 2; j < t && own > 1; j += 2) {
            const double *weights = monomials + all * (1 + j);
            if (j + 1 < t) contract_block(from, 2, own, weights, all, NULL, places, slopes + set * j, set, slope_places);
            else contract_block(from, 1, own, weights, all, NULL, places, slopes + set * j, set, slope_places);
        }
        from += ROW * own;
    }
}

/* Factors of products of a force, and of a moment, (power, 3, 4), for component i: its derivative is number 1 + i,
 * and all other numbers are its value T_k. So the product of three factors, number by number, is value and gradient. */
typedef double factors[TENSIONS_POWERS][3][P];

/* Chebyshev polynomials T_k of a wrench inside the box, (powers, 8), and their derivatives by the wrench. */
static inline void polynomials(const fingerfem_law *law, const double *wrench, double (*values)[POSE], double (*slopes)[POSE])
{
#pragma GCC unroll 4
    for (int part = 0; part < WIDE * WIDE_SIX; part += WIDE) {
        /* z: the wrench scaled to [-1, 1] */
        const wide lower = wide_load(law->lower + part), scale = 2.0 / (wide_load(law->upper + part) - lower);
        const wide z = scale * (wide_load(wrench + part) - lower) - 1.0;
        wide value = {0.0}, slope = value, before = value, slope_before = value;
        /* recursion; derivatives are dT_k/dw = 2 (scale T_k-1 + z dT_k-1/dw) - dT_k-2/dw */
        for (int k = 0; k <= law->most_power; k++) { /* T_0 = 1, T_1 = z, T_k = 2 z T_k-1 - T_k-2 */
            const double twice = k > 1 ? 2.0 : 1.0;
            const wide next = k ? twice * z * value - before : value + 1.0;
            const wide slope_next = twice * (scale * value + z * slope) - slope_before;
            before = value;
            slope_before = slope;
            wide_store(values[k] + part, value = next);
            wide_store(slopes[k] + part, slope = slope_next);
        }
    }
}

/* Factors of the force and of the moment at a wrench inside the box. */
static inline void factors_of(const fingerfem_law *law, const double *wrench, factors force, factors moment)
{
    static const double own[3][P] = {{0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
    static const double others[3][P] = {{1.0, 0.0, 1.0, 1.0}, {1.0, 1.0, 0.0, 1.0}, {1.0, 1.0, 1.0, 0.0}};
    double values[TENSIONS_POWERS][POSE], slopes[TENSIONS_POWERS][POSE];
    polynomials(law, wrench, values, slopes);
    /* value times `others` plus derivative times `own`, which are 0 or 1 */
    for (int k = 0; k <= law->most_power; k++)
#pragma GCC unroll 6
        for (int i = 0; i < 3 * HALVES; i++) {
            const int c = i / HALVES, part = i % HALVES * P / HALVES;
            const half value = *(const half *)(others[c] + part), slope = *(const half *)(own[c] + part);
            *(half *)(force[k][c] + part) = values[k][c] * value + slopes[k][c] * slope;
            *(half *)(moment[k][c] + part) = values[k][3 + c] * value + slopes[k][3 + c] * slope;
        }
}

/* Products of three factors: the value, then derivatives by the three components. */
static inline void products_of(int count, const int32_t *places, const factors of, double *products)
{
    const double *from = of[0][0];
    for (int n = 0; n < count; n++, places += 3, products += P)
#pragma GCC unroll 2
        for (int part = 0; part < P; part += P / HALVES) {
            const half *one = (const half *)(from + places[0] + part), *two = (const half *)(from + places[1] + part);
            *(half *)(products + part) = *one * *two * *(const half *)(from + places[2] + part);
        }
}

/* A part of the sum over all groups, sum_a A_a(f) sum_b c_ab B_b(m), with products A of the force and B of the
 * moment: of the pose, and of its derivatives by the wrench, (1 + 6, 8). */
static inline void pose_part(const fingerfem_law *law, const double *contracted, const double *products, double *found)
{
    const double *moments = products + P * law->forces;
    wide sums[1 + W] = {{0.0}};
    int a = 0;
    /* with moments: S_0 = sum_b c_ab B_b and its gradient S_1, S_2, S_3, even and odd b in sums of their own */
    for (; a < law->forces && law->moments_of[a] > 1; a++) {
        const double *own = products + P * a;
        const int count = law->moments_of[a];
        wide even[P] = {wide_load(contracted)}, odd[P] = {{0.0}}; /* the first product of the moment is 1 */
        int b = 1;
        for (; b + 1 < count; b += 2) {
            const wide one = wide_load(contracted + POSE * b), next = wide_load(contracted + POSE * (b + 1));
#pragma GCC unroll 4
            for (int i = 0; i < P; i++) {
                odd[i] += moments[P * b + i] * one;
                even[i] += moments[P * (b + 1) + i] * next;
            }
        }
        /* the last b, if one is left */
        if (b < count) {
            const wide one = wide_load(contracted + POSE * b);
#pragma GCC unroll 4
            for (int i = 0; i < P; i++) odd[i] += moments[P * b + i] * one;
        }
        contracted += POSE * count;
        /* S = even + odd; pose and derivatives by the force += A_ai S_0, by the moment += A_a0 S_i */
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) even[i] += odd[i];
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) sums[i] += own[i] * even[0];
#pragma GCC unroll 3
        for (int i = 1; i < P; i++) sums[3 + i] += own[0] * even[i];
    }
    for (; a < law->forces; a++, contracted += POSE) { /* with B_0 = 1 alone */
        const wide own = wide_load(contracted);
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) sums[i] += products[P * a + i] * own;
    }
#pragma GCC unroll 7
    for (int i = 0; i <= W; i++) wide_store(found + POSE * i, sums[i]);
}

void element_pose(const fingerfem_law *law, const double *contracted, const double *wrench, double *products, double *pose)
{
    factors force, moment;
    double held[POSE] = {0.0};
    /* the wrench, clipped to the trained box */
    for (int i = 0; i < W; i++)
        held[i] = wrench[i] < law->lower[i] ? law->lower[i] : wrench[i] > law->upper[i] ? law->upper[i] : wrench[i];
    /* factors, products of force and of moment, then the sums */
    factors_of(law, held, force, moment);
    products_of(law->forces, law->force_factors, force, products);
    products_of(law->moments, law->moment_factors, moment, products + P * law->forces);
    for (int part = 0; part < WIDE * WIDE_SIX; part += WIDE) pose_part(law, contracted + part, products, pose + part);
    /* linear beyond the box: pose += dpose/dw_i (w_i - clipped w_i) */
    for (int i = 0; i < W; i++) {
        const double beyond = wrench[i] - held[i];
        for (int o = 0; o < W && beyond != 0.0; o++) pose[o] += beyond * pose[POSE * (1 + i) + o];
    }
}

void element_by_tensions(const fingerfem_segment *segment, const fingerfem_law *law, const double *contracted,
                         const double *products, double *by_tensions)
{
    const double *moments = products + P * law->forces, *slopes = contracted + POSE * law->groups;
    /* by tension j, in parts: sum_a A_a sum_b dc_ab/dF_j B_b over groups that depend on tensions */
    for (int part = 0; part < WIDE * WIDE_SIX * segment->tensions; part += WIDE) {
        const int j = part / (WIDE * WIDE_SIX), from = part % (WIDE * WIDE_SIX);
        const double *rows = slopes + POSE * law->slope_count * j + from;
        wide sum = {0.0};
        for (int a = 0; a < law->forces; a++) {
            const int count = law->slope_moments_of[a];
            /* inner sum, even and odd b in sums of their own */
            wide even = {0.0}, odd = {0.0};
            int b = 0;
            for (; b + 1 < count; b += 2) {
                even += moments[P * b] * wide_load(rows + POSE * b);
                odd += moments[P * (b + 1)] * wide_load(rows + POSE * (b + 1));
            }
            if (b < count) even += moments[P * b] * wide_load(rows + POSE * b);
            sum += products[P * a] * (even + odd);
            rows += POSE * count;
        }
        wide_store(by_tensions + POSE * j + from, sum);
    }
}

/* Sums without a wrench by `count` sets of weights of the monomials, (count, stride): sum_m weight_m coefficients_m,
 * (count, 8). */
__attribute__((always_inline)) static inline void free_sums(const fingerfem_law *law, int count, const double *weights, int stride,
                                                            double *found)
{
    for (int part = 0; part < WIDE * WIDE_SIX; part += WIDE) {
        const double *from = law->free_coefficients + part;
        wide even[MOST_SETS] = {{0.0}}, odd[MOST_SETS] = {{0.0}};
        /* even and odd m in sums of their own */
        int m = 0;
        for (; m + 1 < law->monomials; m += 2) {
            const wide one = wide_load(from + POSE * m), next = wide_load(from + POSE * (m + 1));
#pragma GCC unroll 3
            for (int k = 0; k < count; k++) {
                even[k] += weights[stride * k + m] * one;
                odd[k] += weights[stride * k + m + 1] * next;
            }
        }
        /* the last m, if one is left */
        for (; m < law->monomials; m++)
#pragma GCC unroll 3
            for (int k = 0; k < count; k++) even[k] += weights[stride * k + m] * wide_load(from + POSE * m);
#pragma GCC unroll 3
        for (int k = 0; k < count; k++) wide_store(found + POSE * k + part, even[k] + odd[k]);
    }
}

void element_free(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, double *found)
{
    const int all = segment->monomials, sets = 1 + segment->tensions;
    int k = 0;
    /* sets of weights: the monomials, then their derivatives by every tension; three at once, then single ones */
    for (; k + 2 < sets; k += 3) free_sums(law, 3, monomials + all * k, all, found + POSE * k);
    for (; k < sets; k++) free_sums(law, 1, monomials + all * k, all, found + POSE * k);
}

int element_inside(const fingerfem_law *law, const double *wrench)
{
    double square = 0.0, largest = 0.0;
    int inside = 1;
    /* |f|^2, and the largest trained component of a force */
    for (int i = 0; i < 3; i++) {
        square += wrench[i] * wrench[i];
        if (law->upper[i] > largest) largest = law->upper[i];
    }
    for (int i = 0; i < W; i++) inside &= law->lower[i] <= wrench[i] && wrench[i] <= law->upper[i];
    return inside && square <= largest * largest * (1.0 + 1e-12);
}

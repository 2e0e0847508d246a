#include "element.h"

enum { POSE = FINGERFEM_POSE, BLOCK = FINGERFEM_BLOCK, W = FINGERFEM_WRENCH, P = ELEMENT_PRODUCT };
typedef double four __attribute__((vector_size(32), aligned(8)));

int element_contracted(const fingerfem_law *law) { return POSE * law->groups; }

int element_products(const fingerfem_law *law) { return P * (law->forces + law->moments); }

int element_work(const fingerfem_law *law) { return POSE * law->monomials + law->groups; }

void element_contract(const fingerfem_law *law, const double *monomials, double *contracted)
{
    const double *from = law->coefficients;
    for (int block = 0; block < law->groups / BLOCK; block++) {
        const int32_t *rows = law->rows + BLOCK * block;
        eight sums[BLOCK];
#pragma GCC unroll 4
        for (int g = 0; g < BLOCK; g++) sums[g] = eight_load(from + POSE * g); /* the first monomial is 1 */
        from += BLOCK * POSE;
        for (int m = 1; m < law->block_monomials[block]; m++, from += BLOCK * POSE)
#pragma GCC unroll 4
            for (int g = 0; g < BLOCK; g++) sums[g] += monomials[m] * eight_load(from + POSE * g);
#pragma GCC unroll 4
        for (int g = 0; g < BLOCK; g++) eight_store(contracted + POSE * rows[g], sums[g]);
    }
}

/* Chebyshev polynomials of the wrench's components, inside the box, by degree, (powers, 8), and their derivatives. */
static void polynomials(const fingerfem_law *law, const double *wrench, double (*values)[POSE], double (*slopes)[POSE])
{
    double scale[POSE];
    for (int i = 0; i < POSE; i++) scale[i] = 2.0 / (law->upper[i] - law->lower[i]);
    const eight slope = eight_load(scale), z = slope * (eight_load(wrench) - eight_load(law->lower)) - 1.0;
    eight before = {0.0}, last = before + 1.0, slope_before = {0.0}, slope_last = {0.0};
    eight_store(values[0], last);
    eight_store(slopes[0], slope_last);
    for (int k = 1; k <= law->most_power; k++) {
        const double twice = k > 1 ? 2.0 : 1.0; /* T_1 = z, T_k = 2 z T_k-1 - T_k-2 */
        const eight now = twice * z * last - before, slope_now = twice * (slope * last + z * slope_last) - slope_before;
        before = last;
        slope_before = slope_last;
        last = now;
        slope_last = slope_now;
        eight_store(values[k], now);
        eight_store(slopes[k], slope_now);
    }
}

/* Products of three components' polynomials, from the first one on: value, then derivatives by the three. */
static void triples(int count, const int32_t *powers, int most, int first, double (*values)[POSE], double (*slopes)[POSE],
                    double *products)
{
    static const four units[3] = {{0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
    four factors[3][TENSIONS_POWERS];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k <= most; k++)
            factors[i][k] = values[k][first + i] + (slopes[k][first + i] - values[k][first + i]) * units[i];
    for (int n = 0; n < count; n++, powers += 3) {
        const four product = factors[0][powers[0]] * factors[1][powers[1]] * factors[2][powers[2]];
        memcpy(products + P * n, &product, sizeof product);
    }
}

void element_pose(const fingerfem_law *law, const double *contracted, const double *wrench, double *products, double *pose,
                  double *by_wrench)
{
    double values[TENSIONS_POWERS][POSE], slopes[TENSIONS_POWERS][POSE], held[POSE] = {0.0};
    double *moments = products + P * law->forces;
    for (int i = 0; i < W; i++)
        held[i] = wrench[i] < law->lower[i] ? law->lower[i] : wrench[i] > law->upper[i] ? law->upper[i] : wrench[i];
    polynomials(law, held, values, slopes);
    triples(law->forces, law->force_powers, law->most_power, 0, values, slopes, products);
    triples(law->moments, law->moment_powers, law->most_power, 3, values, slopes, moments);
    eight sums[1 + W] = {{0.0}};
    for (int a = 0; a < law->forces; a++) {
        const double *force = products + P * a;
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
        const eight own = even[0] + odd[0];
#pragma GCC unroll 4
        for (int i = 0; i < P; i++) sums[i] += force[i] * own;
        if (count > 1)
#pragma GCC unroll 3
            for (int i = 1; i < P; i++) sums[3 + i] += force[0] * (even[i] + odd[i]);
    }
#pragma GCC unroll 6
    for (int i = 0; i < W; i++) {
        sums[0] += (wrench[i] - held[i]) * sums[1 + i];
        eight_store(by_wrench + POSE * i, sums[1 + i]);
    }
    eight_store(pose, sums[0]);
}

void element_by_tensions(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials,
                         const double *products, double *work, double *by_tensions)
{
    const int all = segment->monomials, own = law->monomials, blocks = law->groups / BLOCK, size = BLOCK * POSE;
    const double *from = law->coefficients, *moments = products + P * law->forces;
    double *under = work, *groups = work + POSE * own; /* the wrench contracted; and its products */
    memset(under, 0, (size_t)(POSE * own) * sizeof *under);
    for (int b = 0, next; b < blocks && law->block_monomials[b] > 1; b = next) { /* blocks of as many monomials stay in registers */
        const int count = law->block_monomials[b];
        for (next = b; next < blocks && law->block_monomials[next] == count;) next++;
        for (int g = BLOCK * b; g < BLOCK * next; g++) groups[g] = products[P * law->force_of[g]] * moments[P * law->moment_of[g]];
        for (int m = 1; m < count; m++) { /* the first monomial is 1, whatever the tensions */
            eight sums[BLOCK] = {{0.0}};
            for (int k = 0; k < next - b; k++)
#pragma GCC unroll 4
                for (int g = 0; g < BLOCK; g++)
                    sums[g] += groups[BLOCK * (b + k) + g] * eight_load(from + size * (count * k + m) + POSE * g);
            const eight sum = eight_load(under + POSE * m) + (sums[0] + sums[1]) + (sums[2] + sums[3]);
            eight_store(under + POSE * m, sum);
        }
        from += size * count * (next - b);
    }
    for (int j = 0; j < segment->tensions; j++)
        eight_store(by_tensions + POSE * j, tensions_summed(own, monomials + all * (1 + j), under));
}

void element_free(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, double *pose,
                  double *by_tensions)
{
    const int all = segment->monomials, own = law->monomials;
    eight_store(pose, tensions_summed(own, monomials, law->free_coefficients));
    for (int j = 0; j < segment->tensions; j++)
        eight_store(by_tensions + POSE * j, tensions_summed(own, monomials + all * (1 + j), law->free_coefficients));
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

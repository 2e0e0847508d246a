#include "map.h"

/* Powers of all variables of tensions at once: T_0 ... T_most of each, with derivatives by the tensions [1/N]. */
static void tension_tables(const fingerfem_segment *segment, const double *tensions, double (*values)[MAP_MOST_POWER],
                           double (*slopes)[MAP_MOST_POWER])
{
    const int32_t *most = segment->most_powers;
    for (int k = 0; k < segment->tensions; k++) {
        const double scale = 2.0 / (segment->upper[k] - segment->lower[k]);
        map_chebyshev(scale * (tensions[k] - segment->lower[k]) - 1.0, most[k], values[k], slopes[k]);
        for (int j = 0; j <= most[k]; j++) slopes[k][j] *= scale;
    }
}

/* Sums over the first monomials of `kinds` weights, (kinds, all), times coefficients, for the groups of a block: to,
 * (kinds, stride). Coefficients are read once, whatever is asked of them. */
__attribute__((always_inline)) static inline void contract_block(int kinds, int monomials, int all,
                                                                 const double *restrict weights,
                                                                 const double *restrict from, int stride,
                                                                 double *restrict to)
{
    map_eight sums[1 + MAP_MOST_TENSIONS][FINGERFEM_BLOCK] = {{{0.0}}};
    for (int m = 0; m < monomials; m++) {
#pragma GCC unroll 4
        for (int g = 0; g < FINGERFEM_BLOCK; g++) {
            const map_eight own = map_load(from + FINGERFEM_POSE * (FINGERFEM_BLOCK * m + g));
#pragma GCC unroll 9
            for (int j = 0; j < kinds; j++) sums[j][g] += weights[all * j + m] * own;
        }
    }
#pragma GCC unroll 9
    for (int j = 0; j < kinds; j++)
#pragma GCC unroll 4
        for (int g = 0; g < FINGERFEM_BLOCK; g++) map_store(to + stride * j + FINGERFEM_POSE * g, sums[j][g]);
}

void map_contract(const fingerfem_segment *segment, int kinds, const double *tensions, double *contracted)
{
    const int t = segment->tensions, all = segment->monomials, blocks = segment->groups / FINGERFEM_BLOCK;
    const int size = FINGERFEM_POSE * FINGERFEM_BLOCK, stride = FINGERFEM_POSE * segment->groups;
    double values[MAP_MOST_TENSIONS][MAP_MOST_POWER], slopes[MAP_MOST_TENSIONS][MAP_MOST_POWER];
    double weights[kinds * all];
    tension_tables(segment, tensions, values, slopes);
    for (int m = 0; m < all; m++) {
        const int32_t *powers = segment->tension_powers + m * t;
        for (int j = 0; j < kinds; j++) { /* the product, then its derivatives by the tensions */
            double product = 1.0;
            for (int k = 0; k < t; k++) product *= (k == j - 1 ? slopes : values)[k][powers[k]];
            weights[all * j + m] = product;
        }
    }
    const double *from = segment->coefficients;
    for (int b = 0; b < blocks; b++) {
        const int count = segment->block_monomials[b];
        double *to = contracted + size * b;
        switch (kinds) { /* sums stay in registers where their number is known */
        case 1: contract_block(1, count, all, weights, from, stride, to); break;
        case 2: contract_block(2, count, all, weights, from, stride, to); break;
        case 3: contract_block(3, count, all, weights, from, stride, to); break;
        case 4: contract_block(4, count, all, weights, from, stride, to); break;
        case 5: contract_block(5, count, all, weights, from, stride, to); break;
        default: contract_block(kinds, count, all, weights, from, stride, to);
        }
        from += size * count;
    }
}

/* Products of the wrench's polynomials, (groups, 8): value, derivatives by the six components, 0. Inside the box. */
static void wrench_products(const fingerfem_segment *segment, const double *wrench, double *products)
{
    const double *lower = segment->lower + segment->tensions, *upper = segment->upper + segment->tensions;
    double values[FINGERFEM_WRENCH][MAP_MOST_POWER], slopes[FINGERFEM_WRENCH][MAP_MOST_POWER];
    const int32_t *most = segment->most_powers + segment->tensions;
    for (int i = 0; i < FINGERFEM_WRENCH; i++) {
        const double scale = 2.0 / (upper[i] - lower[i]);
        map_chebyshev(scale * (wrench[i] - lower[i]) - 1.0, most[i], values[i], slopes[i]);
        for (int k = 0; k <= most[i]; k++) slopes[i][k] *= scale;
    }
    static const map_eight units[FINGERFEM_POSE] = {
        {1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 1.0},
        {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0},
    };
    map_store(products, units[0]);
    for (int g = 1; g < segment->groups; g++) {
        const double *parent = products + FINGERFEM_POSE * segment->parents[g];
        const int i = segment->variables[g], power = segment->powers[g];
        const map_eight own = values[i][power] * map_load(parent) + slopes[i][power] * parent[0] * units[1 + i];
        map_store(products + FINGERFEM_POSE * g, own);
    }
}

void map_pose(const fingerfem_segment *segment, const double *coefficients, const double *wrench, double *products,
              double *pose, double *by_wrench)
{
    const double *lower = segment->lower + segment->tensions, *upper = segment->upper + segment->tensions;
    double held[FINGERFEM_WRENCH];
    for (int i = 0; i < FINGERFEM_WRENCH; i++)
        held[i] = wrench[i] < lower[i] ? lower[i] : wrench[i] > upper[i] ? upper[i] : wrench[i];
    wrench_products(segment, held, products);
    map_eight sums[1 + FINGERFEM_WRENCH] = {{0.0}};
    for (int g = 0; g < segment->groups; g++) {
        const map_eight own = map_load(coefficients + FINGERFEM_POSE * g);
        const double *product = products + FINGERFEM_POSE * g;
#pragma GCC unroll 7
        for (int i = 0; i <= FINGERFEM_WRENCH; i++) sums[i] += product[i] * own;
    }
#pragma GCC unroll 6
    for (int i = 0; i < FINGERFEM_WRENCH; i++) {
        sums[0] += (wrench[i] - held[i]) * sums[1 + i];
        map_store(by_wrench + FINGERFEM_POSE * i, sums[1 + i]);
    }
    map_store(pose, sums[0]);
}

void map_free(const fingerfem_segment *segment, const double *contracted, double *pose, double *by_tensions)
{
    for (int j = 0; j <= segment->tensions; j++) {
        const double *from = contracted + FINGERFEM_POSE * segment->groups * j;
        map_eight sum = {0.0};
        for (int k = 0; k < segment->even; k++)
            sum += segment->even_values[k] * map_load(from + FINGERFEM_POSE * segment->even_groups[k]);
        map_store(j ? by_tensions + FINGERFEM_POSE * (j - 1) : pose, sum);
    }
}

int map_inside(const fingerfem_segment *segment, const double *wrench)
{
    const double *lower = segment->lower + segment->tensions, *upper = segment->upper + segment->tensions;
    const double square = wrench[0] * wrench[0] + wrench[1] * wrench[1] + wrench[2] * wrench[2];
    int inside = square <= upper[0] * upper[0] * (1.0 + 1e-12);
    for (int i = 0; i < FINGERFEM_WRENCH; i++) inside &= lower[i] <= wrench[i] && wrench[i] <= upper[i];
    return inside;
}

void map_rotation(const double *pose, double *rotation)
{
    const double w = pose[3], x = pose[4], y = pose[5], z = pose[6], s = 2.0 / (w * w + x * x + y * y + z * z);
    const double found[9] = {
        1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
        s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x),
        s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y),
    };
    memcpy(rotation, found, sizeof found);
}

void map_motion(const double *pose, const double *change, int columns, int k, double *motion)
{
    const double *q = pose, *r = pose + 3, *dq = change, *dr = change + 3;
    const double scale = 2.0 / (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    const double turn[3] = {
        scale * (r[0] * dr[1] - dr[0] * r[1] - (r[2] * dr[3] - r[3] * dr[2])),
        scale * (r[0] * dr[2] - dr[0] * r[2] - (r[3] * dr[1] - r[1] * dr[3])),
        scale * (r[0] * dr[3] - dr[0] * r[3] - (r[1] * dr[2] - r[2] * dr[1])),
    };
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        motion[columns * i + k] = q[j] * turn[l] - q[l] * turn[j] - dq[i];
        motion[columns * (3 + i) + k] = turn[i];
    }
}

int fingerfem_place(const fingerfem_segment *segment, const double *tensions, const double *wrench, double *pose,
                    double *motion)
{
    const int t = segment->tensions, columns = t + FINGERFEM_WRENCH, size = FINGERFEM_POSE * segment->groups;
    double held[MAP_MOST_TENSIONS], contracted[(1 + t) * size], products[size];
    double by_wrench[FINGERFEM_WRENCH * FINGERFEM_POSE];
    int inside = 1;
    for (int k = 0; k < t; k++) {
        held[k] = map_held(segment, k, tensions[k]);
        inside &= held[k] == tensions[k];
    }
    inside &= map_inside(segment, wrench);
    map_contract(segment, 1 + t, held, contracted);
    map_pose(segment, contracted, wrench, products, pose, by_wrench);
    for (int k = 0; k < t; k++) {
        map_eight sum = {0.0};
        for (int g = 0; g < segment->groups; g++)
            sum += products[FINGERFEM_POSE * g] * map_load(contracted + (1 + k) * size + FINGERFEM_POSE * g);
        double change[FINGERFEM_POSE];
        map_store(change, held[k] == tensions[k] ? sum : (map_eight){0.0});
        map_motion(pose, change, columns, k, motion);
    }
    for (int i = 0; i < FINGERFEM_WRENCH; i++)
        map_motion(pose, by_wrench + FINGERFEM_POSE * i, columns, t + i, motion);
    return inside;
}

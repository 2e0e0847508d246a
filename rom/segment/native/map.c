#include "map.h"

void map_monomials(const fingerfem_segment *segment, const double *tensions, double *found)
{
    const int t = segment->tensions, all = segment->monomials;
    double values[MAP_MOST_TENSIONS][MAP_POWERS], slopes[MAP_MOST_TENSIONS][MAP_POWERS];
    for (int k = 0; k < t; k++) {
        const double scale = 2.0 / (segment->upper[k] - segment->lower[k]);
        map_chebyshev(scale * (tensions[k] - segment->lower[k]) - 1.0, segment->most_powers[k], values[k], slopes[k]);
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

void map_contract(const fingerfem_segment *segment, const double *monomials, double *contracted)
{
    const int blocks = segment->groups / FINGERFEM_BLOCK;
    const double *from = segment->coefficients;
    for (int b = 0; b < blocks; b++) {
        map_eight sums[FINGERFEM_BLOCK] = {{0.0}};
        for (int m = 0; m < segment->block_monomials[b]; m++, from += FINGERFEM_BLOCK * FINGERFEM_POSE)
#pragma GCC unroll 4
            for (int g = 0; g < FINGERFEM_BLOCK; g++) sums[g] += monomials[m] * map_load(from + FINGERFEM_POSE * g);
#pragma GCC unroll 4
        for (int g = 0; g < FINGERFEM_BLOCK; g++)
            map_store(contracted + FINGERFEM_POSE * (FINGERFEM_BLOCK * b + g), sums[g]);
    }
}

/* Sums over the monomials of weights, (monomials), times coefficients, (monomials, 8). */
static map_eight summed(int monomials, const double *weights, const double *coefficients)
{
    map_eight even = {0.0}, odd = {0.0};
    int m = 0;
    for (; m + 1 < monomials; m += 2) {
        even += weights[m] * map_load(coefficients + FINGERFEM_POSE * m);
        odd += weights[m + 1] * map_load(coefficients + FINGERFEM_POSE * (m + 1));
    }
    for (; m < monomials; m++) even += weights[m] * map_load(coefficients + FINGERFEM_POSE * m);
    return even + odd;
}

int map_work(const fingerfem_segment *segment)
{
    const int pose = FINGERFEM_POSE * segment->monomials, skin = segment->skin_terms + 2 * segment->skin_numbers;
    return pose > skin ? pose : skin;
}

int32_t fingerfem_segment_memory(const fingerfem_segment *segment)
{
    return 2 * FINGERFEM_POSE * segment->groups + (1 + segment->tensions) * segment->monomials + map_work(segment);
}

void map_by_tensions(const fingerfem_segment *segment, const double *monomials, const double *products, double *work,
                     double *by_tensions)
{
    const int all = segment->monomials, blocks = segment->groups / FINGERFEM_BLOCK;
    const double *from = segment->coefficients;
    double *under = work; /* the wrench contracted */
    memset(under, 0, (size_t)(FINGERFEM_POSE * all) * sizeof *under);
    for (int b = 0, next; b < blocks; b = next) { /* blocks of as many monomials stay in registers */
        const int count = segment->block_monomials[b], size = FINGERFEM_BLOCK * FINGERFEM_POSE;
        for (next = b; next < blocks && segment->block_monomials[next] == count;) next++;
        for (int m = 0; m < count; m++) {
            map_eight sums[FINGERFEM_BLOCK] = {{0.0}};
            for (int k = 0; k < next - b; k++)
#pragma GCC unroll 4
                for (int g = 0; g < FINGERFEM_BLOCK; g++)
                    sums[g] += products[size * (b + k) + FINGERFEM_POSE * g] *
                               map_load(from + size * (count * k + m) + FINGERFEM_POSE * g);
            const map_eight sum = map_load(under + FINGERFEM_POSE * m) + (sums[0] + sums[1]) + (sums[2] + sums[3]);
            map_store(under + FINGERFEM_POSE * m, sum);
        }
        from += size * count * (next - b);
    }
    for (int j = 0; j < segment->tensions; j++)
        map_store(by_tensions + FINGERFEM_POSE * j, summed(all, monomials + all * (1 + j), under));
}

/* Products of the wrench's polynomials, (groups, 8): value, derivatives by the six components, 0. Inside the box. */
static void wrench_products(const fingerfem_segment *segment, const double *wrench, double *products)
{
    const double *lower = segment->lower + segment->tensions, *upper = segment->upper + segment->tensions;
    double values[FINGERFEM_WRENCH][MAP_POWERS], slopes[FINGERFEM_WRENCH][MAP_POWERS];
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

void map_free(const fingerfem_segment *segment, const double *monomials, double *pose, double *by_tensions)
{
    const int all = segment->monomials;
    map_store(pose, summed(all, monomials, segment->free_coefficients));
    for (int j = 0; j < segment->tensions; j++)
        map_store(by_tensions + FINGERFEM_POSE * j, summed(all, monomials + all * (1 + j), segment->free_coefficients));
}

void map_corners(const fingerfem_segment *segment, const double *monomials, double *corners)
{
    double found[FINGERFEM_CORNERS] = {0.0};
    for (int m = 0; m < segment->corner_monomials; m++)
        for (int i = 0; i < FINGERFEM_CORNERS; i++)
            found[i] += monomials[m] * segment->corner_coefficients[FINGERFEM_CORNERS * m + i];
    memcpy(corners, found, sizeof found);
}

void map_bent(const fingerfem_segment *segment, const double *corners, const double *p, double *off)
{
    off[0] = off[1] = off[2] = 0.0;
    for (int k = 0; k < FINGERFEM_CORNERS / 3; k++) {
        double share = 1.0;
        for (int i = 0; i < 3; i++) share *= 0.5 * (1.0 + (k >> i & 1 ? 1.0 : -1.0) * p[i] / segment->half_lengths[i]);
        for (int i = 0; i < 3; i++) off[i] += share * corners[3 * k + i];
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

int fingerfem_place(const fingerfem_segment *segment, const double *tensions, const double *wrench, double *memory,
                    double *pose, double *motion)
{
    const int t = segment->tensions, columns = t + FINGERFEM_WRENCH, size = FINGERFEM_POSE * segment->groups;
    double held[MAP_MOST_TENSIONS], *contracted = memory, *products = memory + size, *monomials = products + size;
    double *work = monomials + (1 + t) * segment->monomials;
    double by_wrench[FINGERFEM_WRENCH * FINGERFEM_POSE], by_tensions[MAP_MOST_TENSIONS * FINGERFEM_POSE];
    int inside = 1;
    for (int k = 0; k < t; k++) {
        held[k] = map_held(segment, k, tensions[k]);
        inside &= held[k] == tensions[k];
    }
    inside &= map_inside(segment, wrench);
    map_monomials(segment, held, monomials);
    map_contract(segment, monomials, contracted);
    map_pose(segment, contracted, wrench, products, pose, by_wrench);
    map_by_tensions(segment, monomials, products, work, by_tensions);
    for (int k = 0; k < t; k++) {
        double *change = by_tensions + FINGERFEM_POSE * k;
        if (held[k] != tensions[k]) memset(change, 0, FINGERFEM_POSE * sizeof *change);
        map_motion(pose, change, columns, k, motion);
    }
    for (int i = 0; i < FINGERFEM_WRENCH; i++)
        map_motion(pose, by_wrench + FINGERFEM_POSE * i, columns, t + i, motion);
    return inside;
}

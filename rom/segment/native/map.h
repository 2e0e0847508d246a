/* The map of a segment in two stages: tensions are contracted once; then the wrench's polynomial is evaluated. */
#ifndef FINGERFEM_MAP_H
#define FINGERFEM_MAP_H
#include <string.h>
#include "segment.h"

#define MAP_POWERS (FINGERFEM_MOST_POWER + 1)
#define MAP_MOST_TENSIONS FINGERFEM_MOST_TENSIONS

/* Eight numbers that are worked on at once, in as many registers as the processor needs for them. */
typedef double map_eight __attribute__((vector_size(64), aligned(8)));

static inline map_eight map_load(const double *from)
{
    map_eight found;
    memcpy(&found, from, sizeof found);
    return found;
}

static inline void map_store(double *to, map_eight value) { memcpy(to, &value, sizeof value); }

/* Chebyshev polynomials T_0 ... T_most at z, and their derivatives. */
static inline void map_chebyshev(double z, int most, double *values, double *slopes)
{
    values[0] = 1.0;
    slopes[0] = 0.0;
    if (most < 1) return;
    values[1] = z;
    slopes[1] = 1.0;
    for (int k = 2; k <= most; k++) {
        values[k] = 2.0 * z * values[k - 1] - values[k - 2];
        slopes[k] = 2.0 * values[k - 1] + 2.0 * z * slopes[k - 1] - slopes[k - 2];
    }
}

/* Tension k within its box; NaN is the lowest. */
static inline double map_held(const fingerfem_segment *segment, int k, double tension)
{
    const double held = tension > segment->lower[k] ? tension : segment->lower[k];
    return held < segment->upper[k] ? held : segment->upper[k];
}

/* Monomials of tensions inside their box, and their derivatives by these, (1 + tensions, monomials). */
void map_monomials(const fingerfem_segment *segment, const double *tensions, double *found);

/* Coefficients of the groups, (groups, 8), at tensions of which the monomials are known, as in what follows. */
void map_contract(const fingerfem_segment *segment, const double *monomials, double *contracted);

/* Pose, (8), and its derivatives by the wrench, (6, 8), from contracted coefficients; linear beyond the box. Products of
 * the wrench's polynomials, (groups, 8), are left in `products`: of each its value, then its derivatives. */
void map_pose(const fingerfem_segment *segment, const double *coefficients, const double *wrench, double *products,
              double *pose, double *by_wrench);

/* Derivatives of the pose by the tensions, (tensions, 8), with the products that `map_pose` has left; `work` is of
 * map_work's size. */
void map_by_tensions(const fingerfem_segment *segment, const double *monomials, const double *products, double *work,
                     double *by_tensions);

/* Numbers of memory that one function of a segment works in at a time. */
int map_work(const fingerfem_segment *segment);

/* Pose, (8), without a wrench, and its derivatives by the tensions, (tensions, 8); the box is as wide to both sides of
 * that. */
void map_free(const fingerfem_segment *segment, const double *monomials, double *pose, double *by_tensions);

/* How far the corners of the plate, bent by the tensions, are from those of a box, (FINGERFEM_CORNERS) [m]; with a row of
 * derivatives of the monomials, how that changes. */
void map_corners(const fingerfem_segment *segment, const double *monomials, double *corners);

/* How far a point p of the plate is off where its corners are, (3), in its frame [m]. */
void map_bent(const fingerfem_segment *segment, const double *corners, const double *p, double *off);

/* Whether a wrench, (6), lies in the trained box, and its force is none larger than was trained. */
int map_inside(const fingerfem_segment *segment, const double *wrench);

/* Rotation, (3, 3), of a pose. */
void map_rotation(const double *pose, double *rotation);

/* Motion v, t, of which column k of `motion`, (6, columns), is to be, by a change of a pose, (8). */
void map_motion(const double *pose, const double *change, int columns, int k, double *motion);
#endif

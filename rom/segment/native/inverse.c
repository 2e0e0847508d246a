#include <math.h>
#include "map.h"
#include "small.h"

#define EVALUATIONS 40
#define MET 1e-9       /* of a pose, turns by half the plate's side [m]: one more step of Newton's is then exact */
#define LONGEST 0.25   /* of the box, that a wrench changes at once */
#define SHORTEST 1e-3  /* share of a step that is tried, before the pose counts as out of reach */

/* The motion from one pose to another, (6), seen from the first. */
static void motion_to(const double *pose, const double *centre, const double *target, double *motion)
{
    double from[9], to[9], turn[9];
    map_rotation(pose, from);
    const double quaternion[7] = {0.0, 0.0, 0.0, target[0], target[1], target[2], target[3]};
    map_rotation(quaternion, to);
    for (int i = 0; i < 3; i++) {
        motion[i] = pose[i];
        for (int k = 0; k < 3; k++) motion[i] += from[3 * k + i] * centre[k];
        for (int j = 0; j < 3; j++) {
            turn[3 * i + j] = 0.0;
            for (int k = 0; k < 3; k++) turn[3 * i + j] += from[3 * k + i] * to[3 * k + j];
        }
    }
    double axis[3], sine = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        axis[i] = 0.5 * (turn[3 * k + j] - turn[3 * j + k]);
        sine += axis[i] * axis[i];
    }
    sine = sqrt(sine);
    const double angle = atan2(sine, 0.5 * (turn[0] + turn[4] + turn[8] - 1.0));
    for (int i = 0; i < 3; i++) motion[3 + i] = sine > 1e-9 ? axis[i] * (angle / sine) : axis[i];
}

static double size_of(const fingerfem_segment *segment, const double *motion)
{
    const double half = segment->half_lengths[1];
    double square = 0.0;
    for (int i = 0; i < 3; i++) square += motion[i] * motion[i] + half * half * motion[3 + i] * motion[3 + i];
    return sqrt(square);
}

int fingerfem_bear(const fingerfem_segment *segment, const double *tensions, const double *centre,
                   const double *quaternion, double *memory, double *wrench, double *stiffness, int32_t *inside)
{
    enum { W = FINGERFEM_WRENCH };
    const int t = segment->tensions, size = FINGERFEM_POSE * segment->groups;
    const double *lower = segment->lower + t, *upper = segment->upper + t;
    double held[MAP_MOST_TENSIONS], *contracted = memory, *products = memory + size, *monomials = products + size;
    double pose[FINGERFEM_POSE], by_wrench[W * FINGERFEM_POSE], yielding[W * W], motion[W], step[W], tried[W];
    double least = INFINITY, share = 1.0;
    *inside = 1;
    for (int k = 0; k < t; k++) {
        held[k] = map_held(segment, k, tensions[k]);
        *inside &= held[k] == tensions[k];
    }
    map_monomials(segment, held, monomials);
    map_contract(segment, monomials, contracted);
    memcpy(tried, wrench, sizeof tried);
    for (int i = 0; i < W; i++)
        if (!isfinite(tried[i])) memset(tried, 0, sizeof tried);
    memcpy(wrench, tried, sizeof tried);
    memset(step, 0, sizeof step);
    memset(stiffness, 0, W * W * sizeof *stiffness);
    for (int evaluations = 1; evaluations <= EVALUATIONS; evaluations++) {
        map_pose(segment, contracted, tried, products, pose, by_wrench);
        motion_to(pose, centre, quaternion, motion);
        const double off = size_of(segment, motion);
        if (!(off < least)) { /* too far: half the way from where it was */
            share *= 0.5;
            if (share < SHORTEST || !isfinite(least)) return -evaluations;
            for (int i = 0; i < W; i++) tried[i] = wrench[i] + share * step[i];
            continue;
        }
        least = off;
        share = 1.0;
        memcpy(wrench, tried, sizeof tried);
        for (int i = 0; i < W; i++) map_motion(pose, by_wrench + FINGERFEM_POSE * i, W, i, yielding);
        double right[W * (W + 1)];
        for (int i = 0; i < W; i++) {
            for (int j = 0; j < W; j++) right[(W + 1) * i + j] = i == j;
            right[(W + 1) * i + W] = motion[i];
        }
        if (!small_solve(W, yielding, W + 1, right)) return -evaluations;
        double longest = 0.0;
        for (int i = 0; i < W; i++) {
            step[i] = right[(W + 1) * i + W];
            longest = fmax(longest, fabs(step[i]) / (LONGEST * (upper[i] - lower[i])));
            for (int j = 0; j < W; j++) stiffness[W * i + j] = right[(W + 1) * i + j];
        }
        if (off < MET) {
            for (int i = 0; i < W; i++) wrench[i] += step[i];
            *inside &= map_inside(segment, wrench);
            return evaluations;
        }
        for (int i = 0; i < W; i++) tried[i] = wrench[i] + (step[i] /= fmax(longest, 1.0));
    }
    return -EVALUATIONS;
}

void fingerfem_spring(const fingerfem_segment *segment, const double *quaternion, const double *wrench,
                      const double *stiffness, double *force, double *seen)
{
    enum { W = FINGERFEM_WRENCH };
    const double size = segment->half_lengths[1], *f = wrench;
    const double pose[7] = {0.0, 0.0, 0.0, quaternion[0], quaternion[1], quaternion[2], quaternion[3]};
    /* The force turns with the plate: R (K dx + turn x f). */
    const double follows[3][3] = {{0.0, f[2], -f[1]}, {-f[2], 0.0, f[0]}, {f[1], -f[0], 0.0}};
    double rotation[9], own[W * W], half[W * W], work[2 * W * W];
    map_rotation(pose, rotation);
    memcpy(own, stiffness, sizeof own);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) own[W * i + 3 + j] += follows[i][j];
    /* Motions along the clamp's axes from both sides, turns by their size. */
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += rotation[3 * (j % 3) + k] * own[W * i + k];
            half[W * i + j] = j < 3 ? sum : own[W * i + j] / size;
        }
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += rotation[3 * (i % 3) + k] * half[W * k + j];
            seen[W * i + j] = i < 3 ? sum : half[W * i + j] / size;
        }
    small_nonnegative(W, seen, work);
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) seen[W * i + j] *= (i < 3 ? 1.0 : size) * (j < 3 ? 1.0 : size);
    for (int i = 0; i < 3; i++) {
        force[i] = rotation[3 * i] * f[0] + rotation[3 * i + 1] * f[1] + rotation[3 * i + 2] * f[2];
        force[3 + i] = wrench[3 + i];
    }
}

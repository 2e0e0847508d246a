/* The pose of a segment's plate under a wrench; and the inverse, the wrench that holds the plate in a pose. */
#include <math.h>
#include "rod_march.h"
#include "../linear_algebra/small.h"

enum { W = FINGERFEM_WRENCH };

#define EVALUATIONS 40 /* most evaluations of the rod */
#define MET 1e-9       /* tolerance of a pose, turns times half the side [m]: one more Newton step is then exact */
#define LONGEST 0.25   /* most change of a wrench in one step, over the width of its box [-] */
#define SHORTEST 1e-3  /* least share of a step that is tried, below which the pose is out of reach [-] */

int fingerfem_place(const fingerfem_segment *segment, const double *tensions, const double *wrench, double *memory,
                    double *centre, double *rotation, double *motion)
{
    const int t = segment->tensions, columns = t + W;
    double held[TENSIONS_MOST], by_tensions[W][TENSIONS_MOST];
    rod_state rod;
    rod_end end;
    /* the rod at the clamped tensions, under the wrench */
    const int within = tensions_all_clamped(segment->tensions, segment->lower, segment->upper, tensions, held);
    rod_set_tensions(segment, held, 1, memory, memory + rod_memory(segment, 0), &rod);
    rod_contract(&rod);
    rod_under(&rod, (rod_part){0, segment->elements}, wrench, 1, &end);
    rod_by_tensions(&rod, (rod_part){0, segment->elements}, by_tensions);
    /* plate seen from the clamp: R = Q^T, c = -Q^T p, with the clamp's p, Q seen from the plate */
    for (int i = 0; i < 3; i++) {
        centre[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            rotation[3 * i + j] = end.rotation[3 * j + i];
            centre[i] -= end.rotation[3 * j + i] * end.place[j];
        }
    }
    /* motion: by tensions, 0 where these are clamped, then by the wrench */
    for (int i = 0; i < W; i++) {
        for (int j = 0; j < t; j++) motion[columns * i + j] = held[j] == tensions[j] ? by_tensions[i][j] : 0.0;
        memcpy(motion + columns * i + t, end.by_wrench[i], sizeof end.by_wrench[i]);
    }
    return within && end.inside;
}

/* The rotation, (3, 3), of a quaternion of any length. */
static void rotation_of(const double *quaternion, double *rotation)
{
    const double w = quaternion[0], x = quaternion[1], y = quaternion[2], z = quaternion[3];
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    const double found[9] = {
        1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
        s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x),
        s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y),
    };
    memcpy(rotation, found, sizeof found);
}

/* The motion that takes a plate to a centre and a rotation, (6): displacement [m] and rotation vector [rad], seen
 * from the plate where it is. The target is seen from the clamp. */
static void motion_to(const rod_end *end, const double *centre, const double *rotation, double *motion)
{
    const double *seen = end->rotation; /* Q of the clamp, seen from the plate */
    double turn[9];
    /* displacement p + Q c and rotation T = Q R */
    for (int i = 0; i < 3; i++) {
        motion[i] = end->place[i];
        for (int k = 0; k < 3; k++) motion[i] += seen[3 * i + k] * centre[k];
        for (int j = 0; j < 3; j++) {
            turn[3 * i + j] = 0.0;
            for (int k = 0; k < 3; k++) turn[3 * i + j] += seen[3 * i + k] * rotation[3 * k + j];
        }
    }
    /* skew part of T: axis times sin(angle); cos(angle) = (tr T - 1) / 2 */
    double axis[3], sine = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        axis[i] = 0.5 * (turn[3 * k + j] - turn[3 * j + k]);
        sine += axis[i] * axis[i];
    }
    sine = sqrt(sine);
    const double angle = atan2(sine, 0.5 * (turn[0] + turn[4] + turn[8] - 1.0));
    /* rotation vector: angle times axis; of a tiny turn the skew part itself */
    for (int i = 0; i < 3; i++) motion[3 + i] = sine > 1e-9 ? axis[i] * (angle / sine) : axis[i];
}

/* Size of a motion [m]: turns count times half the plate's side. */
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
    const int t = segment->tensions;
    const double *lower = segment->lower + t, *upper = segment->upper + t;
    double held[TENSIONS_MOST], target[9], yielding[W * W], motion[W], step[W], tried[W];
    rod_state rod;
    rod_end end;
    double least = INFINITY, share = 1.0;
    /* the rod at the clamped tensions, and the target's rotation */
    *inside = tensions_all_clamped(segment->tensions, segment->lower, segment->upper, tensions, held);
    rod_set_tensions(segment, held, 1, memory, memory + rod_memory(segment, 0), &rod);
    rod_contract(&rod);
    rotation_of(quaternion, target);
    /* start: the given wrench, or none if it is not finite */
    memcpy(tried, wrench, sizeof tried);
    for (int i = 0; i < W; i++)
        if (!isfinite(tried[i])) memset(tried, 0, sizeof tried);
    memcpy(wrench, tried, sizeof tried);
    memset(step, 0, sizeof step);
    memset(stiffness, 0, W * W * sizeof *stiffness);
    for (int evaluations = 1; evaluations <= EVALUATIONS; evaluations++) {
        /* pose under the tried wrench, and its distance from the target [m] */
        rod_under(&rod, (rod_part){0, segment->elements}, tried, 1, &end);
        motion_to(&end, centre, target, motion);
        const double off = size_of(segment, motion);
        if (!(off < least)) { /* no decrease: half the step from the last wrench */
            share *= 0.5;
            if (share < SHORTEST || !isfinite(least)) return -evaluations;
            for (int i = 0; i < W; i++) tried[i] = wrench[i] + share * step[i];
            continue;
        }
        /* accept the wrench */
        least = off;
        share = 1.0;
        memcpy(wrench, tried, sizeof tried);
        memcpy(yielding, end.by_wrench, sizeof yielding);
        /* solve Y_w [K | dw] = [I | motion] for stiffness K and Newton step dw */
        double right[W * (W + 1)];
        for (int i = 0; i < W; i++) {
            for (int j = 0; j < W; j++) right[(W + 1) * i + j] = i == j;
            right[(W + 1) * i + W] = motion[i];
        }
        if (!small_solve(W, yielding, W + 1, right)) return -evaluations;
        /* step, its size over the longest allowed, and stiffness */
        double longest = 0.0;
        for (int i = 0; i < W; i++) {
            step[i] = right[(W + 1) * i + W];
            longest = fmax(longest, fabs(step[i]) / (LONGEST * (upper[i] - lower[i])));
            for (int j = 0; j < W; j++) stiffness[W * i + j] = right[(W + 1) * i + j];
        }
        /* converged: one last full step */
        if (off < MET) {
            for (int i = 0; i < W; i++) wrench[i] += step[i];
            *inside &= end.inside; /* of the wrench before the last step, which is tiny */
            return evaluations;
        }
        /* next wrench: the step, shortened to the longest allowed */
        for (int i = 0; i < W; i++) tried[i] = wrench[i] + (step[i] /= fmax(longest, 1.0));
    }
    return -EVALUATIONS;
}

void fingerfem_spring(const fingerfem_segment *segment, const double *quaternion, const double *wrench,
                      const double *stiffness, double *force, double *seen)
{
    const double size = segment->half_lengths[1], *f = wrench;
    /* The force turns with the plate: df = R (K dx + turn x f), where turn x f = -[f]x turn. */
    const double follows[3][3] = {{0.0, f[2], -f[1]}, {-f[2], 0.0, f[0]}, {f[1], -f[0], 0.0}};
    double rotation[9], own[W * W], half[W * W], work[2 * W * W];
    rotation_of(quaternion, rotation);
    /* K plus -[f]x in the rows of the force, the columns of the turns */
    memcpy(own, stiffness, sizeof own);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) own[W * i + 3 + j] += follows[i][j];
    /* columns: K R^T by displacements along the clamp's axes; by turns times the half side */
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += rotation[3 * (j % 3) + k] * own[W * i + k];
            half[W * i + j] = j < 3 ? sum : own[W * i + j] / size;
        }
    /* rows: R K R^T for forces along the clamp's axes; moments over the half side */
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += rotation[3 * (i % 3) + k] * half[W * k + j];
            seen[W * i + j] = i < 3 ? sum : half[W * i + j] / size;
        }
    /* symmetric part without negative eigenvalues, then turns in [rad] again */
    small_nonnegative(W, seen, work);
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) seen[W * i + j] *= (i < 3 ? 1.0 : size) * (j < 3 ? 1.0 : size);
    /* force along the clamp's axes, R f; the moment stays about the plate's own */
    for (int i = 0; i < 3; i++) {
        force[i] = rotation[3 * i] * f[0] + rotation[3 * i + 1] * f[1] + rotation[3 * i + 2] * f[2];
        force[3 + i] = wrench[3 + i];
    }
}

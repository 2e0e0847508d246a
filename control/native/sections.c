/* Forces and stiffness of a finger's elements in a MuJoCo model, see sections.h. */
#include <math.h>
#include <string.h>
#include "sections.h"

enum { W = FINGERFEM_WRENCH, Q = CONTROL_COORDINATES };

/* The rotation vector between two quaternions of any length, (3) [rad], seen from the first. */
static void turn_between(const double *from, const double *to, double *turn)
{
    /* conj(from) to = (w, v), with tan(angle / 2) = |v| / w */
    const double *a = from + 1, *b = to + 1;
    double w = from[0] * to[0], sine = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        w += a[i] * b[i];
        turn[i] = from[0] * b[i] - to[0] * a[i] - (a[j] * b[k] - a[k] * b[j]);
        sine += turn[i] * turn[i];
    }
    sine = sqrt(sine);
    const double angle = 2.0 * atan2(sine, fabs(w)), factor = sine > 0.0 ? angle / sine : 0.0;
    for (int i = 0; i < 3; i++) turn[i] *= w < 0.0 ? -factor : factor;
}

/* Force along the joints of section k, (6), of which the coordinates are q; its last pose, if it has one there. */
static void element_force(const control_sections *sections, int k, const double *q, double *force, int32_t *marks)
{
    const fingerfem_segment *element = sections->elements[k];
    double *held = sections->held + Q * k, *wrench = sections->wrenches + W * k, *stiffness = sections->stiffness + W * W * k;
    double own[FINGERFEM_MOST_TENSIONS], centre[3], found[W], yields[W * W], moved[W];
    for (int j = 0; j < element->tensions; j++) own[j] = sections->loads[sections->pulled[FINGERFEM_MOST_TENSIONS * k + j]];
    for (int i = 0; i < 3; i++) centre[i] = sections->offsets[3 * k + i] + q[i];
    /* inverse of the law, from the wrench of the last pose */
    memcpy(found, wrench, sizeof found);
    marks[1] = fingerfem_bear(element, own, centre, q + 3, sections->memory, found, yields, marks) > 0;
    if (marks[1]) {
        memcpy(held, q, Q * sizeof *held);
        memcpy(wrench, found, sizeof found);
        fingerfem_spring(element, q + 3, wrench, yields, sections->forces + W * k, stiffness);
    }
    if (marks[0] && marks[1]) memcpy(sections->trained + 3 * k, q, 3 * sizeof *q);
    /* f + K (q - held): the latter is 0 where there is a pose */
    for (int i = 0; i < 3; i++) moved[i] = q[i] - held[i];
    turn_between(held + 3, q + 3, moved + 3);
    for (int i = 0; i < W; i++) {
        force[i] = sections->forces[W * k + i];
        for (int j = 0; j < W; j++) force[i] += stiffness[W * i + j] * moved[j];
    }
}

int control_pull(const control_sections *sections, double h, int32_t *marks)
{
    int are_inside = 1;
    for (int k = 0; k < sections->n; k++) {
        const double *v = sections->qvel + sections->velocities[k], *K = sections->stiffness + W * W * k;
        const double later = sections->relaxation + h;
        const int32_t *places = sections->inertia + CONTROL_TRIANGLE * k;
        double force[W];
        element_force(sections, k, sections->qpos + sections->positions[k], force, marks + 2 * k);
        /* -(f + (D + h K) v), and h D + h^2 K in the lower triangle */
        for (int i = 0; i < W; i++) {
            for (int j = 0; j < W; j++) force[i] += later * K[W * i + j] * v[j];
            for (int j = 0; j <= i; j++) sections->M[*places++] += h * later * K[W * i + j];
            sections->qfrc_applied[sections->velocities[k] + i] = -force[i];
        }
        are_inside &= marks[2 * k] && marks[2 * k + 1];
    }
    return are_inside;
}

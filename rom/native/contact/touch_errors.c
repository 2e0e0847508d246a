/* Estimated errors of a touched finger, from the variants of its elements (docs/theory/rods.md, Estimated errors). */
#include <math.h>
#include "touch_errors.h"
#include "response.h"

#define INDENTED 0.4 /* relative error of an indentation of rubber, by which full-order meshes differ [-] */

/* Root of the sum of squares. */
static double size_of(int count, const double *values)
{
    double square = 0.0;
    for (int i = 0; i < count; i++) square += values[i] * values[i];
    return sqrt(square);
}

double touch_distance_error(const contact_problem *problem, int j, const touched_point *first)
{
    const fingerfem_chain *chain = problem->touching->chain;
    double e[3], opened[FINGERFEM_MOST_VARIANTS + 1] = {0.0};
    placed_leaving(problem, j, first->plate, e);
    /* variant v moves the plate by xi_v and the touch distance by W . xi_v / (n . e) */
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        for (int i = 0; i < W; i++) opened[v] += first->wrench[i] * first->plate->motion[i][contact_size(problem) + v];
        opened[v] /= objects_dot(first->wrench, e);
    }
    /* factor times the root of the sum of squares with the floor, plus the surface error */
    opened[FINGERFEM_MOST_VARIANTS] = chain->place_floor;
    return chain->touch_factor * size_of(FINGERFEM_MOST_VARIANTS + 1, opened) + first->off;
}

/* Error of the place of rubber where it presses, as if the object stood so far away [m]: the surface error, and
 * INDENTED times the indentation. The mean over all contacts, weighted by their forces; plates count as 0. */
static double rubber_place(const contact_problem *problem, const contact_state *state)
{
    double sum = 0.0, all = 0.0;
    /* sum f_k (surface error + INDENTED indentation) / sum f_k */
    for (int k = 0; k < state->at.contacts.count; k++) {
        const double force = state->forces[k];
        if (!(force > 0.0)) continue;
        all += force;
        if (state->at.arms[k].count > 1) sum += force * (rubber_off(problem, &state->at, k) + INDENTED * (state->at.contacts.lifts[k] + response_indentation(&state->at, state->forces, k)));
    }
    return all > 0.0 ? sum / all : 0.0;
}

void report_errors(const contact_problem *problem, const contact_state *state, const double *forces, const double *jacobian,
                   double *errors)
{
    enum { MOST = FINGERFEM_MOST_VARIANTS };
    const fingerfem_chain *chain = problem->touching->chain;
    const int t = chain->tensions, m = problem->touching->count, p = t + m;
    const double place = chain->place_floor, off = rubber_place(problem, state);
    double tip[3 * MOST + 3] = {0.0}, force[FINGERFEM_MOST_OBJECTS][MOST + 2] = {{0.0}}, known = 0.0, tip_by_d = 0.0;
    /* changes of tip and forces by variant v: its motions at fixed loads are imposed on all bodies */
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        double drift[CHAIN_WRENCH], still[3 * FINGERFEM_MOST_CONTACTS] = {0.0}, found[3 + FINGERFEM_MOST_OBJECTS] = {0.0};
        reported_change all;
        for (int i = 0; i < contact_size(problem); i++)
            drift[i] = state->at.chain.bodies[i / W].motion[i % W][contact_size(problem) + v];
        if (!answer_change(problem, state, -1, drift, still, &all, found)) known = INFINITY;
        memcpy(tip + 3 * v, found, 3 * sizeof *tip);
        for (int j = 0; j < m; j++) force[j][v] = found[3 + j];
    }
    /* floor of the tip, and how far the tip moves as the rubber's place changes, sum_d |dtip/dd| */
    for (int i = 0; i < 3; i++) tip[3 * MOST + i] = place;
    for (int d = t; d < p; d++) tip_by_d += sqrt(jacobian[d] * jacobian[d] + jacobian[p + d] * jacobian[p + d] + jacobian[2 * p + d] * jacobian[2 * p + d]);
    /* tip: factor (sum_v Delta_v^2 + Delta_0^2)^(1/2), and the rubber's part; infinite if a change is missing */
    errors[0] = chain->tip_factor * size_of(3 * MOST + 3, tip) + off * tip_by_d + known;
    /* forces: the same with a relative floor, and the place floor times the contact stiffness, sum_d |dN/dd| */
    for (int j = 0; j < m; j++) {
        double stiffness = 0.0;
        for (int d = t; d < p; d++) stiffness += fabs(jacobian[p * (3 + j) + d]);
        force[j][MOST] = chain->force_floor * forces[j];
        force[j][MOST + 1] = place * stiffness;
        errors[1 + j] = chain->force_factor * size_of(MOST + 2, force[j]) + off * stiffness + known;
    }
}

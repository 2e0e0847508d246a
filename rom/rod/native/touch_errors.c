#include <math.h>
#include "touch_errors.h"

#define INDENTED 0.25 /* how well it is known how deep rubber is pressed in [-] */

/* Root of the sum of squares. */
static double size_of(int count, const double *values)
{
    double square = 0.0;
    for (int i = 0; i < count; i++) square += values[i] * values[i];
    return sqrt(square);
}

double touch_distance_error(const contact_problem *problem, const touched_point *first)
{
    const fingerfem_chain *chain = problem->touching->chain;
    double e[3], opened[FINGERFEM_MOST_VARIANTS + 1] = {0.0};
    placed_leaving(problem, first->plate, e);
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        for (int i = 0; i < W; i++) opened[v] += first->wrench[i] * first->plate->motion[i][contact_size(problem) + v];
        opened[v] /= objects_dot(first->wrench, e);
    }
    opened[FINGERFEM_MOST_VARIANTS] = chain->place_floor;
    return chain->touch_factor * size_of(FINGERFEM_MOST_VARIANTS + 1, opened) + first->off;
}

/* How far the rubber may be from where it presses, as if the object stood so far away: how well its surface is known, and a
 * share of how deep it is pressed in; the mean by the contacts' forces. */
static double rubber_place(const contact_problem *problem, const contact_state *state)
{
    double sum = 0.0, all = 0.0;
    for (int k = 0; k < state->at.contacts.count; k++) {
        const double force = state->forces[k];
        if (!(force > 0.0)) continue;
        all += force;
        if (state->at.arms[k].count > 1) sum += force * (rubber_off(problem, &state->at, k) + INDENTED * force * state->at.contacts.compliance[k]);
    }
    return all > 0.0 ? sum / all : 0.0;
}

void report_errors(const contact_problem *problem, const contact_state *state, double force_now, const double *jacobian, double *errors)
{
    enum { MOST = FINGERFEM_MOST_VARIANTS };
    const fingerfem_chain *chain = problem->touching->chain;
    const int p = chain->tensions + 1;
    const double place = chain->place_floor, stiffness = fabs(jacobian[p * 3 + p - 1]), off = rubber_place(problem, state);
    const double *by_d = jacobian + p - 1, tip_by_d = sqrt(by_d[0] * by_d[0] + by_d[p] * by_d[p] + by_d[2 * p] * by_d[2 * p]);
    double tip[3 * MOST + 3] = {0.0}, force[MOST + 2] = {0.0}, known = 0.0;
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        double drift[CHAIN_WRENCH], still[3 * FINGERFEM_MOST_CONTACTS] = {0.0}, found[4] = {0.0};
        reported_change all;
        for (int i = 0; i < contact_size(problem); i++)
            drift[i] = state->at.chain.bodies[i / W].motion[i % W][contact_size(problem) + v];
        if (!report_change(problem, state, drift, still, &all, found)) known = INFINITY;
        memcpy(tip + 3 * v, found, 3 * sizeof *tip);
        force[v] = found[3];
    }
    for (int i = 0; i < 3; i++) tip[3 * MOST + i] = place;
    force[MOST] = chain->force_floor * force_now;
    force[MOST + 1] = place * stiffness;
    errors[0] = chain->tip_factor * size_of(3 * MOST + 3, tip) + off * tip_by_d + known;
    errors[1] = chain->force_factor * size_of(MOST + 2, force) + off * stiffness + known;
}

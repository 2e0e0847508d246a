#include <math.h>
#include "touch_errors.h"

/* Root of the sum of squares. */
static double size_of(int count, const double *values)
{
    double square = 0.0;
    for (int i = 0; i < count; i++) square += values[i] * values[i];
    return sqrt(square);
}

double touch_distance_error(const contact_problem *problem, const touched_point *first, int rubber)
{
    const fingerfem_chain *chain = problem->touching->chain;
    double e[3], opened[FINGERFEM_MOST_VARIANTS + 1] = {0.0};
    placed_leaving(problem, first->plate, e);
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        for (int i = 0; i < W; i++) opened[v] += first->wrench[i] * first->plate->motion[i][problem->size + v];
        opened[v] /= objects_dot(first->wrench, e);
    }
    opened[FINGERFEM_MOST_VARIANTS] = chain->place_floor;
    return chain->touch_factor * size_of(FINGERFEM_MOST_VARIANTS + 1, opened) + (rubber ? chain->touch_error_of_skin : 0.0);
}

void report_errors(const contact_problem *problem, const contact_state *state, double force_now, double stiffness, double *errors)
{
    enum { MOST = FINGERFEM_MOST_VARIANTS };
    const fingerfem_chain *chain = problem->touching->chain;
    const double place = chain->place_floor;
    double tip[3 * MOST + 3] = {0.0}, force[MOST + 2] = {0.0}, known = 0.0;
    for (int v = 0; v < chain->segments[0]->deviating; v++) {
        double drift[CHAIN_WRENCH], still[3 * FINGERFEM_MOST_CONTACTS] = {0.0}, found[4] = {0.0};
        reported_change all;
        for (int i = 0; i < problem->size; i++) drift[i] = state->at.chain.plates[i / W].motion[i % W][problem->size + v];
        if (!report_change(problem, state, drift, still, &all, found)) known = INFINITY;
        memcpy(tip + 3 * v, found, 3 * sizeof *tip);
        force[v] = found[3];
    }
    for (int i = 0; i < 3; i++) tip[3 * MOST + i] = place;
    force[MOST] = chain->force_floor * force_now;
    force[MOST + 1] = place * stiffness;
    errors[0] = chain->tip_factor * size_of(3 * MOST + 3, tip) + known;
    errors[1] = chain->force_factor * size_of(MOST + 2, force) + known;
}

/* Answers of a touched segment: tip, contact force, touch distance, and their derivatives. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <time.h>
#include "contact.h"

/* Tip and contact force, and their derivatives, at a state that has been solved. */
static int report(const contact_problem *problem, const contact_state *state, int d_moves, double *out, double *jacobian)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const int t = chain->tensions, p = t + 1, w = problem->size;
    const chain_plate *plates = state->at.chain.plates, *tip = plates + chain->plates - 1;
    const double *r = tip->rotation;
    double e[FINGERFEM_MOST_PLATES][3];
    for (int i = 0; i < 3; i++) out[i] = tip->centre[i] - chain->rest[i];
    out[3] = 0.0;
    for (int q = 0; q < chain->plates; q++) {
        placed_leaving(problem, plates + q, e[q]);
        for (int i = 0; i < 3; i++) out[3] -= e[q][i] * state->wrench[W * q + i];
    }
    for (int k = 0; k < (d_moves ? p : t); k++) {
        double drift[CHAIN_WRENCH], change[CHAIN_WRENCH];
        for (int i = 0; i < w; i++) drift[i] = k < t ? plates[i / W].motion[i % W][w + k] : i % W < 3 ? -e[i / W][i % W] : 0.0;
        if (!contact_follow(problem, state, drift, change)) return 0;
        for (int q = 0; q < chain->plates; q++) {
            double motion[W];
            for (int i = 0; i < W; i++) {
                motion[i] = k < t ? drift[W * q + i] : 0.0;
                for (int j = 0; j < w; j++) motion[i] += plates[q].motion[i][j] * change[j];
            }
            for (int i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, l = (i + 2) % 3;
                const double turned = e[q][j] * motion[3 + l] - e[q][l] * motion[3 + j];
                jacobian[p * 3 + k] -= e[q][i] * change[W * q + i] + turned * state->wrench[W * q + i];
                if (plates + q == tip)
                    jacobian[p * i + k] = r[3 * i] * motion[0] + r[3 * i + 1] * motion[1] + r[3 * i + 2] * motion[2];
            }
        }
    }
    return 1;
}

/* Touch distance and its derivatives by the tensions, of the free plates. */
static void report_touch(const contact_problem *problem, const placed *at, double touch, double *out, double *jacobian)
{
    const int t = problem->touching->chain->tensions;
    out[4] = touch;
    if (!isfinite(touch)) return;
    const int nearest = placed_nearest(&at->contacts);
    const chain_plate *plate = at->chain.plates + at->contacts.plates[nearest];
    const double *normal = at->contacts.wrenches[nearest];
    double e[3], down = 0.0;
    placed_leaving(problem, plate, e);
    for (int i = 0; i < 3; i++) down += normal[i] * e[i];
    for (int k = 0; k < t; k++)
        for (int i = 0; i < W; i++) jacobian[(t + 1) * 4 + k] += normal[i] * plate->motion[i][problem->size + k] / down;
}

double fingerfem_touch_error(const fingerfem_touching *touching, const double *out, const double *jacobian)
{
    const fingerfem_chain *chain = touching->chain;
    const int p = chain->tensions + 1;
    return chain->force_error * out[3] + chain->place_error * fabs(jacobian[3 * p + p - 1]);
}

/* Nothing presses, so that nothing follows. */
static void leave_free(const contact_problem *problem, contact_state *state)
{
    state->at.contacts.count = 0;
    for (int i = 0; i < problem->size; i++) {
        memset(state->soft[i], 0, sizeof state->soft[i]);
        memset(state->following[i], 0, sizeof state->following[i]);
        memset(state->at.chain.plates[i / W].motion[i % W], 0, (size_t)problem->size * sizeof(double));
    }
}

int fingerfem_touch(const fingerfem_touching *touching, const double *point, double *wrench, double *out,
                    double *jacobian, int32_t *inside)
{
    const fingerfem_chain *chain = touching->chain;
    const fingerfem_object *object = touching->object;
    const int t = chain->tensions, p = t + 1;
    double held[MAP_MOST_TENSIONS], contracted[chain_contracted_size(chain)], products[chain_products_size(chain)];
    chain_contracted map;
    contact_state state;
    const contact_problem problem = {touching, &map, W * chain->plates};
    const size_t size = (size_t)problem.size * sizeof *wrench;
    memset(jacobian, 0, (size_t)(FINGERFEM_ROWS * p) * sizeof *jacobian);
    *inside = 1;
    for (int k = 0; k < t; k++) {
        held[k] = map_held(chain->segments[0], k, point[k]);
        *inside &= held[k] == point[k];
    }
    chain_contract(chain, held, contracted, products, &map);
    memset(state.wrench, 0, sizeof state.wrench);
    memset(state.forces, 0, sizeof state.forces);
    chain_free(&map, &state.at.chain);
    const double touch = placed_touch_distance(&problem, &state.at);
    report_touch(&problem, &state.at, touch, out, jacobian);
    double d = point[t] > object->nearest ? point[t] : object->nearest;
    d = d < object->farthest ? d : object->farthest;
    const int touches = d < touch, d_moves = d == point[t];
    *inside &= d_moves || (!touches && !isnan(point[t]));
    int evaluations = 1;
    if (touches) {
        memcpy(state.wrench, wrench, size);
        evaluations = contact_solve(&problem, touch, d, &state);
        chain_by_tensions(&map, &state.at.chain);
    } else {
        leave_free(&problem, &state);
    }
    for (int k = 0; k < chain->plates; k++) *inside &= map_inside(chain->segments[k], state.at.chain.plates[k].borne);
    if (!report(&problem, &state, touches && d_moves, out, jacobian) && evaluations > 0) evaluations = -evaluations;
    *inside &= evaluations > 0 && (!touches || contact_stable(&problem, &state));
    for (int k = 0; k < t; k++)
        for (int i = 0; i < FINGERFEM_ROWS && held[k] != point[k]; i++) jacobian[p * i + k] = 0.0;
    memcpy(wrench, state.wrench, size);
    return evaluations;
}

void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *out,
                       double *jacobians, double *wrenches, int32_t *inside, int32_t *evaluations,
                       int64_t *nanoseconds, double *rubber_gaps)
{
    const int p = touching->chain->tensions + 1;
    for (int i = 0; i < count; i++) {
        struct timespec begun, ended;
        double *wrench = wrenches + W * touching->chain->plates * i;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        evaluations[i] = fingerfem_touch(touching, points + p * i, wrench, out + FINGERFEM_ROWS * i,
                                         jacobians + FINGERFEM_ROWS * p * i, inside + i);
        clock_gettime(CLOCK_MONOTONIC, &ended);
        nanoseconds[i] = (ended.tv_sec - begun.tv_sec) * 1000000000LL + ended.tv_nsec - begun.tv_nsec;
        rubber_gaps[i] = fingerfem_rubber_gap(touching, points + p * i, wrench);
        inside[i] &= !(rubber_gaps[i] < touching->chain->skin_error);
    }
}

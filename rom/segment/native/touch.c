/* Answers of a touched segment: tip, contact force, touch distance, and their derivatives. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <time.h>
#include "contact.h"

/* Tip and contact force, and their derivatives, at a state that has been solved. */
static int report(const contracted_map *map, const contact_state *state, int d_moves, double *out, double *jacobian)
{
    const fingerfem_segment *segment = map->touching->segment;
    const int t = segment->tensions, p = t + 1;
    const double *r = state->at.rotation;
    double e[3];
    placed_leaving(map, &state->at, e);
    out[3] = 0.0;
    for (int i = 0; i < 3; i++) {
        out[i] = state->at.centre[i] - segment->rest[i];
        out[3] -= e[i] * state->wrench[i];
    }
    for (int k = 0; k < (d_moves ? p : t); k++) {
        double drift[W] = {0.0}, change[W], motion[W];
        for (int i = 0; i < W; i++) drift[i] = k < t ? state->at.by_tensions[i][k] : i < 3 ? -e[i] : 0.0;
        if (!contact_follow(state, drift, change)) return 0;
        for (int i = 0; i < W; i++) {
            motion[i] = k < t ? drift[i] : 0.0;
            for (int j = 0; j < W; j++) motion[i] += state->at.compliance[i][j] * change[j];
        }
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            jacobian[p * i + k] = r[3 * i] * motion[0] + r[3 * i + 1] * motion[1] + r[3 * i + 2] * motion[2];
            jacobian[p * 3 + k] -= e[i] * change[i] + (e[j] * motion[3 + l] - e[l] * motion[3 + j]) * state->wrench[i];
        }
    }
    return 1;
}

/* Touch distance and its derivatives by the tensions, of the free plate. */
static void report_touch(const contracted_map *map, const placed *at, double touch, double *out, double *jacobian)
{
    const int t = map->touching->segment->tensions;
    out[4] = touch;
    if (!isfinite(touch)) return;
    double e[3], down = 0.0;
    placed_leaving(map, at, e);
    const double *normal = at->contacts.wrenches[placed_nearest(&at->contacts)];
    for (int i = 0; i < 3; i++) down += normal[i] * e[i];
    for (int k = 0; k < t; k++)
        for (int i = 0; i < W; i++) jacobian[(t + 1) * 4 + k] += normal[i] * at->by_tensions[i][k] / down;
}

double fingerfem_touch_error(const fingerfem_touching *touching, const double *out, const double *jacobian)
{
    const int p = touching->segment->tensions + 1;
    return touching->force_error * out[3] + touching->place_error * fabs(jacobian[3 * p + p - 1]);
}

int fingerfem_touch(const fingerfem_touching *touching, const double *point, double *wrench, double *out,
                    double *jacobian, int32_t *inside)
{
    const fingerfem_segment *segment = touching->segment;
    const fingerfem_object *object = touching->object;
    const int t = segment->tensions, p = t + 1, size = FINGERFEM_POSE * segment->groups;
    double held[MAP_MOST_TENSIONS], contracted[(1 + t) * size], products[size];
    const contracted_map map = {touching, contracted, products};
    contact_state state;
    memset(jacobian, 0, (size_t)(FINGERFEM_ROWS * p) * sizeof *jacobian);
    *inside = 1;
    for (int k = 0; k < t; k++) {
        held[k] = point[k] > segment->lower[k] ? point[k] : segment->lower[k]; /* NaN is the lowest */
        held[k] = held[k] < segment->upper[k] ? held[k] : segment->upper[k];
        *inside &= held[k] == point[k];
    }
    map_contract(segment, 1 + t, held, contracted);
    memset(state.wrench, 0, sizeof state.wrench);
    memset(state.forces, 0, sizeof state.forces);
    placed_free(&map, &state.at);
    const double touch = placed_touch_distance(&map, &state.at);
    report_touch(&map, &state.at, touch, out, jacobian);
    double d = point[t] > object->nearest ? point[t] : object->nearest;
    d = d < object->farthest ? d : object->farthest;
    const int touches = d < touch, d_moves = d == point[t];
    *inside &= d_moves || (!touches && !isnan(point[t]));
    int evaluations = 1;
    if (touches) {
        memcpy(state.wrench, wrench, sizeof state.wrench);
        evaluations = contact_solve(&map, touch, d, &state);
        placed_by_tensions(&map, &state.at);
    } else {
        state.at.contacts.count = 0;
        memset(state.at.compliance, 0, sizeof state.at.compliance);
        memset(state.following, 0, sizeof state.following);
        memset(state.yielding, 0, sizeof state.yielding);
        memset(state.soft, 0, sizeof state.soft);
    }
    *inside &= map_inside(segment, state.wrench);
    if (!report(&map, &state, touches && d_moves, out, jacobian) && evaluations > 0) evaluations = -evaluations;
    *inside &= evaluations > 0 && (!touches || contact_stable(&state));
    for (int k = 0; k < t; k++)
        for (int i = 0; i < FINGERFEM_ROWS && held[k] != point[k]; i++) jacobian[p * i + k] = 0.0;
    memcpy(wrench, state.wrench, sizeof state.wrench);
    return evaluations;
}

void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *out,
                       double *jacobians, double *wrenches, int32_t *inside, int32_t *evaluations,
                       int64_t *nanoseconds, double *rubber_gaps)
{
    const int p = touching->segment->tensions + 1;
    for (int i = 0; i < count; i++) {
        struct timespec begun, ended;
        double *wrench = wrenches + W * i;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        evaluations[i] = fingerfem_touch(touching, points + p * i, wrench, out + FINGERFEM_ROWS * i,
                                         jacobians + FINGERFEM_ROWS * p * i, inside + i);
        clock_gettime(CLOCK_MONOTONIC, &ended);
        nanoseconds[i] = (ended.tv_sec - begun.tv_sec) * 1000000000LL + ended.tv_nsec - begun.tv_nsec;
        rubber_gaps[i] = fingerfem_rubber_gap(touching, points + p * i, wrench);
        inside[i] &= !(rubber_gaps[i] < touching->segment->skin_error);
    }
}

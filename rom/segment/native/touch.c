/* What an object and a plate do to each other: complementarity of gaps and forces, linearised about the last pose.
 *
 * The plate moves by xi = C dw with the wrench w, C its compliance. Contact forces f >= 0 make the wrench W f, and as the
 * plate moves this changes by G xi besides, for the normals turn in its frame. So, from w,
 *
 *     dw = S (W f - w),    S = (1 - G C)^-1,    gaps + W^T C dw >= 0,  with f or the gap zero at every contact.
 *
 * The next pose is where this leads; near the end it is Newton's method.
 */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdlib.h>
#include <time.h>
#include "map.h"
#include "objects.h"
#include "small.h"

#define ITERATIONS 30
#define DEEP 0.5     /* of a radius: an object that is deeper in the free plate comes to it in steps [-] */
#define STEPS 4      /* on that way, at first */
#define HALVINGS 10  /* of such a step until there is no answer */
#define EVALUATIONS 500 /* most of the map for one answer */
#define CLOSE 1e-5   /* of the box: a last step of the wrench, about whose square is left [-] */
#define LONGEST 0.5  /* of the box: a step of the wrench [-] */
#define SOFT 1e-9    /* what a contact yields, for forces that are shared by a stiff plate to be unique [m/N] */
#define MARCHES 60   /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */

enum { W = FINGERFEM_WRENCH };
typedef double matrix[W][W];

/* A plate somewhere: its pose, what it does by the wrench and by the tensions, and the contacts there. */
typedef struct {
    double pose[FINGERFEM_POSE], centre[3], rotation[9];
    matrix compliance; /* C: motion by the wrench */
    double by_tensions[W][MAP_MOST_TENSIONS];
    objects_contacts contacts;
} placed;

/* What was contracted for some tensions. */
typedef struct {
    const fingerfem_touching *touching;
    const double *contracted;
    double *products;
} contracted_map;

static void locate(placed *at)
{
    map_rotation(at->pose, at->rotation);
    for (int i = 0; i < 3; i++) {
        at->centre[i] = 0.0;
        for (int j = 0; j < 3; j++) at->centre[i] -= at->rotation[3 * i + j] * at->pose[j];
    }
}

static void place(const contracted_map *map, const double *wrench, double d, placed *at)
{
    const fingerfem_segment *segment = map->touching->segment;
    double by_wrench[W * FINGERFEM_POSE];
    map_pose(segment, map->contracted, wrench, map->products, at->pose, by_wrench);
    for (int k = 0; k < W; k++)
        map_motion(at->pose, by_wrench + FINGERFEM_POSE * k, W, k, &at->compliance[0][0]);
    locate(at);
    objects_find(map->touching->object, segment->half_lengths, d, at->centre, at->rotation, &at->contacts);
}

/* The plate without a wrench: where it is, and its motion by the tensions. */
static void place_free(const contracted_map *map, placed *at)
{
    const int t = map->touching->segment->tensions;
    double by_tensions[MAP_MOST_TENSIONS * FINGERFEM_POSE];
    map_free(map->touching->segment, map->contracted, at->pose, by_tensions);
    for (int k = 0; k < t; k++)
        map_motion(at->pose, by_tensions + FINGERFEM_POSE * k, MAP_MOST_TENSIONS, k, &at->by_tensions[0][0]);
    locate(at);
}

/* The plate's motion by the tensions, at the wrench that `place` was asked for last. */
static void place_by_tensions(const contracted_map *map, placed *at)
{
    const fingerfem_segment *segment = map->touching->segment;
    const int stride = FINGERFEM_POSE * segment->groups;
    for (int k = 0; k < segment->tensions; k++) {
        map_eight sum = {0.0};
        for (int g = 0; g < segment->groups; g++)
            sum += map->products[FINGERFEM_POSE * g] * map_load(map->contracted + stride * (1 + k) + FINGERFEM_POSE * g);
        double change[FINGERFEM_POSE];
        map_store(change, sum);
        map_motion(at->pose, change, MAP_MOST_TENSIONS, k, &at->by_tensions[0][0]);
    }
}

/* The direction in which d moves the object, seen from the plate. */
static void leaving(const contracted_map *map, const placed *at, double *found)
{
    const double *e = map->touching->object->direction, *r = at->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * e[0] + r[3 + i] * e[1] + r[6 + i] * e[2];
}

static int least_gap(const objects_contacts *contacts)
{
    int least = 0;
    for (int k = 1; k < contacts->count; k++)
        if (contacts->gaps[k] < contacts->gaps[least]) least = k;
    return least;
}

/* The largest d at which the object touches the plate where it is; -infinity if it passes by. By Newton's method from far
 * away: the distance of convex bodies is convex in d, so that it never goes too far. */
static double touch_distance(const contracted_map *map, placed *at)
{
    const fingerfem_object *object = map->touching->object;
    double e[3], d = 1.0;
    leaving(map, at, e);
    for (int step = 0; step < MARCHES; step++) {
        objects_find(object, map->touching->segment->half_lengths, d, at->centre, at->rotation, &at->contacts);
        const int k = least_gap(&at->contacts);
        const double *n = at->contacts.wrenches[k], gap = at->contacts.gaps[k];
        const double slope = -(n[0] * e[0] + n[1] * e[1] + n[2] * e[2]);
        if (fabs(gap) < TOUCHED) return d;
        if (gap > 0.0 && slope <= 0.0) return -INFINITY;
        d -= gap / slope;
    }
    return -INFINITY;
}

/* W f, and G: how that changes as the plate moves. */
static void pressed(const fingerfem_object *object, const objects_contacts *contacts, const double *forces,
                    double *wrench, matrix change)
{
    memset(wrench, 0, W * sizeof *wrench);
    memset(change, 0, sizeof(matrix));
    for (int k = 0; k < contacts->count; k++) {
        if (forces[k] == 0.0) continue;
        matrix own;
        objects_change(object, contacts, k, own);
        for (int i = 0; i < W; i++) {
            wrench[i] += forces[k] * contacts->wrenches[k][i];
            for (int j = 0; j < W; j++) change[i][j] += forces[k] * own[i][j];
        }
    }
}

static void product(const matrix a, const matrix b, matrix out)
{
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            out[i][j] = 0.0;
            for (int k = 0; k < W; k++) out[i][j] += a[i][k] * b[k][j];
        }
}

/* S = (1 - G C)^-1; returns 0 if there is none. */
static int softened(const matrix following, const matrix compliance, matrix out)
{
    matrix system;
    product(following, compliance, system);
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            out[i][j] = i == j;
            system[i][j] = (i == j) - system[i][j];
        }
    return small_solve(W, &system[0][0], W, &out[0][0]);
}

static double dot(const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < W; i++) sum += a[i] * b[i];
    return sum;
}

/* A row times a matrix. */
static void row_product(const double *row, const matrix m, double *out)
{
    for (int j = 0; j < W; j++) {
        out[j] = 0.0;
        for (int i = 0; i < W; i++) out[j] += row[i] * m[i][j];
    }
}

/* A state of the solve: where the plate is, the forces at its contacts by their names, and S and C S. */
typedef struct {
    placed at;
    double wrench[W], forces[FINGERFEM_MOST_CONTACTS];
    matrix following, soft, yielding;
} contact_state;

/* Forces that the contacts had before, found again by their names. */
static void carry(const objects_contacts *before, const double *forces, const objects_contacts *now, double *found)
{
    for (int k = 0; k < now->count; k++) {
        found[k] = 0.0;
        for (int j = 0; j < before->count; j++)
            if (before->names[j] == now->names[k]) found[k] = forces[j];
    }
}

/* One step; returns the change of the wrench over the box, negative if there is none. */
static double step(const contracted_map *map, contact_state *state)
{
    const fingerfem_segment *segment = map->touching->segment;
    const double *upper = segment->upper + segment->tensions;
    objects_contacts *contacts = &state->at.contacts;
    const int count = contacts->count;
    double made[W], target[W], change[W], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    double b[FINGERFEM_MOST_CONTACTS];
    pressed(map->touching->object, contacts, state->forces, made, state->following);
    if (!softened(state->following, state->at.compliance, state->soft)) return -1.0;
    product(state->at.compliance, state->soft, state->yielding);
    for (int i = 0; i < count; i++) {
        double row[W];
        row_product(contacts->wrenches[i], state->yielding, row);
        b[i] = contacts->gaps[i] - dot(row, state->wrench);
        for (int j = 0; j < count; j++) a[count * i + j] = dot(row, contacts->wrenches[j]);
    }
    double forces[FINGERFEM_MOST_CONTACTS];
    memcpy(forces, state->forces, sizeof forces);
    if (!small_complementarity(count, a, b, SOFT, forces)) return -1.0;
    memset(target, 0, sizeof target);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++) target[i] += forces[k] * contacts->wrenches[k][i];
    double size = 0.0;
    for (int i = 0; i < W; i++) {
        change[i] = 0.0;
        for (int j = 0; j < W; j++) change[i] += state->soft[i][j] * (target[j] - state->wrench[j]);
        const double own = fabs(change[i]) / upper[i];
        if (own > size || isnan(own)) size = own;
    }
    if (isnan(size)) return -1.0;
    const double share = size > LONGEST ? LONGEST / size : 1.0;
    for (int i = 0; i < W; i++) state->wrench[i] += share * change[i];
    for (int k = 0; k < count; k++) state->forces[k] += share * (forces[k] - state->forces[k]);
    for (int i = 0; i < 3; i++) /* where the next pose would be found */
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < W; k++)
                state->at.centre[i] += state->at.rotation[3 * i + j] * state->at.compliance[j][k] * share * change[k];
    return size;
}

/* Solve from a state's wrench and forces; returns the number of evaluations, negative if it did not end. */
static int solve_from(const contracted_map *map, double d, contact_state *state)
{
    objects_contacts before = state->at.contacts;
    for (int k = 1; k <= ITERATIONS; k++) {
        double forces[FINGERFEM_MOST_CONTACTS];
        memcpy(forces, state->forces, sizeof forces);
        place(map, state->wrench, d, &state->at);
        carry(&before, forces, &state->at.contacts, state->forces);
        const double size = step(map, state);
        if (size < 0.0) return -k;
        if (size < CLOSE) return k;
        before = state->at.contacts;
    }
    return -ITERATIONS;
}

/* Bring the object from where it touches the free plate to d, so that of several answers the one is found that its
 * approach leads to; returns as `solve_from`. */
static int approach(const contracted_map *map, double touch, double d, contact_state *state)
{
    int evaluations = 0;
    double at = touch, size = (d - touch) / STEPS;
    const double least = fabs(size) / (1 << HALVINGS);
    memset(state->wrench, 0, sizeof state->wrench);
    state->at.contacts.count = 0;
    while (at > d) {
        contact_state last = *state;
        const double next = at + size > d + least ? at + size : d;
        const int used = solve_from(map, next, state);
        evaluations += abs(used);
        if (used > 0) {
            at = next;
            size *= 1.5;
            continue;
        }
        *state = last;
        size /= 2.0;
        if (fabs(size) < least || evaluations > EVALUATIONS) return -evaluations;
    }
    return evaluations;
}

/* Solve at d: from a wrench that is known; or at once, where that is near enough; or from where the object touches. */
static int solve(const contracted_map *map, double touch, double d, contact_state *state)
{
    const fingerfem_object *object = map->touching->object;
    int known = 0, evaluations = 0;
    for (int i = 0; i < W; i++) known |= state->wrench[i] != 0.0;
    if (known || object->shape == FINGERFEM_PLANE || touch - d < DEEP * object->radius) {
        state->at.contacts.count = 0;
        evaluations = solve_from(map, d, state);
        if (evaluations > 0) return evaluations;
    }
    const int more = approach(map, touch, d, state);
    return more > 0 ? abs(evaluations) + more : evaluations - abs(more);
}

/* How wrench and plate move with a tension, or with d: drift is the motion at a fixed wrench, of the plate or relative to
 * the object. Contacts that press stay closed. */
static int follow(const contact_state *state, const double *drift, double *wrench_change)
{
    const objects_contacts *contacts = &state->at.contacts;
    int rows[FINGERFEM_MOST_CONTACTS], count = 0;
    double turned[W], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], forces[FINGERFEM_MOST_CONTACTS];
    for (int k = 0; k < contacts->count; k++)
        if (state->forces[k] > 0.0) rows[count++] = k;
    for (int i = 0; i < W; i++) {
        turned[i] = 0.0;
        for (int j = 0; j < W; j++) turned[i] += state->following[i][j] * drift[j];
    }
    for (int i = 0; i < count; i++) {
        const double *own = contacts->wrenches[rows[i]];
        double row[W];
        row_product(own, state->yielding, row);
        forces[i] = -dot(row, turned) - dot(own, drift);
        for (int j = 0; j < count; j++)
            a[count * i + j] = dot(row, contacts->wrenches[rows[j]]) + (i == j ? SOFT : 0.0);
    }
    if (!small_solve(count, a, 1, forces)) return 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++) turned[i] += forces[k] * contacts->wrenches[rows[k]][i];
    for (int i = 0; i < W; i++) {
        wrench_change[i] = 0.0;
        for (int j = 0; j < W; j++) wrench_change[i] += state->soft[i][j] * turned[j];
    }
    return 1;
}

/* Tip and contact force, and their derivatives, at a state that has been solved. */
static int report(const contracted_map *map, const contact_state *state, int d_moves, double *out, double *jacobian)
{
    const fingerfem_segment *segment = map->touching->segment;
    const int t = segment->tensions, p = t + 1;
    const double *r = state->at.rotation;
    double e[3];
    leaving(map, &state->at, e);
    out[3] = 0.0;
    for (int i = 0; i < 3; i++) {
        out[i] = state->at.centre[i] - segment->rest[i];
        out[3] -= e[i] * state->wrench[i];
    }
    for (int k = 0; k < (d_moves ? p : t); k++) {
        double drift[W] = {0.0}, change[W], motion[W];
        for (int i = 0; i < W; i++) drift[i] = k < t ? state->at.by_tensions[i][k] : i < 3 ? -e[i] : 0.0;
        if (!follow(state, drift, change)) return 0;
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
    leaving(map, at, e);
    const double *normal = at->contacts.wrenches[least_gap(&at->contacts)];
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
    place_free(&map, &state.at);
    const double touch = touch_distance(&map, &state.at);
    report_touch(&map, &state.at, touch, out, jacobian);
    double d = point[t] > object->nearest ? point[t] : object->nearest;
    d = d < object->farthest ? d : object->farthest;
    const int touches = d < touch, d_moves = d == point[t];
    *inside &= d_moves || (!touches && !isnan(point[t]));
    int evaluations = 1;
    if (touches) {
        memcpy(state.wrench, wrench, sizeof state.wrench);
        evaluations = solve(&map, touch, d, &state);
        place_by_tensions(&map, &state.at);
    } else {
        state.at.contacts.count = 0;
        memset(state.at.compliance, 0, sizeof state.at.compliance);
        memset(state.following, 0, sizeof state.following);
        memset(state.yielding, 0, sizeof state.yielding);
        memset(state.soft, 0, sizeof state.soft);
    }
    for (int i = 0; i < W; i++)
        *inside &= segment->lower[t + i] <= state.wrench[i] && state.wrench[i] <= segment->upper[t + i];
    if (!report(&map, &state, touches && d_moves, out, jacobian) && evaluations > 0) evaluations = -evaluations;
    *inside &= evaluations > 0;
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

/* Answers of a touched segment: tip, contact force, touch distance, and their derivatives. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <time.h>
#include "reported.h"
#include "touch_errors.h"

#define ROUNDING 1e-8 /* of the touch distance, below which a contact may have no force [m] */

/* A vector of space as a body sees it. */
static void seen_by(const chain_body *plate, const double *v, double *found)
{
    const double *r = plate->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
}

/* Tip displacement and contact force, (4), at a state that has been solved. */
static void report(const contact_problem *problem, const contact_state *state, double *out)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const chain_body *bodies = state->at.chain.bodies, *tip = bodies + problem->map->count - 1;
    out[3] = 0.0;
    for (int i = 0; i < 3; i++) out[i] = tip->centre[i] - chain->rest[i];
    for (int q = 0; q < problem->map->count; q++) {
        double e[3];
        placed_leaving(problem, bodies + q, e);
        for (int i = 0; i < 3; i++) out[3] -= e[i] * state->wrench[W * q + i];
    }
}

int report_change(const contact_problem *problem, const contact_state *state, const double *drift, const double *bends,
                  reported_change *all, double *found)
{
    const chain_body *bodies = state->at.chain.bodies;
    double *change = all->wrench;
    if (!response_follow(problem, state, drift, bends, change)) return 0;
    found[3] = 0.0;
    for (int q = 0; q < problem->map->count; q++) {
        double *motion = all->motion + W * q, e[3];
        const double *r = bodies[q].rotation;
        placed_leaving(problem, bodies + q, e);
        for (int i = 0; i < W; i++) {
            motion[i] = bends ? drift[W * q + i] : 0.0;
            for (int j = 0; j < contact_size(problem); j++) motion[i] += bodies[q].motion[i][j] * change[j];
        }
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            const double turned = e[j] * motion[3 + l] - e[l] * motion[3 + j];
            found[3] -= e[i] * change[W * q + i] + turned * state->wrench[W * q + i];
            found[i] = r[3 * i] * motion[0] + r[3 * i + 1] * motion[1] + r[3 * i + 2] * motion[2]; /* of the tip, at last */
        }
    }
    return 1;
}

/* How an object at d that moves by v and turns by t about its centre, (6), moves a point of space, (3). */
static void carried(const fingerfem_object *object, double d, const double *motion, const double *place, double *found)
{
    double arm[3];
    for (int i = 0; i < 3; i++) arm[i] = place[i] - object->centre[i] - d * object->direction[i];
    objects_cross(motion + 3, arm, found);
    for (int i = 0; i < 3; i++) found[i] += motion[i];
}

/* The same with such a motion of the object. */
static int report_object(const contact_problem *problem, const contact_state *state, double d, const double *motion,
                         reported_change *all, double *found)
{
    double drift[CHAIN_WRENCH] = {0.0}, v[3];
    for (int q = 0; q < problem->map->count; q++) {
        const chain_body *plate = state->at.chain.bodies + q;
        carried(problem->touching->object, d, motion, plate->centre, v);
        seen_by(plate, v, drift + W * q);
        seen_by(plate, motion + 3, drift + W * q + 3);
        for (int i = 0; i < W; i++) drift[W * q + i] = -drift[W * q + i];
    }
    return report_change(problem, state, drift, NULL, all, found);
}

/* Derivatives of tip and contact force by the tensions and, where it matters, by d and by the object's motion; and, unless it
 * is NULL, all changes by the former, (tensions + 1). */
static int report_derivatives(const contact_problem *problem, const contact_state *state, double d, int d_moves,
                              double *jacobian, double *by_object, reported_change *changes)
{
    const int t = problem->touching->chain->tensions, p = t + 1;
    double drift[CHAIN_WRENCH], found[4], away[W] = {0.0}, bends[FINGERFEM_MOST_CONTACTS][3 * TENSIONS_MOST];
    double along[3 * FINGERFEM_MOST_CONTACTS] = {0.0};
    reported_change own;
    memcpy(away, problem->touching->object->direction, 3 * sizeof *away);
    for (int c = 0; c < state->at.contacts.count; c++)
        if (state->forces[c] > 0.0) placed_bend(problem, &state->at, c, bends[c]);
    for (int k = 0; k < t; k++) {
        for (int i = 0; i < contact_size(problem); i++)
            drift[i] = state->at.chain.bodies[i / W].motion[i % W][contact_size(problem) + k];
        for (int c = 0; c < state->at.contacts.count; c++)
            if (state->forces[c] > 0.0) memcpy(along + 3 * c, bends[c] + 3 * k, 3 * sizeof *along);
        if (!report_change(problem, state, drift, along, changes ? changes + k : &own, found)) return 0;
        for (int i = 0; i < 4; i++) jacobian[p * i + k] = found[i];
    }
    if (d_moves) {
        if (!report_object(problem, state, d, away, changes ? changes + t : &own, found)) return 0;
        for (int i = 0; i < 4; i++) jacobian[p * i + t] = found[i];
    }
    for (int k = 0; k < W && by_object; k++) {
        double unit[W] = {0.0};
        unit[k] = 1.0;
        if (!report_object(problem, state, d, unit, &own, found)) return 0;
        for (int i = 0; i < 4; i++) by_object[W * i + k] = found[i];
    }
    return 1;
}

/* The point of the free plates that the object touches first. */
static void touched_by_plates(const contact_problem *problem, const placed *at, touched_point *first)
{
    const objects_contacts *contacts = &at->contacts;
    const int nearest = placed_nearest(contacts);
    first->plate = at->chain.bodies + contacts->plates[nearest];
    for (int i = 0; i < 3; i++) first->p[i] = contacts->points[nearest][i] + contacts->bent[nearest][i];
    memcpy(first->wrench, contacts->wrenches[nearest], sizeof first->wrench);
    first->off = 0.0;
    placed_bend(problem, at, nearest, first->bends);
}

/* Touch distance and its derivatives by the tensions and by the object's motion, of the point that is touched first. */
static void report_touch(const contact_problem *problem, const touched_point *first, double touch, double *out,
                         double *jacobian, double *by_object)
{
    const int t = problem->touching->chain->tensions;
    const chain_body *plate = first->plate;
    const double *normal = first->wrench;
    double e[3];
    out[4] = touch;
    if (!isfinite(touch)) return;
    placed_leaving(problem, plate, e);
    const double down = objects_dot(normal, e);
    for (int k = 0; k < t; k++) {
        double opened = objects_dot(normal, first->bends + 3 * k);
        for (int i = 0; i < W; i++) opened += normal[i] * plate->motion[i][contact_size(problem) + k];
        jacobian[(t + 1) * 4 + k] = opened / down;
    }
    for (int k = 0; k < W && by_object; k++) {
        double unit[W] = {0.0}, place[3], v[3], seen[3];
        unit[k] = 1.0;
        for (int i = 0; i < 3; i++) place[i] = plate->centre[i] + objects_dot(plate->rotation + 3 * i, first->p);
        carried(problem->touching->object, touch, unit, place, v);
        seen_by(plate, v, seen);
        by_object[W * 4 + k] = -objects_dot(normal, seen) / down;
    }
}

/* Nothing presses, so that nothing follows. */
static void leave_free(const contact_problem *problem, contact_state *state)
{
    state->at.contacts.count = 0;
    for (int i = 0; i < contact_size(problem); i++) {
        memset(state->soft[i], 0, sizeof state->soft[i]);
        memset(state->following[i], 0, sizeof state->following[i]);
        memset(state->at.chain.bodies[i / W].motion[i % W], 0, (size_t)contact_size(problem) * sizeof(double));
    }
}

/* A report, and what it is computed from: zeros where an input changes nothing. */
typedef struct {
    const fingerfem_report *wanted;
    reported_change changes[TENSIONS_MOST + 1];
} reported;

/* Contacts that press at a state that has been solved. */
static void report_pressing(const placed *at, const double *forces, fingerfem_pressing *found)
{
    const objects_contacts *contacts = &at->contacts;
    found->count = 0;
    for (int k = 0; k < contacts->count; k++) {
        const rubber_slice *slice = placed_slice_of(at, k);
        const chain_body *plate = at->chain.bodies + at->arms[k].bodies[0];
        const double *rotation = slice ? slice->rotation : plate->rotation, *centre = slice ? slice->centre : plate->centre;
        double p[3];
        if (!(forces[k] > 0.0)) continue;
        for (int i = 0; i < 3; i++) p[i] = contacts->points[k][i] + contacts->bent[k][i];
        for (int i = 0; i < 3; i++) {
            found->places[found->count][i] = centre[i] + objects_dot(rotation + 3 * i, p);
            found->normals[found->count][i] = objects_dot(rotation + 3 * i, contacts->wrenches[k]);
        }
        found->plates[found->count] = slice ? slice->segment : contacts->plates[k];
        found->rubber[found->count] = slice != NULL;
        found->forces[found->count++] = forces[k];
    }
}

/* As fingerfem_touch. Contacts that press and rows of a report are computed unless it is NULL, and so are estimated errors, (3). */
static int touch_by(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                    double *jacobian, double *by_object, int32_t *inside, reported *more, double *errors, fingerfem_pressing *pressing)
{
    const fingerfem_chain *chain = touching->chain;
    const fingerfem_object *object = touching->object;
    const int t = chain->tensions, p = t + 1;
    double held[TENSIONS_MOST];
    chain_rods map;
    contact_state state;
    touched_point first;
    const contact_problem problem = {touching, &map};
    memset(jacobian, 0, (size_t)(FINGERFEM_ROWS * p) * sizeof *jacobian);
    if (by_object) memset(by_object, 0, W * FINGERFEM_ROWS * sizeof *by_object);
    *inside = tensions_all_clamped(chain->segments[0], point, held);
    chain_set_tensions(chain, held, memory, &map);
    memset(state.wrench, 0, sizeof state.wrench);
    memset(state.forces, 0, sizeof state.forces);
    chain_free(&map, &state.at.chain);
    const double by_plates = placed_touch_distance(&problem, &state.at);
    if (isfinite(by_plates)) touched_by_plates(&problem, &state.at, &first);
    const double touch = rubber_reach(&problem, &state.at, by_plates, &first);
    report_touch(&problem, &first, touch, out, jacobian, by_object);
    double d = point[t] > object->nearest ? point[t] : object->nearest;
    d = d < object->farthest ? d : object->farthest;
    const int touches = d < touch && !(point[t] >= touch), d_moves = d == point[t];
    *inside &= d_moves || point[t] == INFINITY;
    int evaluations = 1;
    if (touches) {
        if (errors) {
            chain_by_variants(&map, 0, &state.at.chain);
            errors[2] = touch_distance_error(&problem, &first);
        }
        chain_take_loads(&map, loads, state.wrench);
        chain_contract(&map);
        evaluations = contact_solve(&problem, touch, d, &state);
        if (evaluations <= 0) state.at.contacts.count = 0; /* those of the last pose, which no forces are known of */
        chain_by_tensions(&map, &state.at.chain);
    } else {
        leave_free(&problem, &state);
    }
    for (int k = 0; k < map.count; k++)
        if (map.bodies[k].segment != CHAIN_GROUND) *inside &= state.at.chain.bodies[k].end.inside;
    report(&problem, &state, out);
    if (!report_derivatives(&problem, &state, d, touches && d_moves, jacobian, touches ? by_object : NULL,
                            more ? more->changes : NULL) &&
        evaluations > 0)
        evaluations = -evaluations;
    if (more) reported_rows(&problem, &state, !touches, more->changes, more->wanted);
    *inside &= evaluations > 0 && (!touches || (response_stable(&problem, &state) && !placed_crowded(&state.at.contacts)));
    if (touches && touch > by_plates && touch - d > ROUNDING && out[3] == 0.0) *inside = 0; /* the object is in the rubber, or passed it */
    for (int k = 0; k < t; k++)
        if (held[k] != point[k]) {
            for (int i = 0; i < FINGERFEM_ROWS; i++) jacobian[p * i + k] = 0.0;
            for (int i = 0; more && i < FINGERFEM_QUATERNION + t; i++) more->wanted->jacobian[p * i + k] = 0.0;
        }
    chain_leave_loads(&map, state.wrench, loads);
    if (pressing) pressing->count = 0;
    if (pressing && touches && evaluations > 0) report_pressing(&state.at, state.forces, pressing);
    if (errors) {
        chain_by_variants(&map, touches, &state.at.chain);
        if (!touches) errors[2] = isfinite(touch) ? touch_distance_error(&problem, &first) : 0.0;
        report_errors(&problem, &state, out[3], jacobian, errors);
        for (int i = 0; i < 2 && evaluations <= 0; i++) errors[i] = INFINITY;
    }
    return evaluations;
}

int fingerfem_touch(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                    double *jacobian, double *by_object, int32_t *inside)
{
    return touch_by(touching, point, memory, loads, out, jacobian, by_object, inside, NULL, NULL, NULL);
}

int fingerfem_touch_pressing(const fingerfem_touching *touching, const double *point, double *memory, double *loads,
                             fingerfem_pressing *pressing)
{
    double out[FINGERFEM_ROWS], jacobian[FINGERFEM_ROWS * (TENSIONS_MOST + 1)];
    int32_t inside;
    return touch_by(touching, point, memory, loads, out, jacobian, NULL, &inside, NULL, NULL, pressing);
}

void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                       double *jacobians, double *by_objects, double *loads, int32_t *inside,
                       int32_t *evaluations, int64_t *nanoseconds)
{
    const int p = touching->chain->tensions + 1, size = fingerfem_chain_loads(touching->chain);
    for (int i = 0; i < count; i++) {
        struct timespec begun, ended;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        evaluations[i] = fingerfem_touch(touching, points + p * i, memory, loads + size * i, out + FINGERFEM_ROWS * i,
                                         jacobians + FINGERFEM_ROWS * p * i,
                                         by_objects ? by_objects + W * FINGERFEM_ROWS * i : NULL, inside + i);
        clock_gettime(CLOCK_MONOTONIC, &ended);
        nanoseconds[i] = (ended.tv_sec - begun.tv_sec) * 1000000000LL + ended.tv_nsec - begun.tv_nsec;
    }
}

int fingerfem_tell(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                   double *jacobian, double *errors, int32_t *inside, const fingerfem_report *report)
{
    reported more;
    more.wanted = report;
    if (report) memset(more.changes, 0, sizeof more.changes);
    const int evaluations = touch_by(touching, point, memory, loads, out, jacobian, NULL, inside, report ? &more : NULL, errors, NULL);
    if (report) {
        const double unknown = evaluations > 0 ? 0.0 : INFINITY;
        report->errors[0] = touching->chain->turn_error + unknown;
        report->errors[1] = touching->chain->shortening_error + unknown;
    }
    return evaluations;
}

void fingerfem_touch_errors(const fingerfem_touching *touching, const double *point, double *memory, double *loads,
                            double *errors)
{
    double out[FINGERFEM_ROWS], jacobian[FINGERFEM_ROWS * (TENSIONS_MOST + 1)];
    int32_t inside;
    touch_by(touching, point, memory, loads, out, jacobian, NULL, &inside, NULL, errors, NULL);
}

void fingerfem_tells(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                     double *errors, int32_t *inside, const fingerfem_report *reports)
{
    const int p = touching->chain->tensions + 1, rows = FINGERFEM_QUATERNION + p - 1;
    double jacobian[FINGERFEM_ROWS * (TENSIONS_MOST + 1)], loads[FINGERFEM_MOST_LOADS];
    for (int i = 0; i < count; i++) {
        const fingerfem_report own = {reports->rows + rows * i, reports->jacobian + rows * p * i,
                                      reports->errors + FINGERFEM_REPORT_ERRORS * i};
        memset(loads, 0, (size_t)fingerfem_chain_loads(touching->chain) * sizeof *loads);
        fingerfem_tell(touching, points + p * i, memory, loads, out + FINGERFEM_ROWS * i, jacobian, errors + 3 * i, inside + i, &own);
    }
}

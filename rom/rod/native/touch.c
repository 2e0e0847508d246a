/* Answers of a touched segment: tip, contact force, touch distance, and their derivatives. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <time.h>
#include "reported.h"
#include "touch_errors.h"

/* A vector of space as a plate sees it. */
static void seen_by(const chain_plate *plate, const double *v, double *found)
{
    const double *r = plate->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
}

/* Tip displacement and contact force, (4), at a state that has been solved. */
static void report(const contact_problem *problem, const contact_state *state, double *out)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const chain_plate *plates = state->at.chain.plates, *tip = plates + chain->plates - 1;
    out[3] = 0.0;
    for (int i = 0; i < 3; i++) out[i] = tip->centre[i] - chain->rest[i];
    for (int q = 0; q < chain->plates; q++) {
        double e[3];
        placed_leaving(problem, plates + q, e);
        for (int i = 0; i < 3; i++) out[3] -= e[i] * state->wrench[W * q + i];
    }
}

int report_change(const contact_problem *problem, const contact_state *state, const double *drift, const double *bends,
                  reported_change *all, double *found)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const chain_plate *plates = state->at.chain.plates;
    double *change = all->wrench;
    if (!response_follow(problem, state, drift, bends, change)) return 0;
    found[3] = 0.0;
    for (int q = 0; q < chain->plates; q++) {
        double *motion = all->motion + W * q, e[3];
        const double *r = plates[q].rotation;
        placed_leaving(problem, plates + q, e);
        for (int i = 0; i < W; i++) {
            motion[i] = bends ? drift[W * q + i] : 0.0;
            for (int j = 0; j < problem->size; j++) motion[i] += plates[q].motion[i][j] * change[j];
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
    for (int q = 0; q < problem->touching->chain->plates; q++) {
        const chain_plate *plate = state->at.chain.plates + q;
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
        if (state->forces[c] > 0.0) placed_bend(problem, &state->at.contacts, c, bends[c]);
    for (int k = 0; k < t; k++) {
        for (int i = 0; i < problem->size; i++)
            drift[i] = state->at.chain.plates[i / W].motion[i % W][problem->size + k];
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
    first->plate = at->chain.plates + contacts->plates[nearest];
    for (int i = 0; i < 3; i++) first->p[i] = contacts->points[nearest][i] + contacts->bent[nearest][i];
    memcpy(first->wrench, contacts->wrenches[nearest], sizeof first->wrench);
    placed_bend(problem, contacts, nearest, first->bends);
}

/* Touch distance and its derivatives by the tensions and by the object's motion, of the point that is touched first. */
static void report_touch(const contact_problem *problem, const touched_point *first, double touch, double *out,
                         double *jacobian, double *by_object)
{
    const int t = problem->touching->chain->tensions;
    const chain_plate *plate = first->plate;
    const double *normal = first->wrench;
    double e[3];
    out[4] = touch;
    if (!isfinite(touch)) return;
    placed_leaving(problem, plate, e);
    const double down = objects_dot(normal, e);
    for (int k = 0; k < t; k++) {
        double opened = objects_dot(normal, first->bends + 3 * k);
        for (int i = 0; i < W; i++) opened += normal[i] * plate->motion[i][problem->size + k];
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
    for (int i = 0; i < problem->size; i++) {
        memset(state->soft[i], 0, sizeof state->soft[i]);
        memset(state->following[i], 0, sizeof state->following[i]);
        memset(state->at.chain.plates[i / W].motion[i % W], 0, (size_t)problem->size * sizeof(double));
    }
}

/* A report, and what it is computed from: zeros where an input changes nothing. */
typedef struct {
    const fingerfem_report *wanted;
    reported_change changes[TENSIONS_MOST + 1];
} reported;

/* As fingerfem_touch; with the rubber, or of plates alone; `rubber` is then 1 if the rubber touches first. Rows of a report
 * are computed unless it is NULL, and so are estimated errors, (3), of an answer where nothing rubs. */
static int touch_by(const fingerfem_touching *touching, const double *point, double *memory, double *wrench, double *out,
                    double *jacobian, double *by_object, int32_t *inside, int *rubber, reported *more, double *errors)
{
    const fingerfem_chain *chain = touching->chain;
    const fingerfem_object *object = touching->object;
    const int t = chain->tensions, p = t + 1;
    double held[TENSIONS_MOST];
    chain_rods map;
    contact_state state;
    touched_point first;
    const contact_problem problem = {touching, &map, W * chain->plates};
    const size_t size = (size_t)problem.size * sizeof *wrench;
    memset(jacobian, 0, (size_t)(FINGERFEM_ROWS * p) * sizeof *jacobian);
    if (by_object) memset(by_object, 0, W * FINGERFEM_ROWS * sizeof *by_object);
    *inside = tensions_all_clamped(chain->segments[0], point, held);
    chain_set_tensions(chain, held, memory, &map);
    memset(state.wrench, 0, sizeof state.wrench);
    memset(state.forces, 0, sizeof state.forces);
    chain_free(&map, &state.at.chain);
    const double touch = placed_touch_distance(&problem, &state.at);
    if (isfinite(touch)) touched_by_plates(&problem, &state.at, &first);
    const double reach = rubber ? rubber_reach(&problem, &state.at.chain, touch, &first) : touch;
    report_touch(&problem, &first, reach, out, jacobian, by_object);
    if (rubber) *rubber = reach > touch;
    double d = point[t] > object->nearest ? point[t] : object->nearest;
    d = d < object->farthest ? d : object->farthest;
    const int touches = d < touch && !(point[t] >= touch), d_moves = d == point[t];
    *inside &= d_moves || point[t] == INFINITY;
    int evaluations = 1;
    if (touches) {
        if (errors) {
            chain_by_variants(&map, 0, &state.at.chain);
            errors[2] = touch_distance_error(&problem, &first, rubber && *rubber);
        }
        memcpy(state.wrench, wrench, size);
        chain_contract(&map);
        evaluations = contact_solve(&problem, touch, d, &state);
        chain_by_tensions(&map, &state.at.chain);
    } else {
        leave_free(&problem, &state);
    }
    for (int k = 0; k < chain->plates; k++) *inside &= state.at.chain.plates[k].end.inside;
    report(&problem, &state, out);
    if (!report_derivatives(&problem, &state, d, touches && d_moves, jacobian, touches ? by_object : NULL,
                            more ? more->changes : NULL) &&
        evaluations > 0)
        evaluations = -evaluations;
    if (more) reported_rows(&problem, &state, !touches, more->changes, more->wanted);
    *inside &= evaluations > 0 && (!touches || response_stable(&problem, &state));
    for (int k = 0; k < t; k++)
        if (held[k] != point[k]) {
            for (int i = 0; i < FINGERFEM_ROWS; i++) jacobian[p * i + k] = 0.0;
            for (int i = 0; more && i < FINGERFEM_QUATERNION + t; i++) more->wanted->jacobian[p * i + k] = 0.0;
        }
    memcpy(wrench, state.wrench, size);
    if (errors) {
        chain_by_variants(&map, touches, &state.at.chain);
        if (!touches) errors[2] = isfinite(reach) ? touch_distance_error(&problem, &first, rubber && *rubber) : 0.0;
        report_errors(&problem, &state, out[3], jacobian[p * 3 + t], errors);
        for (int i = 0; i < 2 && evaluations <= 0; i++) errors[i] = INFINITY;
    }
    return evaluations;
}

int fingerfem_touch(const fingerfem_touching *touching, const double *point, double *memory, double *wrench, double *out,
                    double *jacobian, double *by_object, int32_t *inside)
{
    int rubber;
    return touch_by(touching, point, memory, wrench, out, jacobian, by_object, inside, &rubber, NULL, NULL);
}

int fingerfem_press(const fingerfem_touching *touching, const double *point, double *memory, double *wrench, double *out,
                    double *jacobian, int32_t *inside)
{
    return touch_by(touching, point, memory, wrench, out, jacobian, NULL, inside, NULL, NULL, NULL);
}

void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                       double *jacobians, double *by_objects, double *wrenches, int32_t *inside,
                       int32_t *evaluations, int64_t *nanoseconds, double *rubber_gaps)
{
    const int p = touching->chain->tensions + 1;
    for (int i = 0; i < count; i++) {
        struct timespec begun, ended;
        double *wrench = wrenches + W * touching->chain->plates * i;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        evaluations[i] = fingerfem_touch(touching, points + p * i, memory, wrench, out + FINGERFEM_ROWS * i,
                                         jacobians + FINGERFEM_ROWS * p * i,
                                         by_objects ? by_objects + W * FINGERFEM_ROWS * i : NULL, inside + i);
        clock_gettime(CLOCK_MONOTONIC, &ended);
        nanoseconds[i] = (ended.tv_sec - begun.tv_sec) * 1000000000LL + ended.tv_nsec - begun.tv_nsec;
        rubber_gaps[i] = fingerfem_rubber_gap(touching, points + p * i, wrench, memory);
        inside[i] &= !(rubber_gaps[i] < touching->chain->skin_error);
    }
}

int fingerfem_tell(const fingerfem_touching *touching, const double *point, double *memory, double *wrench, double *out,
                   double *jacobian, double *errors, int32_t *inside, double *rubber_gap, const fingerfem_report *report)
{
    int rubber;
    reported more;
    more.wanted = report;
    if (report) memset(more.changes, 0, sizeof more.changes);
    const int evaluations =
        touch_by(touching, point, memory, wrench, out, jacobian, NULL, inside, &rubber, report ? &more : NULL, errors);
    *rubber_gap = fingerfem_rubber_gap(touching, point, wrench, memory);
    *inside &= !(*rubber_gap < touching->chain->skin_error);
    if (report) {
        const double unknown = evaluations > 0 ? 0.0 : INFINITY;
        report->errors[0] = touching->chain->turn_error + unknown;
        report->errors[1] = touching->chain->shortening_error + unknown;
    }
    return evaluations;
}

void fingerfem_touch_errors(const fingerfem_touching *touching, const double *point, double *memory, double *wrench,
                            double *errors)
{
    double out[FINGERFEM_ROWS], jacobian[FINGERFEM_ROWS * (TENSIONS_MOST + 1)];
    int32_t inside;
    int rubber;
    touch_by(touching, point, memory, wrench, out, jacobian, NULL, &inside, &rubber, NULL, errors);
}

void fingerfem_tells(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                     double *errors, int32_t *inside, const fingerfem_report *reports)
{
    const int p = touching->chain->tensions + 1, rows = FINGERFEM_QUATERNION + p - 1;
    double jacobian[FINGERFEM_ROWS * (TENSIONS_MOST + 1)], gap;
    for (int i = 0; i < count; i++) {
        double wrench[CHAIN_WRENCH] = {0.0};
        const fingerfem_report own = {reports->rows + rows * i, reports->jacobian + rows * p * i,
                                      reports->errors + FINGERFEM_REPORT_ERRORS * i};
        fingerfem_tell(touching, points + p * i, memory, wrench, out + FINGERFEM_ROWS * i, jacobian, errors + 3 * i, inside + i,
                       &gap, &own);
    }
}

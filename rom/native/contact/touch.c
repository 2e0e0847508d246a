/* Answers of a chain that objects touch: tip displacement, contact forces, touch distances, and their derivatives. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <time.h>
#include "bulged.h"
#include "reported.h"
#include "touch_errors.h"

#define ROUNDING 1e-8 /* an object past its touch distance by less than this may press with no force [m] */

enum { MOST_ROWS = FINGERFEM_MOST_ROWS_TOUCHED, MOST_PARAMETERS = TENSIONS_MOST + FINGERFEM_MOST_OBJECTS };

/* The wrenches of object j's contacts on all bodies; of a single object these are the state's wrenches. */
static void wrenches_with(const contact_problem *problem, const contact_state *state, int j, double *wrench)
{
    if (problem->touching->count == 1) memcpy(wrench, state->wrench, (size_t)contact_size(problem) * sizeof *wrench);
    else response_wrenches(problem, state, j, wrench);
}

/* R^T v: a vector of space in a body's frame. */
static void seen_by(const chain_body *plate, const double *v, double *found)
{
    const double *r = plate->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
}

/* The tip's displacement and every object's force, (3 + count), at a solved state. */
static void report(const contact_problem *problem, const contact_state *state, double *out)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const chain_body *bodies = state->at.chain.bodies, *tip = bodies + problem->map->count - 1;
    /* tip displacement: centre of the last plate, minus that at rest [m] */
    for (int i = 0; i < 3; i++) out[i] = tip->centre[i] - chain->rest[i];
    /* N_j = -sum_q e . f_q over all bodies q: force of object j against its direction e [N] */
    for (int j = 0; j < problem->touching->count; j++) {
        double wrench[CHAIN_WRENCH], e[3];
        wrenches_with(problem, state, j, wrench);
        out[3 + j] = 0.0;
        for (int q = 0; q < problem->map->count; q++) {
            placed_leaving(problem, j, bodies + q, e);
            out[3 + j] -= objects_dot(e, wrench + W * q);
        }
    }
}

int report_change(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                  reported_change *all, double *found)
{
    const chain_body *bodies = state->at.chain.bodies;
    double *change = all->wrench, own[FINGERFEM_MOST_OBJECTS][CHAIN_WRENCH];
    if (!response_follow(problem, state, only, drift, bends, change, own)) return 0;
    /* motion of every body: C dw, plus the drift if that is a motion of the bodies */
    for (int q = 0; q < problem->map->count; q++) {
        double *motion = all->motion + W * q;
        for (int i = 0; i < W; i++) {
            motion[i] = bends ? drift[W * q + i] : 0.0;
            for (int j = 0; j < contact_size(problem); j++) motion[i] += bodies[q].motion[i][j] * change[j];
        }
    }
    /* motion of the tip in space: R (R^T dc) */
    const double *r = bodies[problem->map->count - 1].rotation, *tip = all->motion + W * (problem->map->count - 1);
    for (int i = 0; i < 3; i++) found[i] = objects_dot(r + 3 * i, tip);
    /* dN_j = -sum_q (e . df_q + (e x theta_q) . f_q): the second term as e turns in the frame of body q */
    for (int j = 0; j < problem->touching->count; j++) {
        double wrench[CHAIN_WRENCH], e[3], turned[3];
        wrenches_with(problem, state, j, wrench);
        found[3 + j] = 0.0;
        for (int q = 0; q < problem->map->count; q++) {
            placed_leaving(problem, j, bodies + q, e);
            objects_cross(e, all->motion + W * q + 3, turned);
            found[3 + j] -= objects_dot(e, own[j] + W * q) + objects_dot(turned, wrench + W * q);
        }
    }
    return 1;
}

/* Displacement, (3), of a point fixed to an object at d, as this moves by v and turns by t about its centre, (v, t) =
 * `motion`: v + t x (place - centre). */
static void carried(const fingerfem_object *object, double d, const double *motion, const double *place, double *found)
{
    double arm[3];
    for (int i = 0; i < 3; i++) arm[i] = place[i] - object->centre[i] - d * object->direction[i];
    objects_cross(motion + 3, arm, found);
    for (int i = 0; i < 3; i++) found[i] += motion[i];
}

/* As `report_change`, for a motion (v, t) of object j, which is at d: every body drifts by the opposite motion. */
static int report_object(const contact_problem *problem, const contact_state *state, int j, double d, const double *motion,
                         reported_change *all, double *found)
{
    double drift[CHAIN_WRENCH] = {0.0}, v[3];
    /* drift of body q relative to the object, in the body's frame: -R^T (v + t x arm), -R^T t */
    for (int q = 0; q < problem->map->count; q++) {
        const chain_body *plate = state->at.chain.bodies + q;
        carried(contact_object(problem, j), d, motion, plate->centre, v);
        seen_by(plate, v, drift + W * q);
        seen_by(plate, motion + 3, drift + W * q + 3);
        for (int i = 0; i < W; i++) drift[W * q + i] = -drift[W * q + i];
    }
    return report_change(problem, state, problem->touching->count == 1 ? -1 : j, drift, NULL, all, found);
}

/* Derivatives of the tip and of all forces, by the tensions and by d of the objects with `d_moves`, and, unless
 * `by_object` is NULL, by the motion of every object, (6). Unless it is NULL, `changes`, (tensions + count), takes the
 * changes of all wrenches and poses by tensions and d. Returns 0 where the response is singular. */
static int report_derivatives(const contact_problem *problem, const contact_state *state, const double *d, const int *d_moves,
                              double *jacobian, double *by_object, reported_change *changes)
{
    const int t = problem->touching->chain->tensions, m = problem->touching->count, p = t + m, rows = 3 + m;
    double drift[CHAIN_WRENCH], found[3 + FINGERFEM_MOST_OBJECTS], bends[FINGERFEM_MOST_CONTACTS][3 * TENSIONS_MOST];
    double along[3 * FINGERFEM_MOST_CONTACTS] = {0.0};
    reported_change own;
    /* motion of the loaded contacts' points with the tensions, besides that of their bodies (tensions, 3) */
    for (int c = 0; c < state->at.contacts.count; c++)
        if (state->forces[c] > 0.0) placed_bend(problem, &state->at, c, bends[c]);
    /* columns of the tensions: by F_k all bodies drift, and contact points move by their bend */
    for (int k = 0; k < t; k++) {
        for (int i = 0; i < contact_size(problem); i++)
            drift[i] = state->at.chain.bodies[i / W].motion[i % W][contact_size(problem) + k];
        for (int c = 0; c < state->at.contacts.count; c++)
            if (state->forces[c] > 0.0) memcpy(along + 3 * c, bends[c] + 3 * k, 3 * sizeof *along);
        if (!report_change(problem, state, -1, drift, along, changes ? changes + k : &own, found)) return 0;
        for (int i = 0; i < rows; i++) jacobian[p * i + k] = found[i];
    }
    /* columns of d: object j moves along its direction */
    for (int j = 0; j < m; j++) {
        double away[W] = {0.0};
        memcpy(away, contact_object(problem, j)->direction, 3 * sizeof *away);
        if (d_moves[j]) {
            if (!report_object(problem, state, j, d[j], away, changes ? changes + t + j : &own, found)) return 0;
            for (int i = 0; i < rows; i++) jacobian[p * i + t + j] = found[i];
        }
        /* columns of the motion of object j: three displacements, three turns about its centre */
        for (int k = 0; k < W && by_object; k++) {
            double unit[W] = {0.0};
            unit[k] = 1.0;
            if (!contact_is_there(problem, j)) continue;
            if (!report_object(problem, state, j, d[j], unit, &own, found)) return 0;
            for (int i = 0; i < rows; i++) by_object[W * m * i + W * j + k] = found[i];
        }
    }
    return 1;
}

/* The point of the free plates that the object touches first: that of the contact with the least gap. */
static void touched_by_plates(const contact_problem *problem, const placed *at, touched_point *first)
{
    const objects_contacts *contacts = &at->contacts;
    const int nearest = placed_nearest(contacts);
    /* point p + bent in the plate's frame, and the wrench (n, p x n) of a unit force */
    first->plate = at->chain.bodies + contacts->plates[nearest];
    for (int i = 0; i < 3; i++) first->p[i] = contacts->points[nearest][i] + contacts->bent[nearest][i];
    memcpy(first->wrench, contacts->wrenches[nearest], sizeof first->wrench);
    first->off = 0.0;
    placed_bend(problem, at, nearest, first->bends);
}

/* Touch distance of object j, and its derivatives by the tensions and by the object's motion, from the gap at the point
 * that is touched first: dg = n . dx - (n . e) dd = 0. */
static void report_touch(const contact_problem *problem, int j, const touched_point *first, double touch, double *out,
                         double *jacobian, double *by_object)
{
    const int t = problem->touching->chain->tensions, m = problem->touching->count, row = 3 + m + j;
    const chain_body *plate = first->plate;
    const double *normal = first->wrench;
    double e[3];
    out[row] = touch;
    if (!isfinite(touch)) return;
    /* n . e: the gap grows by -n . e per d */
    placed_leaving(problem, j, plate, e);
    const double down = objects_dot(normal, e);
    /* dd/dF_k = (n . b_k + W . xi_k) / (n . e), as the surface bends by b_k and the plate moves by xi_k */
    for (int k = 0; k < t; k++) {
        double opened = objects_dot(normal, first->bends + 3 * k);
        for (int i = 0; i < W; i++) opened += normal[i] * plate->motion[i][contact_size(problem) + k];
        jacobian[(t + m) * row + k] = opened / down;
    }
    /* dd = -n . v / (n . e), as a unit motion of the object displaces its touching point by v */
    for (int k = 0; k < W && by_object; k++) {
        double unit[W] = {0.0}, place[3], v[3], seen[3];
        unit[k] = 1.0;
        for (int i = 0; i < 3; i++) place[i] = plate->centre[i] + objects_dot(plate->rotation + 3 * i, first->p);
        carried(contact_object(problem, j), touch, unit, place, v);
        seen_by(plate, v, seen);
        by_object[W * m * row + W * j + k] = -objects_dot(normal, seen) / down;
    }
}

/* No contact presses: no contacts, S = 1, and G and C are zero. */
static void leave_free(const contact_problem *problem, contact_state *state)
{
    state->at.contacts.count = 0;
    for (int i = 0; i < contact_size(problem); i++) {
        memset(state->factors[i], 0, sizeof state->factors[i]);
        state->factors[i][i] = 1.0;
        state->exchanged[i] = i;
        memset(state->following[i], 0, sizeof state->following[i]);
        memset(state->at.chain.bodies[i / W].motion[i % W], 0, (size_t)contact_size(problem) * sizeof(double));
    }
}

/* A report, and what it is computed from: zeros where an input changes nothing. */
typedef struct {
    const fingerfem_report *wanted;
    reported_change changes[TENSIONS_MOST + FINGERFEM_MOST_OBJECTS];
} reported;

void report_pressing(const placed *at, const double *forces, fingerfem_pressing *found)
{
    const objects_contacts *contacts = &at->contacts;
    found->count = 0;
    for (int k = 0; k < contacts->count; k++) {
        const rubber_slice *slice = placed_slice_of(at, k);
        const chain_body *plate = at->chain.bodies + at->arms[k].bodies[0];
        const double *rotation = slice ? slice->rotation : plate->rotation, *centre = slice ? slice->centre : plate->centre;
        double p[3];
        if (!(forces[k] > 0.0)) continue;
        /* place c + R p [m] and normal R n in space */
        for (int i = 0; i < 3; i++) p[i] = contacts->points[k][i] + contacts->bent[k][i];
        for (int i = 0; i < 3; i++) {
            found->places[found->count][i] = centre[i] + objects_dot(rotation + 3 * i, p);
            found->normals[found->count][i] = objects_dot(rotation + 3 * i, contacts->wrenches[k]);
        }
        found->plates[found->count] = slice ? slice->segment : contacts->plates[k];
        found->rubber[found->count] = slice != NULL;
        found->objects[found->count] = contacts->objects[k];
        found->forces[found->count++] = forces[k];
    }
}

/* Positions of all objects, and their common approach: the lead moves, and the others keep their offsets from it. */
typedef struct {
    int lead;                             /* the first object at a finite d; -1 if there is none */
    int any;                              /* whether an object reaches the free finger */
    int touches[FINGERFEM_MOST_OBJECTS];  /* whether this one does */
    int moves[FINGERFEM_MOST_OBJECTS];    /* and its d lies in its range, so that derivatives by d are not zero */
    double d[FINGERFEM_MOST_OBJECTS];     /* clamped to the range [m] */
    double touch;                         /* d of the lead at which the first object touches the free finger [m] */
} approached;

/* Positions of the objects by their distances, (count), and touch distances, (count); and `ahead` of the problem. */
static void approach_of(const fingerfem_touching *touching, const double *distances, const double *touch, contact_problem *problem,
                        approached *found)
{
    found->lead = -1;
    found->any = 0;
    found->touch = -INFINITY;
    /* d_j clamped to its range, objects that reach the free finger, and the lead */
    for (int j = 0; j < touching->count; j++) {
        const fingerfem_object *object = touching->objects[j];
        const double given = distances[j], d = given > object->nearest ? given : object->nearest;
        found->d[j] = d < object->farthest ? d : object->farthest;
        found->touches[j] = found->d[j] < touch[j] && !(given >= touch[j]);
        found->any |= found->touches[j];
        found->moves[j] = found->touches[j] && found->d[j] == given;
        if (found->lead < 0 && given != INFINITY) found->lead = j;
    }
    /* offsets d_j - d_lead, and the lead's d where the first object touches: max_j (touch_j - offset_j) */
    for (int j = 0; j < touching->count && found->lead >= 0; j++) {
        problem->ahead[j] = distances[j] == INFINITY ? INFINITY : found->d[j] - found->d[found->lead];
        if (contact_is_there(problem, j)) found->touch = fmax(found->touch, touch[j] - problem->ahead[j]);
    }
}

/* As fingerfem_touch. Unless they are NULL, it also computes the rows of a report, `more`, the contacts that press,
 * `pressing`, and the estimated errors, (1 + 2 count): of the tip, of all forces, and of all touch distances. */
static int touch_by(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                    double *jacobian, double *by_object, int32_t *inside, reported *more, double *errors, fingerfem_pressing *pressing)
{
    const fingerfem_chain *chain = touching->chain;
    const int t = chain->tensions, m = touching->count, p = t + m, rows = 3 + 2 * m;
    double held[TENSIONS_MOST], by_plates[FINGERFEM_MOST_OBJECTS], lifted[FINGERFEM_MOST_OBJECTS], *touch = out + 3 + m, pressed = 0.0;
    chain_rods map;
    contact_state state;
    touched_point first[FINGERFEM_MOST_OBJECTS];
    approached now;
    contact_problem problem = {touching, &map, {0.0}, NULL, 1.0};
    /* derivatives are zero where nothing below sets them */
    memset(jacobian, 0, (size_t)(rows * p) * sizeof *jacobian);
    if (by_object) memset(by_object, 0, (size_t)(W * m * rows) * sizeof *by_object);
    /* free finger at the tensions, clamped to their box */
    *inside = chain_clamped(chain, point, held);
    chain_set_tensions(chain, held, memory, &map);
    memset(state.wrench, 0, sizeof state.wrench);
    memset(state.forces, 0, sizeof state.forces);
    const int rests = chain_free(&map, &state.at.chain);
    /* touch distance of every object: the larger one of the plates' and the rubber's */
    for (int j = 0; j < m; j++) {
        by_plates[j] = placed_touch_distance(&problem, j, &state.at);
        if (isfinite(by_plates[j])) touched_by_plates(&problem, &state.at, first + j);
        report_touch(&problem, j, first + j, rubber_reach(&problem, j, &state.at, by_plates[j], first + j), out, jacobian, by_object);
    }
    /* how much earlier faces over chambers may touch */
    for (int j = 0; j < m; j++)
        lifted[j] = isfinite(touch[j]) ? fmax(bulged_depth(&problem, &state.at.chain, 1, j, touch[j], held), 0.0) : 0.0;
    /* positions of the objects; outside the trained range if a d was clamped */
    approach_of(touching, point + t, touch, &problem, &now);
    for (int j = 0; j < m; j++) *inside &= now.d[j] == point[t + j] || point[t + j] == INFINITY;
    int evaluations = rests ? 1 : -1; /* the weight of the free finger has no equilibrium */
    if (now.any) {
        /* errors of the touch distances, by the motions of the free plates with the variants */
        if (errors) {
            chain_by_variants(&map, 0, &state.at.chain);
            for (int j = 0; j < m; j++) errors[1 + m + j] = isfinite(touch[j]) ? touch_distance_error(&problem, j, first + j) : 0.0;
        }
        /* solve for wrenches and contact forces, from the given loads; then motions by the tensions */
        chain_take_loads(&map, loads, state.wrench);
        if (!map.weight) chain_contract(&map); /* else that is done */
        evaluations = contact_solve(&problem, now.touch, now.d[now.lead], &state);
        if (!rests && evaluations > 0) evaluations = -evaluations;
        if (evaluations <= 0) state.at.contacts.count = 0; /* contacts of the last pose have no solved forces */
        chain_by_tensions(&map, &state.at.chain);
    } else {
        leave_free(&problem, &state);
    }
    /* inside: the wrenches of all elements lie in their trained boxes */
    for (int k = 0; k < map.count; k++)
        if (map.bodies[k].segment != CHAIN_GROUND) *inside &= state.at.chain.bodies[k].end.inside;
    /* answer, derivatives and report; a singular response counts as no equilibrium */
    report(&problem, &state, out);
    if (!report_derivatives(&problem, &state, now.d, now.moves, jacobian, now.any ? by_object : NULL, more ? more->changes : NULL) &&
        evaluations > 0)
        evaluations = -evaluations;
    if (more) reported_rows(&problem, &state, !now.any, more->changes, more->wanted);
    /* inside: there is an equilibrium, it is stable, and no contacts are missing */
    *inside &= evaluations > 0 && (!now.any || (response_stable(&problem, &state) && !placed_crowded(&state.at.contacts)));
    /* no force at all, though an object reaches rubber that it touches before the plates: not inside */
    for (int j = 0; j < m; j++) pressed += out[3 + j];
    for (int j = 0; j < m && pressed == 0.0; j++) /* it is in the rubber, or passed it */
        if (now.touches[j] && touch[j] > by_plates[j] && touch[j] - now.d[j] > ROUNDING) *inside = 0;
    /* an object may press on a face over a chamber: not inside */
    for (int j = 0; j < m; j++)
        if (isfinite(point[t + j]) && bulged_depth(&problem, &state.at.chain, !now.any, j, now.d[j], held) > 0.0) *inside = 0;
    /* derivatives by clamped tensions are zero */
    for (int k = 0; k < t; k++)
        if (held[k] != point[k]) {
            for (int i = 0; i < rows; i++) jacobian[p * i + k] = 0.0;
            for (int i = 0; more && i < FINGERFEM_QUATERNION + t; i++) more->wanted->jacobian[p * i + k] = 0.0;
        }
    /* results: loads where the solve ended, and contacts that press */
    chain_leave_loads(&map, state.wrench, loads);
    if (pressing) pressing->count = 0;
    if (pressing && now.any && evaluations > 0) report_pressing(&state.at, state.forces, pressing);
    /* estimated errors by the motions with the variants; infinite without an equilibrium */
    if (errors) {
        chain_by_variants(&map, now.any, &state.at.chain);
        for (int j = 0; j < m && !now.any; j++) errors[1 + m + j] = isfinite(touch[j]) ? touch_distance_error(&problem, j, first + j) : 0.0;
        report_errors(&problem, &state, out + 3, jacobian, errors);
        for (int j = 0; j < m; j++) errors[1 + m + j] += lifted[j];
        for (int i = 0; i < 1 + m && evaluations <= 0; i++) errors[i] = INFINITY;
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
    double out[MOST_ROWS], jacobian[MOST_ROWS * MOST_PARAMETERS];
    int32_t inside;
    return touch_by(touching, point, memory, loads, out, jacobian, NULL, &inside, NULL, NULL, pressing);
}

void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                       double *jacobians, double *by_objects, double *loads, int32_t *inside,
                       int32_t *evaluations, int64_t *nanoseconds)
{
    const int m = touching->count, p = touching->chain->tensions + m, rows = 3 + 2 * m, size = fingerfem_chain_loads(touching->chain);
    for (int i = 0; i < count; i++) {
        /* answer i and its duration [ns] */
        struct timespec begun, ended;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        evaluations[i] = fingerfem_touch(touching, points + p * i, memory, loads + size * i, out + rows * i, jacobians + rows * p * i,
                                         by_objects ? by_objects + W * m * rows * i : NULL, inside + i);
        clock_gettime(CLOCK_MONOTONIC, &ended);
        nanoseconds[i] = (ended.tv_sec - begun.tv_sec) * 1000000000LL + ended.tv_nsec - begun.tv_nsec;
    }
}

int fingerfem_evaluate(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                   double *jacobian, double *errors, int32_t *inside, const fingerfem_report *report)
{
    reported more;
    more.wanted = report;
    if (report) memset(more.changes, 0, sizeof more.changes);
    const int evaluations = touch_by(touching, point, memory, loads, out, jacobian, NULL, inside, report ? &more : NULL, errors, NULL);
    /* estimated errors of orientation and shortenings; infinite without an equilibrium */
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
    double out[MOST_ROWS], jacobian[MOST_ROWS * MOST_PARAMETERS];
    int32_t inside;
    touch_by(touching, point, memory, loads, out, jacobian, NULL, &inside, NULL, errors, NULL);
}

void fingerfem_evaluate_many(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                     double *errors, int32_t *inside, const fingerfem_report *reports)
{
    const int t = touching->chain->tensions, m = touching->count, p = t + m, rows = FINGERFEM_QUATERNION + t;
    double jacobian[MOST_ROWS * MOST_PARAMETERS], loads[FINGERFEM_MOST_LOADS];
    for (int i = 0; i < count; i++) {
        /* answer i from rest, with its own part of the reports */
        const fingerfem_report own = {reports->rows + rows * i, reports->jacobian + rows * p * i,
                                      reports->errors + FINGERFEM_REPORT_ERRORS * i};
        memset(loads, 0, (size_t)fingerfem_chain_loads(touching->chain) * sizeof *loads);
        fingerfem_evaluate(touching, points + p * i, memory, loads, out + (3 + 2 * m) * i, jacobian, errors + (1 + 2 * m) * i, inside + i, &own);
    }
}

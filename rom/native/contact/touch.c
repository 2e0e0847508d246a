/* Answers of a chain that objects touch: the solve at a point, and what is asked about it. */
#include <math.h>
#include "bulged.h"
#include "response.h"
#include "touch_errors.h"

#define ROUNDING 1e-8 /* an object past its touch distance by less than this may press with no force [m] */

enum { MOST_ROWS = FINGERFEM_MOST_ROWS_TOUCHED, MOST_PARAMETERS = TENSIONS_MOST + FINGERFEM_MOST_OBJECTS };

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
        if (!(forces[k] > 0.0)) continue;
        placed_point(at, k, found->places[found->count], found->normals[found->count]);
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
        if (isfinite(by_plates[j])) answer_touched(&problem, &state.at, first + j);
        answer_touch(&problem, j, first + j, rubber_reach(&problem, j, &state.at, by_plates[j], first + j), out, jacobian, by_object);
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
    answer_report(&problem, &state, out);
    if (!answer_derivatives(&problem, &state, now.d, now.moves, jacobian, now.any ? by_object : NULL, more ? more->changes : NULL) &&
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
                       int32_t *evaluations)
{
    const int m = touching->count, p = touching->chain->tensions + m, rows = 3 + 2 * m, size = fingerfem_chain_loads(touching->chain);
    for (int i = 0; i < count; i++)
        evaluations[i] = fingerfem_touch(touching, points + p * i, memory, loads + size * i, out + rows * i, jacobians + rows * p * i,
                                         by_objects ? by_objects + W * m * rows * i : NULL, inside + i);
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

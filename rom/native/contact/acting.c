/* A contact's force f at the end of a step of time acts over the step as follows, so that lasting contact makes no energy.
 *
 * By the wrench W at the step's end it would do the work f W . x, where bodies move by x. As W turns, the gap changes by another g_1 - g_0.
 * So a plate's force acts by a mean of the wrenches at both ends, a discrete gradient of the gap (Gonzalez, J. Nonlinear Sci. 6, 1996):
 *
 *     V = (1 - s) W_1 + s W_0,   V . x = g_1 - g_0:   s = (W_1 . x - g_1 + g_0) / (W_1 . x - W_0 . x), from 0 to 1.
 *
 * There is one wherever the gap is convex or concave on the way. With f g_1 = 0 its work is -f g_0 <= 0. A contact whose point
 * jumps takes the W_0 and g_0 of its point at the end, which lies outside the object then. Rubber's wrenches have s = 1/2, as its shape changes gaps besides.
 *
 * Rubber is a spring. Its mean force is that of the method for elements, (1 - m) f + m f_0 with their m, but 2 f in place of f_0 if that is
 * less: where an object leaves, nothing pushes on. A plate is rigid: f is an impulse of this step.
 *
 * Where a step turns a body farther than it resolves, s falls to 0, as at rest.
 *
 * Forces are vectors of space, moments those of a body's own frame, in which the turn x of a step, R_0^T R_1 = exp(x), is one at both ends. */
#include "acting.h"
#include <math.h>
#include "inertia.h"
#include "response.h"

#define JUMP 0.1       /* of half the side: distance of a contact's points at both ends, above which it jumped [-] */
#define TURN 0.1       /* of a body in a step, above which its turn is not resolved: s falls to 0 at twice that [rad] */
#define STRAIGHT 1e-15 /* change of W . x over a step below which s is 1/2 [m] */

void acting_at_end(placed *at, int k)
{
    contact_acting *own = at->acting + k;
    memcpy(own->wrenches, at->arms[k].wrenches, sizeof own->wrenches);
    own->share = own->fixed = 0.0;
    own->slope = 1.0;
}

void acting_leave(const contact_state *state, fingerfem_pressed *pressed)
{
    const objects_contacts *contacts = &state->at.contacts;
    pressed->count = 0;
    for (int k = 0; k < contacts->count; k++) {
        const int at = pressed->count;
        if (!(state->forces[k] > 0.0)) continue;
        pressed->parts[at] = contacts->plates[k];
        pressed->names[at] = contacts->names[k];
        pressed->objects[at] = contacts->objects[k];
        pressed->forces[at] = state->forces[k];
        pressed->count++;
    }
}

int acting_on_rubber(const fingerfem_pressed *pressed)
{
    for (int j = 0; j < pressed->count; j++)
        if (pressed->parts[j] >= FINGERFEM_MOST_PLATES) return 1;
    return 0;
}

double acting_pressed(const fingerfem_pressed *pressed, const objects_contacts *contacts, int k)
{
    for (int j = 0; j < pressed->count; j++)
        if (pressed->parts[j] == contacts->plates[k] && pressed->names[j] == contacts->names[k] && pressed->objects[j] == contacts->objects[k])
            return pressed->forces[j];
    return 0.0;
}

/* Bodies and contacts of the first pose, and the forces with which the solve starts. */
static void begin_with(const contact_problem *problem, contact_state *state, acting_begin *found)
{
    const objects_contacts *contacts = &state->at.contacts;
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const int load = chain_load_of(problem->map, b);
        memcpy(found->centres[load], state->at.chain.bodies[b].centre, sizeof found->centres[load]);
        memcpy(found->rotations[load], state->at.chain.bodies[b].rotation, sizeof found->rotations[load]);
    }
    found->count = contacts->count;
    for (int k = 0; k < contacts->count; k++) {
        found->names[k] = contacts->names[k];
        found->plates[k] = contacts->plates[k];
        found->objects[k] = contacts->objects[k];
        found->gaps[k] = contacts->gaps[k];
        found->forces[k] = state->forces[k] = acting_pressed(problem->step->pressed, contacts, k);
        memcpy(found->points[k], contacts->points[k], sizeof found->points[k]);
        memcpy(found->wrenches[k], state->at.arms[k].wrenches, sizeof found->wrenches[k]);
    }
}

/* Number of the contact at the beginning of the step that has the name and about the point of contact k; -1 for a new contact. The search begins
 * at `from`: the order of contacts hardly changes in a step. */
static int begun_as(const contact_problem *problem, const objects_contacts *now, int k, int from)
{
    const acting_begin *begin = problem->step->begin;
    const double most = JUMP * problem->touching->chain->segments[0]->half_lengths[1];
    for (int i = 0, j = from < begin->count ? from : 0; i < begin->count; i++, j = j + 1 < begin->count ? j + 1 : 0) {
        double away = 0.0;
        if (begin->names[j] != now->names[k] || begin->plates[j] != now->plates[k] || begin->objects[j] != now->objects[k]) continue;
        for (int i = 0; i < 3; i++) away = fmax(away, fabs(now->points[k][i] - begin->points[j][i]));
        return away < most ? j : -1;
    }
    return -1;
}

/* The wrench of a unit force on the point of a plate's contact k where the plate was as the step began, and the gap of that point there. */
static double begun_at_point(const contact_problem *problem, const placed *at, int k, const double *centre, const double *rotation, double *wrench)
{
    const int j = at->contacts.objects[k];
    double p[3], x[3], n[3];
    for (int i = 0; i < 3; i++) p[i] = at->contacts.points[k][i] + at->contacts.bent[k][i];
    for (int i = 0; i < 3; i++) x[i] = centre[i] + objects_dot(rotation + 3 * i, p);
    const double gap = objects_distance(contact_object(problem, j), at->d + problem->ahead[j], x, n);
    objects_turned_back(rotation, n, wrench);
    objects_cross(p, wrench, wrench + 3);
    return gap;
}

/* Motions of all bodies since the step's begin, each in its own frame of now; and R_1^T R_0. */
typedef struct {
    double moved[W], turned, back[9];
} body_motion;

static void motions_of(const contact_problem *problem, const placed *at, body_motion *found)
{
    for (int b = 0; b < problem->map->count; b++, found++) {
        const double *R = at->chain.bodies[b].rotation;
        double way[3];
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const int load = chain_load_of(problem->map, b);
        const double *centre = problem->step->begin->centres[load], *Q = problem->step->begin->rotations[load];
        for (int i = 0; i < 3; i++) way[i] = at->chain.bodies[b].centre[i] - centre[i];
        objects_turned_back(R, way, found->moved);
        inertia_turn_between(Q, R, found->moved + 3);
        found->turned = sqrt(objects_dot(found->moved + 3, found->moved + 3));
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) found->back[3 * i + j] = R[i] * Q[j] + R[3 + i] * Q[3 + j] + R[6 + i] * Q[6 + j];
    }
}

/* V of contact k, which began as contact j, or -1, by the motions of all bodies. */
static void mean_wrenches(const contact_problem *problem, placed *at, const body_motion *motions, int k, int j)
{
    const acting_begin *begin = problem->step->begin;
    const contact_arms *arms = at->arms + k;
    contact_acting *own = at->acting + k;
    double by_end = 0.0, by_begin = 0.0, turned = 0.0, gap = j < 0 ? 0.0 : begin->gaps[j], first[SLICE_ENDS][W];
    for (int a = 0; a < arms->count; a++) {
        const int b = arms->bodies[a];
        memcpy(first[a], arms->wrenches[a], sizeof first[a]);
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        double before[W];
        if (j < 0) {
            const int load = chain_load_of(problem->map, b);
            gap = begun_at_point(problem, at, k, begin->centres[load], begin->rotations[load], before);
        } else {
            memcpy(before, begin->wrenches[j][a], sizeof before);
        }
        /* W_0 in the frame of now: R_1^T R_0 f and m; then W . x */
        for (int i = 0; i < 3; i++) first[a][i] = objects_dot(motions[b].back + 3 * i, before);
        memcpy(first[a] + 3, before + 3, 3 * sizeof *before);
        turned = fmax(turned, motions[b].turned);
        for (int i = 0; i < W; i++) {
            by_end += arms->wrenches[a][i] * motions[b].moved[i];
            by_begin += first[a][i] * motions[b].moved[i];
        }
    }
    own->share = 0.5;
    if (!placed_slice_of(at, k) && fabs(by_end - by_begin) > STRAIGHT)
        own->share = fmax(0.0, fmin(1.0, (by_end - at->contacts.gaps[k] + gap) / (by_end - by_begin)));
    own->share *= fmax(0.0, fmin(1.0, 2.0 - turned / TURN));
    for (int a = 0; a < arms->count; a++) {
        memcpy(own->begun[a], first[a], sizeof own->begun[a]);
        for (int i = 0; i < W; i++) own->wrenches[a][i] += own->share * (first[a][i] - own->wrenches[a][i]);
    }
}

void acting_over_step(const contact_problem *problem, int first, contact_state *state)
{
    placed *at = &state->at;
    const double m = problem->step->mean_force;
    body_motion motions[MOST_BODIES];
    int last = -1;
    if (first) begin_with(problem, state, problem->step->begin);
    if (at->contacts.count) motions_of(problem, at, motions);
    memset(state->standing, 0, (size_t)contact_size(problem) * sizeof *state->standing);
    for (int k = 0; k < at->contacts.count; k++) {
        const int j = begun_as(problem, &at->contacts, k, last + 1), rubber = placed_slice_of(at, k) != NULL;
        contact_acting *own = at->acting + k;
        last = j < 0 ? last : j;
        if (j < 0 && rubber) continue; /* new, or it jumped: as at the end */
        mean_wrenches(problem, at, motions, k, j);
        if (!rubber) continue;
        /* (1 - m) f + m min(f_0, 2 f), by the last f */
        const double before = problem->step->begin->forces[j];
        own->slope = before > 2.0 * state->forces[k] ? 1.0 + m : 1.0 - m;
        own->fixed = before > 2.0 * state->forces[k] ? 0.0 : m * before;
        response_press(at, k, own->fixed, state->standing);
    }
}

void acting_change(const placed *at, int k, double (*change)[SLICE_INPUTS])
{
    const contact_acting *own = at->acting + k;
    const int count = at->arms[k].count;
    if (own->share == 0.0) return;
    for (int i = 0; i < W * count; i++)
        for (int j = 0; j < W * count; j++) change[i][j] *= 1.0 - own->share;
    /* the begin's forces are fixed in space: s f x theta */
    for (int a = 0; a < count; a++)
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            change[W * a + i][W * a + 3 + l] += own->share * own->begun[a][j];
            change[W * a + i][W * a + 3 + j] -= own->share * own->begun[a][l];
        }
}

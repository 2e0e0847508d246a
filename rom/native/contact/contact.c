/* What an object and plates do to each other: complementarity of gaps and forces, linearised about the last poses.
 *
 * The plates move by xi = C dw with their wrenches w, C the compliance. Contact forces f >= 0 make the wrenches W f, and as
 * the plates move these change by G xi besides, for the normals turn in their frames. So, from w,
 *
 *     dw = S (W f - w),    S = (1 - G C)^-1,    gaps + W^T C dw >= 0,  with f or the gap zero at every contact.
 *
 * The next pose is where this leads; near the end it is Newton's method.
 */
#include <math.h>
#include <stdlib.h>
#include "contact.h"
#include "response.h"

#define ITERATIONS 40
#define PATIENT 8    /* iterations until steps are cut, as contacts come and go in turns: by half after a step */
#define SHORTER 0.8  /* that was not so much shorter than the last [-]; after others they double again, */
#define SHORTEST 0.1 /* at least this share [-] */
#define STEPS 4      /* of an object that is brought to where it is, at first */
#define HALVINGS 10  /* of such a step until there is no answer */
#define EVALUATIONS 500 /* most of the map for one answer */
#define FEWER 120       /* where rubber is near: it takes longer, and what is not found soon cuts the clamp */
#define BEYOND 4.0      /* of the trained wrenches, from which on rubber's answers are not looked for [-] */
#define CLOSE 1e-7   /* of the box: a last step of the wrench, a small part of which is left [-] */
#define NEAR 2e-6    /* likewise, if steps become shorter by FASTER at least: the next would be some 1e-12, and derivatives,
                        which are those of the last pose, are good to 1e-4 or so */
#define FASTER 1e-2
#define CLOSER 3e-9  /* where rubber may touch, for its shape under a load is not in the tangent: a tenth of a step may be left [-] */
#define LONGEST 0.5  /* of the box: a step of the wrench [-] */

/* Forces that the contacts had before, found again by their names. */
static void carry(const objects_contacts *before, const double *forces, const objects_contacts *now, double *found)
{
    for (int k = 0; k < now->count; k++) {
        found[k] = 0.0;
        for (int j = 0; j < before->count; j++)
            if (before->names[j] == now->names[k] && before->plates[j] == now->plates[k] && before->objects[j] == now->objects[k])
                found[k] = forces[j];
    }
}

static int any(int count, const double *values)
{
    int found = 0;
    for (int k = 0; k < count; k++) found |= values[k] != 0.0;
    return found;
}

/* One Newton step, shortened to the fraction `most`; returns the largest change of a transmitted wrench over its box, negative on failure. */
static double step(const contact_problem *problem, double most, contact_state *state)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const objects_contacts *contacts = &state->at.contacts;
    const int w = contact_size(problem);
    double forces[FINGERFEM_MOST_CONTACTS], target[CHAIN_WRENCH], change[CHAIN_WRENCH], size = 0.0;
    if (!response_find(problem, state)) return -1.0;
    memcpy(forces, state->forces, sizeof forces);
    if (!response_balance(problem, state, forces)) return -1.0;
    if (any(w, state->wrench) && !any(contacts->count, state->forces)) { /* a known wrench, of forces that are not: so is G */
        memcpy(state->forces, forces, sizeof forces);
        if (!response_find(problem, state) || !response_balance(problem, state, forces)) return -1.0;
    }
    for (int i = 0; i < w; i++) target[i] = -state->wrench[i];
    for (int k = 0; k < contacts->count; k++)
        if (forces[k] > 0.0) response_press(&state->at, k, forces[k], target);
    response_product(w, state->soft, target, change);
    for (int i = 0; i < w; i++) {
        const int q = problem->map->bodies[i / W].segment;
        const fingerfem_segment *segment = chain->segments[q < 0 ? 0 : q];
        const double own = fabs(change[i]) / segment->upper[segment->tensions + i % W];
        if (own > size || isnan(own)) size = own;
    }
    if (isnan(size)) return -1.0;
    const double share = size > LONGEST ? most * LONGEST / size : most;
    for (int i = 0; i < w; i++) state->wrench[i] += share * change[i];
    for (int k = 0; k < contacts->count; k++) state->forces[k] += share * (forces[k] - state->forces[k]);
    for (int k = 0; k < problem->map->count; k++) { /* where the next pose would be found */
        chain_body *plate = state->at.chain.bodies + k;
        for (int j = 0; j < 3; j++) {
            double moved = 0.0;
            for (int i = 0; i < w; i++) moved += share * plate->motion[j][i] * change[i];
            for (int i = 0; i < 3; i++) plate->centre[i] += plate->rotation[3 * i + j] * moved;
        }
    }
    return size;
}

/* Solve from a state's wrench and forces; returns the number of evaluations, negative if it did not end. Contacts of rubber
 * that does not press change nothing: unless it pressed before, it takes part from where the plates' answer lies in it. */
static int solve_from(const contact_problem *problem, double d, contact_state *state)
{
    objects_contacts before = state->at.contacts;
    int rubber = problem->map->count > problem->touching->chain->plates;
    double last = INFINITY, share = 1.0;
    for (int k = 1; k <= ITERATIONS; k++) {
        double forces[FINGERFEM_MOST_CONTACTS];
        memcpy(forces, state->forces, sizeof forces);
        if (!placed_under(problem, d, rubber, state)) return -k;
        carry(&before, forces, &state->at.contacts, state->forces);
        const double size = step(problem, share, state);
        if (size < 0.0) return -k;
        if (size < (state->at.slices ? CLOSER : CLOSE) || (!state->at.slices && size < NEAR && size < FASTER * last)) {
            if (rubber || !placed_in_rubber(problem, d, &state->at)) return k;
            rubber = 1;
        }
        if (k >= PATIENT) share = size > SHORTER * last ? fmax(SHORTEST, 0.5 * share) : fmin(1.0, 2.0 * share);
        last = size;
        before = state->at.contacts;
    }
    return -ITERATIONS;
}

/* Whether the load of a body is far beyond the trained ones. */
static int far_beyond(const contact_problem *problem, const contact_state *state)
{
    int found = 0;
    for (int i = 0; i < contact_size(problem); i++) {
        const int q = problem->map->bodies[i / W].segment;
        const fingerfem_segment *segment = problem->touching->chain->segments[q < 0 ? 0 : q];
        found |= fabs(state->wrench[i]) > BEYOND * segment->upper[segment->tensions + i % W];
    }
    return found;
}

/* Bring the object from where it touches the free plate to d, so that of several answers the one is found that its
 * approach leads to; returns as `solve_from`. */
static int approach(const contact_problem *problem, double touch, double d, contact_state *state)
{
    int evaluations = 0;
    double at = touch, size = (d - touch) / STEPS;
    const double least = fabs(size) / (1 << HALVINGS);
    chain_rods *map = problem->map;
    chain_place bodies[MOST_BODIES];
    objects_contacts contacts;
    double wrench[CHAIN_WRENCH], forces[FINGERFEM_MOST_CONTACTS];
    memset(state->wrench, 0, sizeof state->wrench);
    state->at.contacts.count = 0;
    chain_plates_alone(map);
    while (at > d) {
        const int count = map->count;
        contacts = state->at.contacts;
        memcpy(wrench, state->wrench, sizeof wrench);
        memcpy(forces, state->forces, sizeof forces);
        memcpy(bodies, map->bodies, sizeof bodies);
        const double next = at + size > d + least ? at + size : d;
        const int used = solve_from(problem, next, state);
        evaluations += abs(used);
        if (used > 0) {
            at = next;
            size *= 1.5;
            if (state->at.slices && far_beyond(problem, state)) return -evaluations;
            continue;
        }
        state->at.contacts = contacts;
        memcpy(state->wrench, wrench, sizeof wrench);
        memcpy(state->forces, forces, sizeof forces);
        map->count = count;
        memcpy(map->bodies, bodies, sizeof bodies);
        size /= 2.0;
        if (fabs(size) < least || evaluations > (state->at.slices ? FEWER : EVALUATIONS)) return -evaluations;
    }
    return evaluations;
}

/* Solve at d: from a wrench that is known; or at once, where that is near enough; or from where the object touches. */
int contact_solve(const contact_problem *problem, double touch, double d, contact_state *state)
{
    double shallow = INFINITY;
    int evaluations = 0;
    for (int j = 0; j < problem->touching->count; j++)
        shallow = fmin(shallow, objects_shallow(contact_object(problem, j), problem->touching->chain->segments[0]->half_lengths));
    if (any(contact_size(problem), state->wrench) || touch - d < shallow) {
        state->at.contacts.count = 0;
        evaluations = solve_from(problem, d, state);
        if (evaluations > 0) return evaluations;
    }
    const int more = approach(problem, touch, d, state);
    return more > 0 ? abs(evaluations) + more : evaluations - abs(more);
}

/* The solution for contact without friction: complementarity of gaps and forces, linearised about the last pose.
 *
 * Bodies move by xi = C dw as their wrenches w change, with the compliance C. Contact forces f >= 0 make the
 * wrenches W f, which change by G xi as the bodies move, because the normals turn in their frames. A step from w solves
 *
 *     dw = S (W f - w),   S = (1 - G C)^-1,   gaps + W^T C dw + c f >= 0,   with f or this gap zero at every contact,
 *
 * where c is the local compliance. The next pose is that under w + dw. Near the solution this is Newton's method.
 */
#include <math.h>
#include <stdlib.h>
#include "acting.h"
#include "inertia.h"
#include "response.h"

/* steps of the wrench are measured by the trained box */
#define ITERATIONS 40   /* most steps of one solve */
#define PATIENT 8       /* iterations before damping, which is for contacts that open and close in turns */
#define SHORTER 0.8     /* a step longer than this times the last one halves the damping factor, others double it [-] */
#define SHORTEST 0.1    /* least damping factor [-] */
#define STEPS 4         /* steps of an object's approach, at first */
#define MOST_STEPS 64   /* of an approach without failures: an object much smaller than its depth gets longer steps */
#define HALVINGS 10     /* least step of an approach: the first one halved so often */
#define EVALUATIONS 500 /* most evaluations of the map for one answer */
#define FEWER 120       /* the same near rubber, where each takes longer; what is not found by then cuts the clamp */
#define BEYOND 4.0      /* loads over the trained ones at which an approach near rubber is given up [-] */
#define CLOSE 1e-7      /* converged: a step below this, of which a small part is left as error [-] */
#define NEAR 2e-6       /* converged too, if the step is below FASTER times the last: the next would be about 1e-12, and
                           derivatives, which are those of the last pose, are good to about 1e-4 [-] */
#define FASTER 1e-2
#define CLOSER 3e-9     /* converged near rubber: its shape is not in the tangent, so a tenth of a step may be left */
#define LONGEST 0.5     /* longest step [-] */
#define MOVING 1e-6     /* converged in a step of time: of the trained loads, what the next step would be by quadratic convergence, after one */
#define LINEAR 2        /* least number of Newton steps near rubber, where convergence is linear: the work of the residual after one step
                           added some percent of energy to a vibration in a second */
#define KEPT 0.1        /* in a step of time near rubber, a Newton step below which motions, G and S are kept: convergence is linear anyway [-] */
#define LEFT 1e-7       /* converged then: what the next step would be by linear convergence */
#define TURNS 1e-5      /* likewise after PATIENT steps, where contacts of one edge press in turns [-] */
#define SMALL 3e-4      /* below this, of which contact that slows the convergence leaves some 1e-3 [-] */

static int any(int count, const double *values)
{
    int found = 0;
    for (int k = 0; k < count; k++) found |= values[k] != 0.0;
    return found;
}

/* One Newton step, damped by the factor `most`; G and S may be `kept` from an earlier pose. Returns its size before damping, the largest
 * change of a wrench over its box, or -1 on failure. */
static double step(const contact_problem *problem, double most, int kept, contact_state *state)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const objects_contacts *contacts = &state->at.contacts;
    const int w = contact_size(problem);
    double forces[FINGERFEM_MOST_CONTACTS], target[CHAIN_WRENCH], change[CHAIN_WRENCH], size = 0.0;
    /* the wrenches that contact must transmit, w - I, with the inertial wrenches I */
    memcpy(state->pressed, state->wrench, (size_t)w * sizeof *state->wrench);
    if (problem->step) inertia_mass(problem, &state->at.chain, state->mass);
    if (problem->step) inertia_wrenches(problem, &state->at.chain, state->mass, state->inertial);
    for (int i = 0; i < w && problem->step; i++) state->pressed[i] -= state->inertial[i] + problem->share * state->standing[i];
    /* G and S by the last forces, unless they are kept; then the forces of the linear complementarity problem */
    if (!kept && !response_find(problem, state)) return -1.0;
    memcpy(forces, state->forces, sizeof forces);
    if (!response_balance(problem, state, forces)) return -1.0;
    /* a wrench was given, but no forces: find G by the forces just found, and solve again */
    if (any(w, state->wrench) && any(contacts->count, forces) && !any(contacts->count, state->forces)) {
        memcpy(state->forces, forces, sizeof forces);
        if (!response_find(problem, state) || !response_balance(problem, state, forces)) return -1.0;
    }
    /* dw = S (W f - (w - I)) */
    for (int i = 0; i < w; i++) target[i] = -state->pressed[i];
    for (int k = 0; k < contacts->count; k++)
        if (forces[k] > 0.0) response_press(&state->at, k, problem->share * state->at.acting[k].slope * forces[k], target);
    response_soften(problem, state, target, change);
    /* size of the step, max_i |dw_i| / upper_i [-] */
    for (int i = 0; i < w; i++) {
        const int q = problem->map->bodies[i / W].segment;
        const fingerfem_segment *segment = chain->segments[q < 0 ? 0 : q];
        const double own = fabs(change[i]) / segment->upper[segment->tensions + i % W];
        if (own > size || isnan(own)) size = own;
    }
    if (isnan(size)) return -1.0;
    /* w += share dw, f += share (f_new - f), with a share that limits the step to LONGEST */
    const double share = size > LONGEST ? most * LONGEST / size : most;
    for (int i = 0; i < w; i++) state->wrench[i] += share * change[i];
    for (int k = 0; k < contacts->count; k++) state->forces[k] += share * (forces[k] - state->forces[k]);
    /* centres predicted for the next pose, c += R (C share dw); in a step of time, rotations too: it may end there */
    for (int k = 0; k < problem->map->count; k++) {
        chain_body *plate = state->at.chain.bodies + k;
        double moved[W];
        for (int j = 0; j < W; j++) {
            moved[j] = 0.0;
            for (int i = 0; i < w; i++) moved[j] += share * plate->motion[j][i] * change[i];
        }
        for (int i = 0; i < 3; i++) plate->centre[i] += objects_dot(plate->rotation + 3 * i, moved);
        if (problem->step) inertia_turn(moved + 3, plate->rotation);
    }
    return size;
}

/* Whether step k of this size, after one of the size `last`, is small enough. */
static int converged(const contact_problem *problem, const contact_state *state, int k, int kept, double size, double last)
{
    const int least = state->at.slices ? LINEAR : 1;
    if (problem->step && k > least && size < SMALL && (kept ? size * size < LEFT * last : size * size * size < MOVING * last * last)) return 1;
    if (problem->step && k > PATIENT && size < TURNS) return 1;
    return size < (state->at.slices ? CLOSER : CLOSE) || (!state->at.slices && size < NEAR && size < FASTER * last);
}

/* Newton's method from a state's wrenches and forces. Returns the number of evaluations, negative if it did not
 * converge. Contacts of rubber without force change nothing. So plates are solved for alone, unless rubber has loads
 * already, and rubber takes part once an object lies in it at the plates' solution. */
int contact_solve_from(const contact_problem *problem, double d, contact_state *state)
{
    int rubber = problem->step ? acting_on_rubber(problem->step->pressed) : problem->map->count > problem->touching->chain->plates;
    double last = INFINITY, share = 1.0;
    for (int k = 1; k <= ITERATIONS; k++) {
        /* bodies and contacts under the present wrenches, with the last forces as a start */
        const int kept = problem->step && last < KEPT && k < PATIENT && state->at.slices;
        fingerfem_pressed before;
        acting_leave(state, &before);
        if (!placed_under(problem, d, rubber, kept, state)) return -k;
        for (int c = 0; c < state->at.contacts.count; c++) state->forces[c] = acting_pressed(&before, &state->at.contacts, c);
        if (problem->step) acting_over_step(problem, k == 1, state);
        const double size = step(problem, share, kept, state);
        if (size < 0.0) return -k;
        /* stop: the step is small, and no object lies in rubber that was left out */
        if (converged(problem, state, k, kept, size, last)) {
            if (rubber || !placed_in_rubber(problem, d, &state->at)) return k;
            rubber = 1;
        }
        /* damping: half the factor after a slow step, else twice */
        if (k >= PATIENT) share = size > SHORTER * last ? fmax(SHORTEST, 0.5 * share) : fmin(1.0, 2.0 * share);
        last = size;
    }
    return -ITERATIONS;
}

/* Whether the load of a body exceeds BEYOND times the trained one. */
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

/* Continuation in d, from first touch of the free finger to d: of several equilibria this finds the one on the objects'
 * approach. No step is longer than `most` [m], so that a plate's corner does not leave an object by another of its sides.
 * Returns as `contact_solve_from`. */
static int approach(const contact_problem *problem, double touch, double d, double most, contact_state *state)
{
    int evaluations = 0;
    const double longest = fmax(most, (touch - d) / MOST_STEPS);
    double at = touch, size = fmax((d - touch) / STEPS, -longest);
    const double least = fabs(size) / (1 << HALVINGS);
    chain_rods *map = problem->map;
    chain_place bodies[MOST_BODIES];
    objects_contacts contacts;
    double wrench[CHAIN_WRENCH], forces[FINGERFEM_MOST_CONTACTS];
    /* begin: first touch, no loads, plates alone as bodies */
    memset(state->wrench, 0, sizeof state->wrench);
    state->at.contacts.count = 0;
    chain_plates_alone(map);
    while (at > d) {
        /* keep the last converged state */
        const int count = map->count;
        contacts = state->at.contacts;
        memcpy(wrench, state->wrench, sizeof wrench);
        memcpy(forces, state->forces, sizeof forces);
        memcpy(bodies, map->bodies, sizeof bodies);
        /* solve at the next distance; the last step ends at d */
        const double next = at + size > d + least ? at + size : d;
        const int used = contact_solve_from(problem, next, state);
        evaluations += abs(used);
        /* converged: a step 1.5 times as long is next; give up far beyond the trained loads */
        if (used > 0) {
            at = next;
            size = fmax(1.5 * size, -longest);
            if (state->at.slices && far_beyond(problem, state)) return -evaluations;
            continue;
        }
        /* failed: restore the last state and halve the step */
        state->at.contacts = contacts;
        memcpy(state->wrench, wrench, sizeof wrench);
        memcpy(state->forces, forces, sizeof forces);
        map->count = count;
        memcpy(map->bodies, bodies, sizeof bodies);
        size /= 2.0;
        /* stop: the step is too short, or there were too many evaluations */
        if (fabs(size) < least || evaluations > (state->at.slices ? FEWER : EVALUATIONS)) return -evaluations;
    }
    return evaluations;
}

/* Solve at d directly, from given wrenches or at a small depth; else, or on failure, approach from first touch. */
int contact_solve(const contact_problem *problem, double touch, double d, contact_state *state)
{
    double shallow = INFINITY;
    int evaluations = 0;
    /* depth in a free plate up to which the sides of all objects are distinguished [m] */
    for (int j = 0; j < problem->touching->count; j++)
        shallow = fmin(shallow, objects_shallow(contact_object(problem, j), problem->touching->chain->segments[0]->half_lengths));
    /* directly, from given wrenches or at such a depth */
    if (any(contact_size(problem), state->wrench) || touch - d < shallow) {
        state->at.contacts.count = 0;
        evaluations = contact_solve_from(problem, d, state);
        if (evaluations > 0) return evaluations;
    }
    /* by an approach; evaluations of a direct failure count too */
    const int more = approach(problem, touch, d, shallow, state);
    return more > 0 ? abs(evaluations) + more : evaluations - abs(more);
}

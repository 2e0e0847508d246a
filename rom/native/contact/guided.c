/* An increment of a chain whose tendons rub in their guides. Without a wrench the elements' shortenings depend on their own tensions
 * alone, and Newton's method on the tensions suffices (rod/guides.c). Else every step is taken at the wrenches of the contact that the
 * last tensions lead to: these follow in turn, until both stay. */
#include "contact.h"
#include "../rod/guides.h"

enum { POINT = TENSIONS_MOST + FINGERFEM_MOST_OBJECTS };

#define STEPS 40        /* most steps of an increment */
#define SETTLED 1e-10   /* converged: largest change of a tension over its box [-] */

/* Whether nothing is transmitted: no loads, and no weight. */
static int unloaded(const fingerfem_chain *chain, const double *loads)
{
    const double *g = chain->gravity;
    for (int i = 0; i < fingerfem_chain_loads(chain); i++)
        if (loads[i] != 0.0) return 0;
    return !chain->masses || (g[0] == 0.0 && g[1] == 0.0 && g[2] == 0.0);
}

/* Without a wrench; returns the number of steps, negative if they do not converge. */
static int without_wrench(guides_state *state)
{
    for (int k = 1; k <= STEPS; k++) {
        guides_without_wrench(state);
        const double change = guides_step(state);
        if (change < 0.0) return -k;
        if (change < SETTLED) return k;
    }
    return -STEPS;
}

/* The equilibrium at the present tensions; returns 0 without one. */
static int equilibrium(const fingerfem_touching *touching, const double *distances, double *memory, double *loads, guides_state *state)
{
    const int t = touching->chain->tensions;
    double point[POINT], out[FINGERFEM_MOST_ROWS_TOUCHED], jacobian[FINGERFEM_MOST_ROWS_TOUCHED * POINT];
    int32_t inside;
    guides_by_own(state);
    memcpy(point, state->motors, (size_t)t * sizeof *point);
    memcpy(point + t, distances, (size_t)touching->count * sizeof *point);
    return !touching->count || fingerfem_touch(touching, point, memory, loads, out, jacobian, NULL, &inside) > 0;
}

/* State of the elements in that equilibrium. */
static void elements_under(const fingerfem_chain *chain, const double *loads, double *memory, guides_state *state)
{
    double held_tensions[TENSIONS_MOST];
    chain_rods map;
    chain_state placed;
    chain_placed(chain, state->motors, loads, memory, held_tensions, &map, &placed);
    guides_under(&map, state);
}

/* Under wrenches, likewise. */
static int under_wrench(const fingerfem_touching *touching, const double *distances, double *memory, double *loads, guides_state *state)
{
    for (int k = 1; k <= STEPS; k++) {
        if (!equilibrium(touching, distances, memory, loads, state)) return -k;
        elements_under(touching->chain, loads, memory, state);
        const double change = guides_step(state);
        if (change < 0.0) return -k;
        if (change < SETTLED) return k;
    }
    return -STEPS;
}

int fingerfem_guides_advance(const fingerfem_touching *touching, const double *point, const int32_t *wound, double *memory, double *loads,
                             double *motors, double *work, int32_t *inside)
{
    const fingerfem_chain *chain = touching->chain;
    const guides_goal goal = {point, wound};
    guides_state state;
    int steps = 0, free = unloaded(chain, loads);
    for (int k = 0; k < chain->plates; k++)
        if (!chain->segments[k]->sixes) return 0;
    guides_begin(chain, &goal, motors, guides_memory_in(chain, memory), &state);
    guides_predict(&state);
    /* of the free finger, and whether an object presses it there */
    if (free) {
        steps = without_wrench(&state);
        if (steps > 0 && touching->count && !equilibrium(touching, point + chain->tensions, memory, loads, &state)) return -steps;
        free = unloaded(chain, loads);
    }
    if (!free) steps = under_wrench(touching, point + chain->tensions, memory, loads, &state);
    if (steps > 0) guides_end(&state, work);
    *inside = !state.beyond;
    for (int j = 0; j < chain->tensions; j++) *inside &= wound[j] || motors[j] == point[j];
    return steps;
}

/* Friction of tendons in their guides: the tensions of all elements at the end of an increment, see guides.c. */
#ifndef FINGERFEM_GUIDES_H
#define FINGERFEM_GUIDES_H
#include "chain.h"

/* Whether a tendon moves through its guide: not at all, towards the motor, or away from it; or it is slack, and has the least tension. */
typedef enum { GUIDES_STICKS, GUIDES_PULLED, GUIDES_LET_OUT, GUIDES_SLACK } guides_move;

/* An element: how much shorter its tendons are [m], and the derivatives by the tensions in it at fixed wrench; by how much it is bent
 * [rad], likewise; where its tendons have moved at its end towards the clamp [m]; and changes of its tensions by those of the next one
 * towards the motor, d = offset + gain d'. */
typedef struct {
    int segment, element, number; /* the latter counts all elements, see fingerfem_guides */
    double shortening[TENSIONS_MOST], by_tensions[TENSIONS_MOST][TENSIONS_MOST], bend, bend_by[TENSIONS_MOST];
    double slips[TENSIONS_MOST], offset[TENSIONS_MOST], gain[TENSIONS_MOST][TENSIONS_MOST], last[TENSIONS_MOST];
    guides_move moves[TENSIONS_MOST];
} guides_element;

/* What is to be reached: tensions at the motors [N], or, of those tendons that are `wound`, shortenings [m]. */
typedef struct {
    const double *wanted;
    const int32_t *wound;
} guides_goal;

/* Elements from the tip to the clamp, and the tensions at the motors, which the last element follows. */
typedef struct {
    const fingerfem_chain *chain;
    int count, beyond; /* and whether a tension ended at the upper end of its box */
    guides_element *elements;
    double *monomials, *motors, before[TENSIONS_MOST]; /* the latter at the end of the last increment */
    guides_goal goal;
} guides_state;

/* Tensions of an element, or behind the last one those at the motors; and a tension within its box. */
static inline double *guides_tensions(const guides_state *state, int k)
{
    const fingerfem_chain *chain = state->chain;
    return k < state->count ? chain->guides->tensions + chain->tensions * state->elements[k].number : state->motors;
}

static inline double guides_held(const guides_state *state, int j, double tension)
{
    return tensions_clamped(state->chain->lower[j], state->chain->upper[j], tension);
}

/* Numbers of memory for the elements of a chain, the last ones of fingerfem_chain_memory. */
int guides_memory(const fingerfem_chain *chain);
static inline double *guides_memory_in(const fingerfem_chain *chain, double *memory)
{
    return memory + fingerfem_chain_memory(chain) - guides_memory(chain);
}

/* The elements at the end of the last increment, with the tensions at the motors, (tensions), then; those that are given are set. */
void guides_begin(const fingerfem_chain *chain, const guides_goal *goal, double *motors, double *memory, guides_state *found);

/* From the motors to the tip, move tensions just into the bounds that those of the next element set. */
void guides_predict(guides_state *state);

/* Shortenings and bending without a wrench; or of contracted rods under the wrenches that they were placed under last, of which the
 * derivatives are by the tensions in each element itself. */
void guides_without_wrench(guides_state *state);
void guides_under(const chain_rods *map, guides_state *state);

/* Leave the slips and bending of contracted rods under the wrenches that they were placed under last, in memory of a chain. */
void guides_leave(const chain_rods *map, double *memory);

/* One step of Newton's method, with the moves at the present tensions: where it changes nothing, these obey the law. Returns the largest
 * change of a tension over the width of its box; negative if the step is singular. */
double guides_step(guides_state *state);

/* Derivatives of all tensions by those at the motors as if a tendon had one tension, for `guides_under`. */
void guides_by_own(const guides_state *state);

/* Leave slips, bending and derivatives by the tensions at the motors; returns work of the motors and what friction took, (2) [J]. */
void guides_end(guides_state *state, double *work);
#endif

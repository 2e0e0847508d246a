/* How contact forces act over a step of time, see acting.c. */
#ifndef FINGERFEM_ACTING_H
#define FINGERFEM_ACTING_H
#include "contact.h"

/* Force k acts as at rest: by the wrenches by which its gap opens. */
void acting_at_end(placed *at, int k);

/* How all forces act in a step of time. The first pose of the solve, under the wrenches of the last step, is that of the step's begin: the solve
 * starts with the forces there. */
void acting_over_step(const contact_problem *problem, int first, contact_state *state);

/* The mean of force k over the step [N]. */
static inline double acting_force(const contact_state *state, int k)
{
    return state->at.acting[k].slope * state->forces[k] + state->at.acting[k].fixed;
}

/* How its wrenches change with the motions of the bodies, in place of how those at the end do, (2, 6), (2, 6). */
void acting_change(const placed *at, int k, double (*change)[SLICE_INPUTS]);

/* What presses, as the next step begins; the force of contact k then, or 0 [N]; and whether that is rubber. */
void acting_leave(const contact_state *state, fingerfem_pressed *pressed);
double acting_pressed(const fingerfem_pressed *pressed, const objects_contacts *contacts, int k);
int acting_on_rubber(const fingerfem_pressed *pressed);
#endif

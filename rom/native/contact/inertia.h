/* Inertia of the bodies in a step of time: what is added to the balance of contact_solve.c, see inertia.c. */
#ifndef FINGERFEM_INERTIA_H
#define FINGERFEM_INERTIA_H
#include "contact.h"

/* Numbers of the method for a spectral radius at infinite frequency, 0 to 1 (Chung and Hulbert 1993). */
void inertia_method(double radius, contact_step *step);

/* Inertial wrenches on all bodies where they are, (6 bodies) [N, N m]; and the same of one, with how it moves at the step's end. */
void inertia_wrenches(const contact_problem *problem, const chain_state *state, double *found);
void inertia_moving(const contact_step *step, const double *begun, const chain_body *body, double *moving);

/* From a wrench on a body, (6), to the change r / M of its acceleration, in place and in its frame; returns 0 if it has no mass. */
int inertia_accelerate(const fingerfem_inertia *inertia, int load, double *wrench);

/* From the motion that `inertia_moving` takes for one by inertia alone, take what contact gave, r / M, (6). */
void inertia_leave_contact(const contact_step *step, const double *change, double *moving);

/* Add a change of velocity, (6), in the body's frame; and the velocity along a unit force's wrench, (6). */
void inertia_add_velocity(const double *change, double *moving);
double inertia_velocity_along(const double *wrench, const double *moving);

/* Add the change of these wrenches with the motions of the bodies, (6 bodies, 6 bodies). */
void inertia_follow(const contact_problem *problem, const chain_state *state, chain_matrix following);
#endif

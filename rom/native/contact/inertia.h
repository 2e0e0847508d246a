/* Inertia of the bodies in a step of time: what is added to the balance of contact_solve.c, see inertia.c. */
#ifndef FINGERFEM_INERTIA_H
#define FINGERFEM_INERTIA_H
#include "contact.h"

/* Numbers of the method for a spectral radius at infinite frequency, 0 to 1 (Chung and Hulbert 1993). */
void inertia_method(double radius, contact_step *step);

/* Motion of a body at the step's end, (FINGERFEM_MOVING), from its pose there, as if no contact acted. */
void inertia_moving(const contact_step *step, const double *begun, const chain_body *body, double *moving);

/* The same of a body at rest, with the wrench of elements on it and the acceleration by that alone, both (6) in its frame. */
void inertia_at_rest(const chain_body *body, const double *wrench, const double *acceleration, double *moving);

/* The rotation vector of R_0^T R, (3) [rad]: less than half a turn. */
void inertia_turn_between(const double *from, const double *to, double *found);

/* A rotation after a small turn in its own frame, (3) [rad], in place: R exp(turn). */
void inertia_turn(const double *turn, double *rotation);

/* From the frame of a body to that between it and the one before, which is the clamp if NULL: by half the turn, (3, 3). */
void inertia_middle(const chain_body *before, const chain_body *body, double *found);

/* The mass matrix by the motions of all bodies, each in its own frame, (6 bodies, 6 bodies); of the ground 1. */
void inertia_mass(const contact_problem *problem, const chain_state *state, chain_matrix mass);

/* Kinetic energy of all bodies [J], which move so, (bodies, FINGERFEM_MOVING). */
double inertia_energy(const contact_problem *problem, const double *moving, const chain_matrix mass);

/* Inertial wrenches on all bodies at their poses, (6 bodies) [N, N m]; the second function adds their derivative by the bodies'
 * motions, (6 bodies, 6 bodies), to a matrix, from these wrenches. */
void inertia_wrenches(const contact_problem *problem, const chain_state *state, const chain_matrix mass, double *found);
void inertia_follow(const contact_problem *problem, const chain_matrix mass, const double *wrench, chain_matrix following);

/* What elements put on all bodies at the step's end, M v' without contact's wrenches, in place of `inertia_moving`'s means. The bodies of
 * `begun` must be there still. */
void inertia_forces(const contact_problem *problem, const chain_state *state, const chain_matrix mass, const double *contact, double *moving);

/* Subtract the acceleration by contact, r / M, (6) in the body's frame, from a motion of `inertia_moving`. */
void inertia_subtract_contact(const contact_step *step, const double *change, double *moving);

/* Add a change of velocity, (6), in the body's frame; and the velocity along a unit force's wrench, (6). */
void inertia_add_velocity(const double *change, double *moving);
double inertia_velocity_along(const double *wrench, const double *moving);
#endif

/* Plates somewhere, and what an object and they do to each other: what the parts of the contact solve share. */
#ifndef FINGERFEM_CONTACT_H
#define FINGERFEM_CONTACT_H
#include "chain.h"
#include "objects.h"

#define SOFT 1e-9 /* what a contact yields, for forces that are shared by a stiff plate to be unique [m/N] */

/* Plates somewhere, and the contacts there. */
typedef struct {
    chain_state chain;
    objects_contacts contacts;
} placed;

/* A state of the solve: where the plates are, the wrenches on all of them and the forces at their contacts, and G, S and
 * C S. */
typedef struct {
    placed at;
    double wrench[CHAIN_WRENCH], forces[FINGERFEM_MOST_CONTACTS];
    chain_matrix following, soft, yielding;
} contact_state;

/* What the solve is about. */
typedef struct {
    const fingerfem_touching *touching;
    const chain_rods *map;
    int size; /* of all wrenches */
} contact_problem;

/* The plates under wrenches, before an object at d. */
void placed_under(const contact_problem *problem, const double *wrench, double d, placed *at);

/* The direction in which d moves the object, (3), seen from a plate. */
void placed_leaving(const contact_problem *problem, const chain_plate *plate, double *found);

/* How the point of contact k moves as the tensions bend its plate, (tensions, 3). */
void placed_bend(const contact_problem *problem, const objects_contacts *contacts, int k, double *found);

/* The contact with the least gap. */
int placed_nearest(const objects_contacts *contacts);

/* The largest d at which the object touches one of the plates where they are, of which the contacts are left there;
 * -infinity if it passes by. */
double placed_touch_distance(const contact_problem *problem, placed *at);

/* Solve at d: from wrenches that are known, if they are not zero; or at once, where d is near the touch distance; or from
 * where the object touches. Returns the number of evaluations of the map, negative without an answer. */
int contact_solve(const contact_problem *problem, double touch, double d, contact_state *state);
#endif

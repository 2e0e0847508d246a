/* A plate somewhere, and what an object and it do to each other: what the parts of the contact solve share. */
#ifndef FINGERFEM_CONTACT_H
#define FINGERFEM_CONTACT_H
#include "map.h"
#include "objects.h"

#define SOFT 1e-9 /* what a contact yields, for forces that are shared by a stiff plate to be unique [m/N] */

enum { W = FINGERFEM_WRENCH };
typedef double matrix[W][W];

/* A plate somewhere: its pose, what it does by the wrench and by the tensions, and the contacts there. */
typedef struct {
    double pose[FINGERFEM_POSE], centre[3], rotation[9];
    matrix compliance; /* C: motion by the wrench */
    double by_tensions[W][MAP_MOST_TENSIONS];
    objects_contacts contacts;
} placed;

/* What was contracted for some tensions. */
typedef struct {
    const fingerfem_touching *touching;
    const double *contracted;
    double *products;
} contracted_map;

/* A state of the solve: where the plate is, the wrench and the forces at its contacts, and G, S and C S. */
typedef struct {
    placed at;
    double wrench[W], forces[FINGERFEM_MOST_CONTACTS];
    matrix following, soft, yielding;
} contact_state;

/* The plate under a wrench, before an object at d. */
void placed_under(const contracted_map *map, const double *wrench, double d, placed *at);

/* The plate without a wrench: where it is, and its motion by the tensions. */
void placed_free(const contracted_map *map, placed *at);

/* The plate's motion by the tensions, at the wrench that it was placed under last. */
void placed_by_tensions(const contracted_map *map, placed *at);

/* The direction in which d moves the object, (3), seen from the plate. */
void placed_leaving(const contracted_map *map, const placed *at, double *found);

/* The contact with the least gap. */
int placed_nearest(const objects_contacts *contacts);

/* The largest d at which the object touches the plate where it is; -infinity if it passes by. */
double placed_touch_distance(const contracted_map *map, placed *at);

/* Solve at d: from a wrench that is known, if it is not zero; or at once, where d is near the touch distance; or from
 * where the object touches. Returns the number of evaluations of the map, negative without an answer. */
int contact_solve(const contracted_map *map, double touch, double d, contact_state *state);

/* How wrench and plate move with a tension, or with d: drift is the motion at a fixed wrench, of the plate or relative to
 * the object. Contacts that press stay closed. Returns 0 if nothing is known of it. */
int contact_follow(const contact_state *state, const double *drift, double *wrench_change);
/* Whether the plate rests there: the stiffness K = 1/C - G is positive along all motions that keep the pressing contacts
 * closed. With A = W^T 1/K W over these, that is so where K and A have as many negative eigenvalues (Haynsworth 1968). */
int contact_stable(const contact_state *state);
#endif

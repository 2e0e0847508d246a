/* Plates somewhere, and what an object and they do to each other: what the parts of the contact solve share. */
#ifndef FINGERFEM_CONTACT_H
#define FINGERFEM_CONTACT_H
#include <math.h>
#include "../rod/chain.h"
#include "../shapes/objects.h"

/* A slice of rubber between two cross-sections next to each other: the coefficients of its points in space, trilinear by their coordinates, of
 * which number k has the bits; how far the middles of its faces across y and across z are off,
 * by section, where a beam is bent; an orthogonal frame; and the sections where its element begins and ends, with the bodies that bear what presses
 * on it. */
enum { SLICE_ENDS = 2, SLICE_INPUTS = SLICE_ENDS * W, SLICE_TERMS = 8 };
typedef struct {
    int number, segment, element, bodies[SLICE_ENDS];
    double dome;                  /* curvature along it besides its own, over its thickness [-] */
    double share;                 /* of the middle, from the element's end, 0, to its begin, 1 */
    double length;                /* of the element at rest [m] */
    double modulus, root;         /* of its material over that of the segment's rubber, and its square root [-] */
    double slender;               /* 12 E I / (k G A length^2): how much its shear yields beside its bending [-] */
    double bulging;               /* Poisson's ratio over the length of the element [1/m] */
    double flexibility[2];        /* length^3 / (E I) for bending towards y and z [m/N] */
    const fingerfem_segment *of;  /* the segment */
    double ends[SLICE_ENDS][3];   /* centres of the sections, its begin, then its end, seen from the slice [m] */
    double arms[SLICE_ENDS][3];   /* the same from the centres of their bodies, see slices_hold [m] */
    double turns[SLICE_ENDS][9];  /* rotations of these bodies, seen from the slice */
    double shape[SLICE_TERMS][3], bulges[2][2]; /* [m] */
    double raised;                /* of the ridges far from plates and the clamp: what they have here [-] */
    double ridges[2][2];          /* how much farther out the middles of its faces are, across y and across z, each on both sides [m] */
    double centre[3], rotation[9], thickness;
} rubber_slice;

/* What a unit force at a contact puts on bodies: one plate, or both ends of a slice. */
typedef struct {
    int count, bodies[SLICE_ENDS];
    double wrenches[SLICE_ENDS][W];
} contact_arms;

/* What a force f at a contact puts on its bodies over a step of time, see acting.c: slope f + fixed, (slope, fixed) = (1, 0) at rest [-, N], by
 * wrenches that are means of those at both ends: a share of those at its begin, of which forces are `begun` [-]. */
typedef struct {
    double wrenches[SLICE_ENDS][W], begun[SLICE_ENDS][3], share, slope, fixed;
} contact_acting;

/* Bodies somewhere, and the contacts there. Slices lie after all plates in their numbers. */
typedef struct {
    chain_state chain;
    objects_contacts contacts;
    contact_arms arms[FINGERFEM_MOST_CONTACTS];
    contact_acting acting[FINGERFEM_MOST_CONTACTS];
    double d;                             /* of the objects, see contact_distance [m] */
    int slices;
    rubber_slice slice[FINGERFEM_MOST_CONTACTS + 1]; /* one whose contacts find no room */
} placed;

/* A state of the solve: where the bodies are, the wrenches on all of them and the forces at their contacts; G; and the
 * factors of 1 / S = 1 - G C, with the rows that they exchange. */
typedef struct {
    placed at;
    double wrench[CHAIN_WRENCH], forces[FINGERFEM_MOST_CONTACTS];
    double pressed[CHAIN_WRENCH]; /* wrenches minus the inertial ones: those that contact must transmit */
    chain_matrix following, factors;
    int exchanged[CHAIN_WRENCH];
    double standing[CHAIN_WRENCH]; /* of the fixed parts of all forces */
    chain_matrix mass; /* in a step of time, as are the inertial wrenches */
    double inertial[CHAIN_WRENCH];
} contact_state;

/* Where bodies and contacts are as a step begins, bodies by their loads; and what pressed there [N]. */
typedef struct {
    double centres[FINGERFEM_MOST_BODIES][3], rotations[FINGERFEM_MOST_BODIES][9];
    int count, names[FINGERFEM_MOST_CONTACTS], plates[FINGERFEM_MOST_CONTACTS], objects[FINGERFEM_MOST_CONTACTS];
    double points[FINGERFEM_MOST_CONTACTS][3], gaps[FINGERFEM_MOST_CONTACTS], forces[FINGERFEM_MOST_CONTACTS];
    double wrenches[FINGERFEM_MOST_CONTACTS][SLICE_ENDS][W];
} acting_begin;

/* A step of time from where bodies were, see inertia.c: its length [s], and the numbers of the generalised-alpha method [-]. */
typedef struct {
    const fingerfem_inertia *inertia;
    const double *begun; /* (bodies, FINGERFEM_MOVING), by loads */
    const double *turning; /* of the base in its own axes: angular velocity [rad/s] and its rate, (6); NULL if it does not turn */
    double length, mean_mass, mean_force, beta, gamma;
    double contact; /* the share of contact forces that the balance at the step's end sees [-] */
    const fingerfem_pressed *pressed; /* as it begins */
    acting_begin *begin;
} contact_step;

/* What the solve is about. All objects come together: where one is at d, object j is at d + ahead[j], and infinity says that it is
 * not there. */
typedef struct {
    const fingerfem_touching *touching;
    chain_rods *map;
    double ahead[FINGERFEM_MOST_OBJECTS]; /* [m] */
    const contact_step *step;             /* NULL at rest; else the bodies move, see inertia.h */
    double share;                         /* of contact forces that the balance sees: 1 at rest [-] */
} contact_problem;

static inline const fingerfem_object *contact_object(const contact_problem *problem, int j) { return problem->touching->objects[j]; }

static inline int contact_is_there(const contact_problem *problem, int j) { return isfinite(problem->ahead[j]); }

/* Set `ahead` by the d of all objects, (count), which come as the first one that is there; returns that one's d, 0 without one. */
static inline double contact_lead(contact_problem *problem, const double *distances)
{
    const int count = problem->touching->count;
    double d = 0.0;
    for (int j = count - 1; j >= 0; j--) d = isfinite(distances[j]) ? distances[j] : d;
    for (int j = 0; j < count; j++) problem->ahead[j] = isfinite(distances[j]) ? distances[j] - d : INFINITY;
    return d;
}

/* Numbers of all wrenches. */
static inline int contact_size(const contact_problem *problem) { return chain_size(problem->map); }

/* The bodies under a state's wrenches, before objects at d: what they may touch becomes a body, plates alone or `rubber`, too. Motions by
 * wrenches may be `kept` from an earlier pose of all bodies. Returns 0 if there is no room. */
int placed_under(const contact_problem *problem, double d, int rubber, int kept, contact_state *state);

/* Whether objects at d are in the rubber, of bodies that were placed without it. */
int placed_in_rubber(const contact_problem *problem, double d, placed *at);

/* Add the contacts of object j at d with one plate: a prism about an outline, or a box, corrected for its bending by tensions. */
void placed_plate(const contact_problem *problem, int j, double d, int plate, placed *at);

/* Slices of rubber with gaps below `near` [m] before object j at its own d, and their contacts besides others; free, or under the
 * wrenches that the bodies were placed under last. Slices are domed along the finger by so much over their thickness [-]. */
void placed_slices(const contact_problem *problem, int j, int free, double dome, double d, double near, placed *at);

/* The slice of a contact; NULL if it is a plate's. */
const rubber_slice *placed_slice_of(const placed *at, int contact);

/* The point of contact k in space, (3) [m], and the normal there, out of the object. */
void placed_point(const placed *at, int k, double *place, double *normal);

/* How the wrenches of a unit force at contact k of a slice change, each in its body's frame, as both ends move: (2, 6), (2, 6). The
 * force, (3), is along the normal, or, unless it is NULL, along another direction in space that turns with it. */
void slices_change(const contact_problem *problem, double d, const placed *at, int k, const double *force,
                   double (*change)[SLICE_INPUTS]);

/* The direction in which d moves object j, (3), seen from a body. */
void placed_leaving(const contact_problem *problem, int j, const chain_body *body, double *found);

/* How the point of contact k moves as the tensions bend its plate, or change the shape of its slice, (tensions, 3). */
void placed_bend(const contact_problem *problem, const placed *at, int k, double *found);

/* Whether contacts that may press are missing: there is no room for more, and all that there are lie in the object. */
int placed_crowded(const objects_contacts *contacts);

/* The contact with the least gap. */
int placed_nearest(const objects_contacts *contacts);

/* The largest d at which object j touches one of the free plates, of which the contacts are left there; -infinity if it
 * passes by. */
double placed_touch_distance(const contact_problem *problem, int j, placed *at);

/* Solve at d: from wrenches that are known, if they are not zero; or at once, where d is near the touch distance; or from
 * where the object touches. Returns the number of evaluations of the map, negative without an answer. */
int contact_solve(const contact_problem *problem, double touch, double d, contact_state *state);

/* The same from a state's wrenches and forces, which must be near. */
int contact_solve_from(const contact_problem *problem, double d, contact_state *state);
#endif

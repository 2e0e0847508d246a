/* A slice's element as a beam that passes forces on to its ends, see slice_forces.c. */
#ifndef FINGERFEM_SLICE_BEAM_H
#define FINGERFEM_SLICE_BEAM_H
#include "slice_points.h"

/* The weights N and u of both ends at a share, and their derivatives by it. */
typedef struct {
    double share, n[SLICE_ENDS], u[SLICE_ENDS], dn[SLICE_ENDS], du[SLICE_ENDS];
} slice_beam;

/* At the distance `along` from the slice's middle [m], towards the element's begin. */
slice_beam slice_beam_at(const rubber_slice *slice, double along);

/* The arms g of both ends for a force at a point x of space, (2, 3). */
void slice_beam_arms(const rubber_slice *slice, const chain_state *state, const slice_beam *at, const double *x, double (*g)[3]);

/* The couple, (3), that a force f at a point p puts on the distal end of its element, all seen from the slice. The
 * proximal end gets the opposite couple. */
void slice_couple(const rubber_slice *slice, int name, const double *p, const double *f, double *couple);

/* A force f at contact k of a slice, along the normal n unless it is given: the beam there, the point x, its arms and couple; in space, but for
 * the force `seen` from the slice. */
typedef struct {
    slice_beam here;
    double x[3], n[3], f[3], seen[3], couple[3], g[SLICE_ENDS][3];
} slice_pressed;
void slice_press(const rubber_slice *slice, const chain_state *state, const objects_contacts *contacts, int k, const double *force,
                 slice_pressed *found);
#endif

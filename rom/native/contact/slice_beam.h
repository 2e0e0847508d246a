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

/* The arms g of both ends for a force at a point, (2, 3), seen from the slice. */
void slice_beam_arms(const rubber_slice *slice, const slice_beam *at, const double *point, double (*g)[3]);

/* The couple, (3), that a force f at a point p puts on the distal end of its element, all seen from the slice. The
 * proximal end gets the opposite couple. */
void slice_couple(const rubber_slice *slice, int name, const double *p, const double *f, double *couple);

/* nu / L of that; a line across a face has the mean over its width. */
static inline double slice_couple_gain(const rubber_slice *slice, int name) { return slice->bulging * (name < SLICE_LINES ? 1.0 : 2.0 / 3.0); }

/* A force f at contact k of a slice, along the normal unless one is given in space: the beam there, its arms and couple, seen from the slice. */
typedef struct {
    slice_beam here;
    double f[3], couple[3], g[SLICE_ENDS][3];
} slice_pressed;
void slice_press(const rubber_slice *slice, const objects_contacts *contacts, int k, const double *force, slice_pressed *found);
#endif

/* Slices of rubber between cross-sections next to each other. A force on one goes to both sections between which its element
 * lies, as on a beam that bends and shears. */
#ifndef FINGERFEM_SLICES_H
#define FINGERFEM_SLICES_H
#include <math.h>
#include "contact.h"

/* Curvature that slices are given besides their own, over their thickness [-]: what makes the middle of a flush one the nearest; and,
 * where contact is solved for, along the finger, for its point not to jump from one end to the other. */
#define SLICE_FLAT 1e-6
#define SLICE_DOME 4e-3

/* Names of a slice's contacts: its edges, or ends of the sides of its outline; points of its faces across y and across z, or of
 * the outline; and the lines across faces. */
enum { SLICE_FACES = OUTLINE_CORNERS * FINGERFEM_MOST_VERTICES, SLICE_LINES = SLICE_FACES + OUTLINE_CORNERS };

/* The place of a slice of a segment by its number; -1 if it is another one's. */
int slices_place(const chain_rods *map, int segment, int number);

/* Which elements of a segment an object at d may be near to, (elements); returns whether any is. */
int slices_near(const chain_rods *map, const chain_state *state, int segment, const fingerfem_object *object, double d, double near,
                unsigned char *found);

/* Corners in space of the knots that shape such elements, (knots, 4, 3) [m], in the rod's work. */
const double *slices_corners(const chain_rods *map, const chain_state *state, int segment, int free, const unsigned char *near);

/* A cross-section in space: its corners, the bulges of its faces across y and across z, and how far these are outside its corners, at most [m]. */
typedef struct {
    double corners[OUTLINE_CORNERS][3], bulges[2], beyond;
} rubber_section;
void slices_cut(const fingerfem_segment *segment, const double *points, int place, rubber_section *found);

/* A gap that no point between two sections is below, but for ridges, before an object at d [m]. */
double slices_least_gap(const rubber_section *begin, const rubber_section *end, const fingerfem_object *object, double d);

/* The slice at a place, from the corners of its sections; without its bodies. Then, seen from the slice, the bodies at its ends. */
void slices_make(const chain_rods *map, const chain_state *state, int segment, const rubber_section *begin, const rubber_section *end, int place,
                 rubber_slice *found);
void slices_hold(const chain_state *state, rubber_slice *slice);

/* The contacts of an object at d with a slice, of which the gaps are below `near` [m]. */
void slices_find(const rubber_slice *slice, const fingerfem_object *object, double d, double near, objects_contacts *all);

/* How a point of a slice, by its coordinates, moves with the tensions beside what its ends' motions do, (tensions, 3), in its
 * axes: as the rubber changes its shape; of the line across a face, the mean. Motions by the tensions must be known. */
void slices_bend(const chain_rods *map, const rubber_slice *slice, const chain_state *state, int name, const double *material, double *found);

/* How far a point of a slice, by its coordinates, moves as the faces bulge, (3), where the sum of the corners' motions, each
 * with these weights, is `twist`, (3); y and z axes, (2, 3), in the same frame. */
static inline double slices_twist(int corner) { return corner == 1 || corner == 2 ? 0.125 : -0.125; }
void slices_bulge(const fingerfem_segment *segment, double (*axes)[3], const double *twist, const double *material, double *found);

/* What a unit force at contact k of a slice puts on its bodies; along the normal, or, unless it is NULL, along another direction
 * in space, (3). */
void slices_arms(const rubber_slice *slice, const objects_contacts *contacts, int k, const double *force, contact_arms *found);

/* How far out the face of an element across y, 0, or across z, 1, on one of both sides, is lifted by tendons far from plates and the clamp; and
 * all of its faces, at most [m]. */
double slices_ridge(const rod_state *rod, int element, int across, int side);
double slices_highest(const rod_state *rod, int element);

/* How the ridge over a face at a point of a slice, by its coordinates, grows with each of some tensions, `count`, where the pose of
 * its element changes by `by`, (count, FINGERFEM_POSE); `own` says which the segment's are, NULL the first ones. Returns the axis
 * across the face, 1 or 2, or 0 for an edge. */
int slices_ridge_changes(const rod_state *rod, const rubber_slice *slice, const double *material, int count, const int32_t *own,
                         const double *by, double *found);

/* The section where an element begins, or, of the last one, where it ends. */
void slices_section(const chain_rods *map, const chain_state *state, int segment, int element, double *place, double *rotation);

/* Whether the sections of a slice have an outline of their own, and are no boxes. */
static inline int slices_outlined(const rubber_slice *slice) { return slice->of->vertices > 0; }

/* How far the face across y, 0, or across z, 1, at a point of a slice goes inwards along the axis, from its middle to its edges [m]. */
double slices_bulge_at(const rubber_slice *slice, int across, const double *at);

/* A point of a slice in space where its coordinates are `at`, -1 to 1, and its derivatives by these, (3, 3). */
void slices_at(const rubber_slice *slice, const double *at, double *x, double (*t)[3]);

static inline void slices_unit(double *v)
{
    const double size = sqrt(objects_dot(v, v));
    for (int i = 0; i < 3; i++) v[i] /= size;
}

/* A point of a slice in space, by its coordinates. */
void slices_point(const rubber_slice *slice, const double *material, double *x);
#endif

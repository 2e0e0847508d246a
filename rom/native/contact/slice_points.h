/* Points of a slice before an object: what is common to slices with faces and edges, and to those with an outline. */
#ifndef FINGERFEM_SLICE_POINTS_H
#define FINGERFEM_SLICE_POINTS_H
#include "slices.h"

/* A point of a slice before an object: coordinates [-], gap [m], normal out of the object, slopes of the gap [m]; and, on an outline,
 * its parameter and what there is. */
typedef struct {
    double at[3], gap, normal[3], slopes[3];
    double parameter;
    border_point border;
} near_point;

/* Which line through a point is followed at one x: an edge alone, the line across a face along axis 1 or 2, or the outline. */
enum { SLICE_EDGE = 0, SLICE_AROUND = 3 };

#define SLICE_SLOPE 1e-9 /* converged: slope of the gap over the slice's thickness [-] */
#define SLICE_FADE 5e-3  /* of half the side: a point so much nearer than the edges beside it is twice as compliant [-] */

/* A bracket of the root of a slope that grows with a coordinate, and which end moved last, for the Illinois method (Dowell and Jarratt 1971). */
typedef struct {
    double ends[2], slopes[2];
    int last;
} slice_bracket;

/* The secant's root in a bracket. */
static inline double slice_between(const slice_bracket *bracket)
{
    const double *ends = bracket->ends, *slopes = bracket->slopes;
    return (ends[0] * slopes[1] - ends[1] * slopes[0]) / (slopes[1] - slopes[0]);
}

/* Move one end to a point between; an end that stays twice has its slope halved. Returns the distance. */
static inline double slice_narrow(slice_bracket *bracket, double at, double slope)
{
    const int side = slope > 0.0;
    const double moved = fabs(bracket->ends[side] - at);
    bracket->ends[side] = at;
    bracket->slopes[side] = slope;
    if (side == bracket->last) bracket->slopes[!side] *= 0.5;
    bracket->last = side;
    return moved;
}

/* Gap and slopes at a point. Edges and faces count as slightly domed, so that of flush ones the middle is closest. */
void slice_look(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point);

/* The closest point along x, at its other coordinates, from where the point is. */
void slice_nearest_along(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point);

/* The closest point around the outline from where the point is, at its x, or, if `along`, with x that is nearest. */
void slice_nearest_around(const rubber_slice *slice, const fingerfem_object *object, double d, int along, near_point *point);

/* Possible closest points around the outline, seen from the point's x. */
void slice_begin_around(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point);

/* Add a contact that is closest on some line. The object presses it in from both sides of the point, which moves to the middle of
 * that. */
void slice_note(const rubber_slice *slice, const fingerfem_object *object, double d, int line, int name, double near, double compliance,
                near_point *point, objects_contacts *all);

/* The tangents, seen from such a slice, of the coordinates along which the point of contact k slides, and n . dt_i/ds_j of these;
 * returns how many there are. */
int slice_free_around(const rubber_slice *slice, const objects_contacts *contacts, int k, double (*tangents)[3], double (*curved)[2]);

/* Contacts with a slice whose sections have an outline, as `slices_find`. */
void slice_find_around(const rubber_slice *slice, const fingerfem_object *object, double d, double near, objects_contacts *all);

/* How a contact's point slides along its slice, rows 0 - 2, and how its normal changes, rows 3 - 5, both seen from the slice, as that
 * moves and turns along its own axes, (6, 6). */
void slice_sliding(const rubber_slice *slice, const fingerfem_object *object, double d, const objects_contacts *contacts, int k,
                   double (*found)[FINGERFEM_WRENCH]);

/* R v: a vector of a slice's or body's frame, in space. */
static inline void slice_turned(const double *rotation, const double *v, double *found)
{
    for (int i = 0; i < 3; i++) found[i] = objects_dot(rotation + 3 * i, v);
}
#endif

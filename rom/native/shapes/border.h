/* The outline of a section: all points within a margin of a convex polygon. One parameter runs around it, counterclockwise
 * about x: from 2 k to 2 k + 1 along the arc about vertex k, from there to 2 k + 2 along the side to the next vertex. Of a single
 * vertex it is the angle about it over 2 pi. Its tangent is continuous, also at a corner without a margin, where the point stays. */
#ifndef FINGERFEM_BORDER_H
#define FINGERFEM_BORDER_H
#include "../segment.h"

/* A point on the outline: along y and z [m]; the unit tangent there; the curvature, 0 on a side [1/m]; and whether it slides, as it
 * does but at a corner without a margin. */
typedef struct {
    double at[2], tangent[2], bend;
    int slides;
} border_point;

/* After how much of the parameter the outline comes back to its begin. */
static inline int border_period(const fingerfem_segment *segment) { return segment->vertices > 1 ? 2 * segment->vertices : 1; }

border_point border_at(const fingerfem_segment *segment, double parameter);

/* The parameter of the farthest point in a direction, (2). */
double border_towards(const fingerfem_segment *segment, const double *direction);

/* Depth of a point, (2) [m], within the outline; negative outside [m]. */
double border_depth(const fingerfem_segment *segment, const double *point);
#endif

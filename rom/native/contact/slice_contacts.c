/* Where slices of rubber may touch an object: edges and faces at their nearest points, and lines across faces. */
#include <math.h>
#include "slices.h"

#define STEPS 40     /* towards the nearest point */
#define FLAT 1e-9    /* slope of the gap where it is least [-] */
#define SHORT 1e-12  /* a last step, of coordinates [-] */
#define FADE 5e-3    /* of half the side: how much nearer than its edges a face that presses half as hard as it may is [-] */
#define FLUSH 0.4     /* of half the side: how far edges may be from an object, at most, that presses on the line between them [-] */

/* A point of a slice before an object: its coordinates, its gap, the normal, and how the gap changes along its coordinates. */
typedef struct {
    double at[3], gap, normal[3], slopes[3];
} near_point;

/* Edges and faces count as slightly domed, so that of flush ones the middle is the nearest. */
static void look(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    double x[3], t[3][3];
    slices_at(slice, point->at, x, t);
    point->gap = objects_distance(object, d, x, point->normal);
    for (int j = 0; j < 3; j++) point->slopes[j] = objects_dot(point->normal, t[j]) + (j ? SLICE_FLAT : slice->dome) * slice->thickness * point->at[j];
}

/* Bring a point to where an object is nearest along its axis x, between the slice's ends: the slope grows along it, as the
 * distance from a convex body does. (The Illinois method, Dowell and Jarratt 1971.) */
static void nearest_along(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    double ends[2] = {-1.0, 1.0}, slopes[2];
    for (int end = 0; end < 2; end++) {
        point->at[0] = ends[end];
        look(slice, object, d, point);
        slopes[end] = point->slopes[0];
        if (end ? slopes[1] <= 0.0 : slopes[0] >= 0.0) return;
    }
    for (int step = 0, last = -1; step < STEPS; step++) {
        point->at[0] = (ends[0] * slopes[1] - ends[1] * slopes[0]) / (slopes[1] - slopes[0]);
        look(slice, object, d, point);
        const int side = point->slopes[0] > 0.0;
        if (fabs(point->slopes[0]) < FLAT * slice->thickness || fabs(ends[side] - point->at[0]) < SHORT) return;
        ends[side] = point->at[0];
        slopes[side] = point->slopes[0];
        if (side == last) slopes[!side] *= 0.5;
        last = side;
    }
}

static void note_point(const rubber_slice *slice, int name, const near_point *point, double compliance, objects_contacts *all)
{
    double x[3], t[3][3], p[3], n[3];
    slices_at(slice, point->at, x, t);
    for (int i = 0; i < 3; i++) x[i] -= slice->centre[i];
    objects_turned_back(slice->rotation, x, p);
    objects_turned_back(slice->rotation, point->normal, n);
    all->plate = slice->number;
    all->segment = slice->segment;
    objects_note_rubber(all, name, point->gap, point->at, fmax(compliance, OBJECTS_COMPLIANCE), 0.5 * slice->dome * slice->thickness * point->at[0] * point->at[0], p, n);
}

/* The face between two edges that lie along x, from one to the other along axis j: a point nearer than both. It presses the
 * harder the nearer it is. */
static void face(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, objects_contacts *all)
{
    double ends[2] = {-1.0, 1.0}, slopes[2] = {edges[0].slopes[j], edges[1].slopes[j]};
    if (slopes[0] >= 0.0 || slopes[1] <= 0.0) return;
    const double least = (edges[0].gap * slopes[1] - edges[1].gap * slopes[0] + 2.0 * slopes[0] * slopes[1]) / (slopes[1] - slopes[0]);
    if (least > near) return; /* where both tangents meet */
    near_point point = edges[0];
    for (int step = 0, last = -1; step < STEPS; step++) {
        point.at[j] = (ends[0] * slopes[1] - ends[1] * slopes[0]) / (slopes[1] - slopes[0]);
        nearest_along(slice, object, d, &point);
        const int side = point.slopes[j] > 0.0;
        if (fabs(point.slopes[j]) < FLAT * slice->thickness || fabs(ends[side] - point.at[j]) < SHORT) break;
        ends[side] = point.at[j];
        slopes[side] = point.slopes[j];
        if (side == last) slopes[!side] *= 0.5;
        last = side;
    }
    const double nearer = fmin(edges[0].gap, edges[1].gap) - point.gap;
    if (point.gap < near && nearer > 0.0)
        note_point(slice, name, &point, segment->face_compliance * (1.0 + FADE * segment->half_lengths[1] / nearer), all);
}

/* The line across a face, from one of these edges to the other along axis j. It presses where the mean of its gaps closes, by
 * Simpson's rule along and across the slice; `middles` are the edges' gaps midway between the slice's ends. */
static void line(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, const double *middles, objects_contacts *all)
{
    static const double places[3] = {-1.0, 1.0, 0.0};
    const double aside = 0.5 * (middles[0] + middles[1]);
    near_point point = edges[0];
    double gaps[3], x[3], t[3][3];
    if (aside > 3.0 * near + FLUSH * segment->half_lengths[1]) return;
    point.at[j] = 0.0;
    for (int k = 0; k < 3; k++) {
        point.at[0] = places[k];
        slices_at(slice, point.at, x, t);
        gaps[k] = objects_distance(object, d, x, point.normal);
    }
    point.gap = (gaps[0] + gaps[1] + 2.0 * gaps[2] + 2.0 * aside) / 6.0;
    if (point.gap < near) note_point(slice, name, &point, segment->line_compliance, all);
}

void slices_find(const fingerfem_segment *segment, const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 objects_contacts *all)
{
    double middles[OUTLINE_CORNERS];
    near_point edges[OUTLINE_CORNERS]; /* -y -z, y -z, -y z, y z */
    for (int k = 0; k < OUTLINE_CORNERS; k++) {
        edges[k] = (near_point){.at = {0.0, k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0}};
        look(slice, object, d, edges + k);
        middles[k] = edges[k].gap;
        if (edges[k].gap > near + slice->thickness) continue;
        nearest_along(slice, object, d, edges + k);
        if (edges[k].gap < near) note_point(slice, k, edges + k, segment->edge_compliance, all);
    }
    for (int side = 0; side < 2; side++) {
        const near_point across_y[2] = {edges[side], edges[side + 2]}, across_z[2] = {edges[2 * side], edges[2 * side + 1]};
        const double middles_y[2] = {middles[side], middles[side + 2]}, middles_z[2] = {middles[2 * side], middles[2 * side + 1]};
        face(segment, slice, object, d, near, SLICE_FACES + side, 2, across_y, all);
        face(segment, slice, object, d, near, SLICE_FACES + 2 + side, 1, across_z, all);
        line(segment, slice, object, d, near, SLICE_LINES + side, 2, across_y, middles_y, all);
        line(segment, slice, object, d, near, SLICE_LINES + 2 + side, 1, across_z, middles_z, all);
    }
}

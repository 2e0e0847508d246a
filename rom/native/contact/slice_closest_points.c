/* Contacts of a slice of rubber with a convex object: closest points of edges and faces, and lines across faces. */
#include <math.h>
#include <string.h>
#include "slice_points.h"

#define STEPS 40     /* most steps of the Illinois method */
#define ROUGH 1e-6   /* converged: slope of the gap over the slice's thickness, of what a profile is sampled at [-] */
#define SHORT 1e-12  /* converged: step of a coordinate [-] */
#define SHALLOW 0.25 /* of the gap up to which slices take part: below it, their profile is sampled [-] */
#define FLUSH 0.4    /* of half the side: largest gap of the edges, about, of a line that may press [-] */

void slice_look(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    double x[3], t[3][3];
    /* slope_j = n . t_j + dome thickness at_j */
    slices_at(slice, point->at, x, t);
    point->gap = objects_distance(object, d, x, point->normal);
    for (int j = 0; j < 3; j++) point->slopes[j] = objects_dot(point->normal, t[j]) + (j ? SLICE_FLAT : slice->dome) * slice->thickness * point->at[j];
}

/* Closest point of a line along axis j, between its ends, from where the point is: the root of the slope, which grows along the line as the
 * distance from a convex body is convex. It is smaller than `small` over the thickness there. */
static void nearest_on(const rubber_slice *slice, const fingerfem_object *object, double d, int j, double small, near_point *point)
{
    slice_bracket bracket = {.last = -1};
    slice_look(slice, object, d, point);
    if (fabs(point->slopes[j]) < small * slice->thickness) return;
    /* the gap falls towards this end; stop there if it falls up to it */
    const int side = point->slopes[j] < 0.0;
    const double end = side ? 1.0 : -1.0;
    if (point->at[j] == end) return;
    bracket.ends[!side] = point->at[j];
    bracket.slopes[!side] = point->slopes[j];
    point->at[j] = end;
    slice_look(slice, object, d, point);
    if (side ? point->slopes[j] <= 0.0 : point->slopes[j] >= 0.0) return;
    bracket.ends[side] = end;
    bracket.slopes[side] = point->slopes[j];
    for (int step = 0; step < STEPS; step++) {
        point->at[j] = slice_between(&bracket);
        slice_look(slice, object, d, point);
        const double slope = point->slopes[j];
        if (fabs(slope) < small * slice->thickness || slice_narrow(&bracket, point->at[j], slope) < SHORT) return;
    }
}

void slice_nearest_along(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    nearest_on(slice, object, d, 0, SLICE_SLOPE, point);
}

/* The gap of a line at one x. */
static void look_at(const rubber_slice *slice, const fingerfem_object *object, double d, int line, double x, near_point *point)
{
    point->at[0] = x;
    if (line == SLICE_AROUND) slice_nearest_around(slice, object, d, 0, point);
    else if (line) nearest_on(slice, object, d, line, ROUGH, point);
    else slice_look(slice, object, d, point);
}

/* How the gap of a line grows from its closest point to both ends of the slice; then the point moves to the middle of what is pressed
 * in at that gap. */
static void press(const rubber_slice *slice, const fingerfem_object *object, double d, int line, double near, near_point *point,
                  indentation_profile *found)
{
    const double least = point->gap, from = point->at[0];
    double t[2];
    memset(found, 0, sizeof *found);
    if (slice->dome != SLICE_DOME || least > SHALLOW * near) return; /* nothing is solved for, or it does not press yet */
    for (int side = 0; side < 2; side++) {
        /* gaps midway and at the end, over the least */
        const double to = side ? 1.0 : -1.0;
        near_point aside = *point;
        look_at(slice, object, d, line, 0.5 * (from + to), &aside);
        const double midway = aside.gap - least;
        look_at(slice, object, d, line, to, &aside);
        indentation_side(found, side, 0.5 * fabs(to - from), midway, aside.gap - least);
    }
    if (least >= 0.0) return;
    indentation_zone(found, -least, t);
    look_at(slice, object, d, line, from + found->sides[1].length * t[1] - found->sides[0].length * t[0], point);
    found->rise = point->gap - least;
    found->slides = fabs(from) < 1.0 && t[0] < 1.0 && t[1] < 1.0;
}

/* Add the contact of a point, seen from the slice, with the compliance of the segment's rubber [m/N]. Its dome is what the gap grows by in a solution, see SLICE_DOME. */
static void note_point(const rubber_slice *slice, int name, const near_point *point, double compliance,
                       const indentation_profile *profile, objects_contacts *all)
{
    double x[3], t[3][3], p[3], n[3];
    /* point p and normal n in the slice's frame */
    slices_at(slice, point->at, x, t);
    for (int i = 0; i < 3; i++) x[i] -= slice->centre[i];
    objects_turned_back(slice->rotation, x, p);
    objects_turned_back(slice->rotation, point->normal, n);
    all->plate = slice->number;
    const double own = fmax(compliance / slice->modulus, OBJECTS_COMPLIANCE);
    const int k = objects_note_rubber(all, name, point->gap, point->at, own, 0.5 * slice->dome * slice->thickness * point->at[0] * point->at[0], profile, p, n);
    if (k >= 0) all->borders[k] = point->border;
}

void slice_note(const rubber_slice *slice, const fingerfem_object *object, double d, int line, int name, double near, double compliance,
                near_point *point, objects_contacts *all)
{
    indentation_profile profile;
    press(slice, object, d, line, near, point, &profile);
    note_point(slice, name, point, compliance, &profile, all);
}

/* Closest point of the face between two edges along x, across along axis j, if it is nearer than both. The less it is
 * nearer, the more compliant it is, so that its force fades out as the point moves to an edge. */
static void face(const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, objects_contacts *all)
{
    /* stop: the gap grows from one of the edges */
    slice_bracket bracket = {{-1.0, 1.0}, {edges[0].slopes[j], edges[1].slopes[j]}, -1};
    const double *slopes = bracket.slopes;
    if (slopes[0] >= 0.0 || slopes[1] <= 0.0) return;
    /* stop: where the tangents at both edges meet, a lower bound of the gap is too large */
    const double least = (edges[0].gap * slopes[1] - edges[1].gap * slopes[0] + 2.0 * slopes[0] * slopes[1]) / (slopes[1] - slopes[0]);
    if (least > near) return;
    /* Illinois method along axis j, for the least gap along x */
    near_point point = edges[0];
    for (int step = 0; step < STEPS; step++) {
        point.at[j] = slice_between(&bracket);
        slice_nearest_along(slice, object, d, &point);
        const double slope = point.slopes[j];
        if (fabs(slope) < SLICE_SLOPE * slice->thickness || slice_narrow(&bracket, point.at[j], slope) < SHORT) break;
    }
    /* contact if it is nearer than both edges: compliance c (1 + FADE h / how much nearer) */
    const double nearer = fmin(edges[0].gap, edges[1].gap) - point.gap;
    if (point.gap >= near || nearer <= 0.0) return;
    const double compliance = slice->of->face_compliance * (1.0 + SLICE_FADE * slice->of->half_lengths[1] / nearer);
    slice_note(slice, object, d, j, name, near, compliance, &point, all);
}

/* The line across a face, from one edge to the other along axis j. It presses where the mean gap of the face closes, by
 * Simpson's rule along and across the slice; `middles` are the edges' gaps midway between the slice's ends. */
static void line(const rubber_slice *slice, const fingerfem_object *object, double d, double near,
                 int name, int j, const near_point *edges, const double *middles, objects_contacts *all)
{
    static const double places[3] = {-1.0, 1.0, 0.0};
    const double aside = 0.5 * (middles[0] + middles[1]);
    near_point point = edges[0];
    double gaps[3], x[3], t[3][3];
    /* stop: the edges are far from the object */
    if (aside > 3.0 * near + FLUSH * slice->of->half_lengths[1]) return;
    /* gaps along the middle of the face, at both ends and at x = 0, where the normal is taken */
    point.at[j] = 0.0;
    for (int k = 0; k < 3; k++) {
        point.at[0] = places[k];
        slices_at(slice, point.at, x, t);
        gaps[k] = objects_distance(object, d, x, point.normal);
    }
    /* mean gap, (g(-1) + g(1) + 2 g(0) + 2 aside) / 6 with the edges' mean, aside */
    point.gap = (gaps[0] + gaps[1] + 2.0 * gaps[2] + 2.0 * aside) / 6.0;
    const indentation_profile whole = {.rise = 0.0};
    if (point.gap < near) note_point(slice, name, &point, slice->of->line_compliance, &whole, all);
}

void slices_find(const rubber_slice *slice, const fingerfem_object *object, double d, double near, objects_contacts *all)
{
    double middles[OUTLINE_CORNERS];
    near_point edges[OUTLINE_CORNERS]; /* -y -z, y -z, -y z, y z */
    if (slices_outlined(slice)) {
        slice_find_around(slice, object, d, near, all);
        return;
    }
    /* edges: gap midway, then the closest point; far ones stay midway */
    for (int k = 0; k < OUTLINE_CORNERS; k++) {
        edges[k] = (near_point){.at = {0.0, k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0}};
        slice_look(slice, object, d, edges + k);
        middles[k] = edges[k].gap;
        if (edges[k].gap > near + slice->thickness) continue;
        slice_nearest_along(slice, object, d, edges + k);
        if (edges[k].gap >= near) continue;
        near_point point = edges[k];
        slice_note(slice, object, d, SLICE_EDGE, k, near, slice->of->edge_compliance, &point, all);
    }
    /* faces across y and across z, on both sides: closest point, and line across */
    for (int side = 0; side < 2; side++) {
        const near_point across_y[2] = {edges[side], edges[side + 2]}, across_z[2] = {edges[2 * side], edges[2 * side + 1]};
        const double middles_y[2] = {middles[side], middles[side + 2]}, middles_z[2] = {middles[2 * side], middles[2 * side + 1]};
        face(slice, object, d, near, SLICE_FACES + side, 2, across_y, all);
        face(slice, object, d, near, SLICE_FACES + 2 + side, 1, across_z, all);
        line(slice, object, d, near, SLICE_LINES + side, 2, across_y, middles_y, all);
        line(slice, object, d, near, SLICE_LINES + 2 + side, 1, across_z, middles_z, all);
    }
}

/* Contacts of a slice whose sections have an outline, with a convex object: its closest point, and the ends of long sides. */
#include <math.h>
#include "slice_points.h"

#define STEPS 40     /* most steps of the Illinois method */
#define BEGIN 0.02   /* first step around, over the period of the parameter [-] */
#define SHORT 1e-12  /* converged: step of the parameter [-] */
#define LONG 0.5     /* of the box's smaller half: from this length on a side's ends are contacts of their own [-] */
#define MOST_CURVED 30.0 /* ratio of curvatures from which on a ball counts as so flat [-] */
#define WAY 1e-3     /* step of central differences of tangents, over half a slice and half the box [-] */

void slice_begin_around(const rubber_slice *slice, const fingerfem_object *object, double d, near_point *point)
{
    const double *half = slice->of->half_lengths + 1, middle[3] = {point->at[0], 0.0, 0.0};
    double x[3], t[3][3], n[3], towards[2];
    /* against the gradient of the gap across the axis */
    slices_at(slice, middle, x, t);
    objects_distance(object, d, x, n);
    for (int i = 0; i < 2; i++) towards[i] = -objects_dot(n, t[1 + i]) / half[i];
    point->parameter = border_towards(slice->of, towards);
}

/* Slope of the gap along the outline at a parameter [-]; `along` as in slice_nearest_around. */
static double look_around(const rubber_slice *slice, const fingerfem_object *object, double d, int along, double parameter, near_point *point)
{
    const double *half = slice->of->half_lengths + 1;
    double slope = 0.0;
    point->parameter = parameter;
    point->border = border_at(slice->of, parameter);
    for (int i = 0; i < 2; i++) point->at[1 + i] = point->border.at[i] / half[i];
    if (along) slice_nearest_along(slice, object, d, point);
    else slice_look(slice, object, d, point);
    for (int i = 0; i < 2; i++) slope += point->slopes[1 + i] * point->border.tangent[i] / half[i];
    return slope;
}

/* The root of the slope, which grows counterclockwise about the closest point as the distance from a convex body is convex: a
 * bracket, from steps twice as long each, and then the Illinois method. */
void slice_nearest_around(const rubber_slice *slice, const fingerfem_object *object, double d, int along, near_point *point)
{
    const double period = border_period(slice->of);
    double slope = look_around(slice, object, d, along, point->parameter, point);
    slice_bracket bracket = {.last = -1};
    if (fabs(slope) < SLICE_SLOPE) return;
    /* end 0 has a slope below 0, end 1 one above; stop without a bracket after half a turn: the object is around the axis */
    const int side = slope > 0.0;
    bracket.ends[side] = point->parameter;
    bracket.slopes[side] = slope;
    for (double step = BEGIN * period, away = step;; step *= 2.0, away += step) {
        if (away > 0.5 * period) return;
        slope = look_around(slice, object, d, along, bracket.ends[side] + (side ? -step : step), point);
        const int there = slope > 0.0;
        bracket.ends[there] = point->parameter;
        bracket.slopes[there] = slope;
        if (there != side) break;
    }
    for (int k = 0; k < STEPS; k++) {
        const double between = slice_between(&bracket);
        slope = look_around(slice, object, d, along, between, point);
        if (fabs(slope) < SLICE_SLOPE || slice_narrow(&bracket, between, slope) < SHORT) return;
    }
}

/* The end of side k, or its begin, as a contact if its gap is below `near`; returns the gap. */
static double side_end(const rubber_slice *slice, const fingerfem_object *object, double d, double near, int k, int end, objects_contacts *all)
{
    const fingerfem_segment *segment = slice->of;
    near_point point = {.parameter = 2 * k + 1 + end};
    point.border = border_at(segment, point.parameter);
    point.border.slides = 0;
    for (int i = 0; i < 2; i++) point.at[1 + i] = point.border.at[i] / segment->half_lengths[1 + i];
    slice_nearest_along(slice, object, d, &point);
    const double gap = point.gap, compliance = segment->margin > 0.0 ? segment->face_compliance : segment->edge_compliance;
    if (gap < near) slice_note(slice, object, d, SLICE_EDGE, 2 * k + end, near, compliance, &point, all);
    return gap;
}

/* Whether side k is long. */
static int is_long(const fingerfem_segment *segment, int k)
{
    const double *from = segment->polygon + 2 * k, *to = segment->polygon + 2 * ((k + 1) % segment->vertices);
    const double along[2] = {to[0] - from[0], to[1] - from[1]};
    return sqrt(along[0] * along[0] + along[1] * along[1]) > LONG * fmin(segment->half_lengths[1], segment->half_lengths[2]);
}

/* Stiffness before a ball, over that before a ball of a circle's own radius: Hertz's for curvatures across and along the slice with the
 * ratio a, a^(-1/4) F^(-3/2) with F = 1 - (a^0.0684 - 1)^1.531 (a fit to elliptic integrals, within 1 %; L. C. Hale, thesis, MIT 1999). */
static double before_ball(const fingerfem_segment *segment, const fingerfem_object *object)
{
    if (object->shape != FINGERFEM_SPHERE || object->half_length > 0.0 || segment->vertices != 1) return 1.0;
    const double ratio = fmin(1.0 + object->radius / segment->margin, MOST_CURVED);
    const double nearer = 1.0 - pow(pow(ratio, 0.0684) - 1.0, 1.531);
    return pow(2.0 / ratio, 0.25) * pow(nearer, -1.5);
}

void slice_find_around(const rubber_slice *slice, const fingerfem_object *object, double d, double near, objects_contacts *all)
{
    const fingerfem_segment *segment = slice->of;
    near_point point = {.at = {0.0}};
    /* the closest point, than which no other is nearer */
    slice_begin_around(slice, object, d, &point);
    slice_nearest_around(slice, object, d, 1, &point);
    if (point.gap >= near) return;
    /* ends of long sides, on which a plane may lie flush; without a margin the begin of a side is the end of the one before */
    double least = INFINITY;
    for (int k = 0; k < segment->vertices && segment->vertices > 1; k++) {
        const int before = (k + segment->vertices - 1) % segment->vertices, shared = segment->margin == 0.0 && is_long(segment, before);
        if (!is_long(segment, k)) continue;
        if (!shared) least = fmin(least, side_end(slice, object, d, near, k, 0, all));
        least = fmin(least, side_end(slice, object, d, near, k, 1, all));
    }
    /* the less the point is nearer than these, the more compliant it is, so that its force fades out as it moves there */
    const double nearer = least - point.gap;
    if (nearer <= 0.0) return;
    const double compliance = segment->face_compliance / before_ball(segment, object) * (1.0 + SLICE_FADE * segment->half_lengths[1] / nearer);
    slice_note(slice, object, d, SLICE_AROUND, SLICE_FACES, near, compliance, &point, all);
}

/* Tangents along a slice and along its outline, (2, 3), at a point that is moved by ds along the first, and by dl along the outline [m]. */
static void tangents_at(const rubber_slice *slice, const double *at, const border_point *border, double ds, double dl, double (*found)[3])
{
    const double *half = slice->of->half_lengths + 1, inward[2] = {-border->tangent[1], border->tangent[0]};
    double moved[3] = {at[0] + ds}, tangent[2], x[3], t[3][3];
    /* along the outline: p + tau dl + (bend dl^2 / 2) inwards, and tau + bend dl inwards */
    for (int i = 0; i < 2; i++) {
        moved[1 + i] = at[1 + i] + (border->tangent[i] * dl + 0.5 * border->bend * dl * dl * inward[i]) / half[i];
        tangent[i] = (border->tangent[i] + border->bend * dl * inward[i]) / half[i];
    }
    slices_at(slice, moved, x, t);
    for (int i = 0; i < 3; i++) {
        found[0][i] = t[0][i];
        found[1][i] = t[1][i] * tangent[0] + t[2][i] * tangent[1];
    }
}

int slice_free_around(const rubber_slice *slice, const objects_contacts *contacts, int k, double (*tangents)[3], double (*curved)[2])
{
    const double *at = contacts->material[k], *half = slice->of->half_lengths + 1;
    const border_point *border = contacts->borders + k;
    const double ways[2] = {WAY, WAY * half[0]};
    double here[2][3], n[3], dome = 0.0;
    int free[2], count = 0;
    /* along the slice, but at its ends and in the middle of what is pressed in; and along the outline, but at corners */
    if (fabs(at[0]) < 1.0 && (contacts->profiles[k].slides || contacts->gaps[k] >= 0.0)) free[count++] = 0;
    if (border->slides) free[count++] = 1;
    tangents_at(slice, at, border, 0.0, 0.0, here);
    for (int i = 0; i < 3; i++) n[i] = objects_dot(slice->rotation + 3 * i, contacts->wrenches[k]);
    for (int b = 0; b < count; b++) {
        /* column b of n . dt_i/ds_j by a central difference */
        const double way = ways[free[b]];
        double sides[2][2][3];
        for (int side = 0; side < 2; side++) {
            const double step = side ? way : -way;
            tangents_at(slice, at, border, free[b] ? 0.0 : step, free[b] ? step : 0.0, sides[side]);
        }
        for (int a = 0; a < count; a++) {
            double change[3];
            for (int i = 0; i < 3; i++) change[i] = (sides[1][free[a]][i] - sides[0][free[a]][i]) / (2.0 * way);
            curved[a][b] = objects_dot(n, change);
        }
        objects_turned_back(slice->rotation, here[free[b]], tangents[b]);
    }
    /* the dome along the slice, and that along sides */
    for (int i = 0; i < 2; i++) dome += border->tangent[i] * border->tangent[i] / (half[i] * half[i]);
    for (int a = 0; a < count; a++) curved[a][a] += (free[a] ? SLICE_FLAT * dome : SLICE_DOME) * slice->thickness;
    return count;
}

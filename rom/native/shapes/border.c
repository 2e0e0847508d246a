#include "border.h"
#include <math.h>

#define TURN 6.283185307179586 /* [rad] */

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1]; }

static double cross(const double *a, const double *b) { return a[0] * b[1] - a[1] * b[0]; }

static const double *vertex(const fingerfem_segment *segment, int k) { return segment->polygon + 2 * ((k + segment->vertices) % segment->vertices); }

/* Unit normal of the side from vertex k to the next one; of a single vertex, the y axis. */
static void normal_of(const fingerfem_segment *segment, int k, double *normal)
{
    const double *from = vertex(segment, k), *to = vertex(segment, k + 1), along[2] = {to[0] - from[0], to[1] - from[1]};
    const double length = sqrt(dot(along, along));
    normal[0] = length > 0.0 ? along[1] / length : 1.0;
    normal[1] = length > 0.0 ? -along[0] / length : 0.0;
}

/* The angle of the arc about vertex k, from the normal of the side before it, (2), to that of the side after it. */
static double arc_of(const fingerfem_segment *segment, int k, double *before)
{
    double after[2];
    if (segment->vertices == 1) {
        normal_of(segment, k, before);
        return TURN;
    }
    normal_of(segment, k - 1, before);
    normal_of(segment, k, after);
    const double angle = atan2(cross(before, after), dot(before, after));
    return angle > 0.0 ? angle : angle + TURN; /* half a turn about both ends of a line */
}

border_point border_at(const fingerfem_segment *segment, double parameter)
{
    const int period = border_period(segment);
    const double within = parameter - period * floor(parameter / period);
    const int part = within < period ? (int)within : 0, k = part / 2;
    const double share = within < period ? within - part : 0.0, *corner = vertex(segment, k);
    double normal[2];
    border_point found = {.bend = 0.0, .slides = 1};
    if (part % 2) {
        /* side: the corner, and a share of the way to the next one */
        const double *next = vertex(segment, k + 1);
        normal_of(segment, k, normal);
        for (int i = 0; i < 2; i++) found.at[i] = corner[i] + share * (next[i] - corner[i]);
    } else {
        /* arc: the normal turns by a share of the angle */
        double before[2];
        const double angle = share * arc_of(segment, k, before), c = cos(angle), s = sin(angle);
        normal[0] = c * before[0] - s * before[1];
        normal[1] = s * before[0] + c * before[1];
        for (int i = 0; i < 2; i++) found.at[i] = corner[i];
        found.slides = segment->margin > 0.0;
        if (found.slides) found.bend = 1.0 / segment->margin;
    }
    /* the margin along the normal; the tangent is a quarter of a turn ahead of it */
    for (int i = 0; i < 2; i++) found.at[i] += segment->margin * normal[i];
    found.tangent[0] = -normal[1];
    found.tangent[1] = normal[0];
    return found;
}

double border_towards(const fingerfem_segment *segment, const double *direction)
{
    int farthest = 0;
    double before[2];
    /* farthest vertex of the polygon, and the share of its arc at which the normal has the direction */
    for (int k = 1; k < segment->vertices; k++)
        if (dot(vertex(segment, k), direction) > dot(vertex(segment, farthest), direction)) farthest = k;
    const double angle = arc_of(segment, farthest, before);
    double ahead = atan2(cross(before, direction), dot(before, direction));
    if (segment->vertices == 1) return ahead < 0.0 ? ahead / TURN + 1.0 : ahead / TURN;
    return 2 * farthest + fmin(fmax(ahead / angle, 0.0), 1.0);
}

double border_depth(const fingerfem_segment *segment, const double *point)
{
    double outside = INFINITY, inside = INFINITY;
    for (int k = 0; k < segment->vertices; k++) {
        const double *from = vertex(segment, k), *to = vertex(segment, k + 1), arm[2] = {point[0] - from[0], point[1] - from[1]};
        const double along[2] = {to[0] - from[0], to[1] - from[1]}, square = dot(along, along);
        /* distance from the side, between its ends; and depth below its line */
        const double share = square > 0.0 ? fmin(fmax(dot(arm, along) / square, 0.0), 1.0) : 0.0;
        const double off[2] = {arm[0] - share * along[0], arm[1] - share * along[1]};
        outside = fmin(outside, sqrt(dot(off, off)));
        if (square > 0.0) inside = fmin(inside, cross(along, arm) / sqrt(square));
    }
    /* within the polygon, or not */
    return segment->margin + (segment->vertices > 2 && inside >= 0.0 ? inside : -outside);
}

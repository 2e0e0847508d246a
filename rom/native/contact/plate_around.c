/* Contacts of a plate whose section has an outline, with a convex object: a prism as thick as the plate. An object may touch its side
 * between both rims, a rim where the gap along it has a minimum, or, beyond the front, the face. Where the face lies flush, points around the
 * front rim press, which stay where they are. */
#include <math.h>
#include "plate_around.h"
#include "slice_points.h"

#define AROUND 12     /* points around a rim, at least, which stay, and from which minima are looked for */
#define SPREAD 0.2    /* of half the box: contacts whose gap is larger by so much than the least one do not take part [-] */
#define STEADY 0.05   /* of the curvature of a circle as wide as the box: where the gap along a rim has less at its minimum, the contact is
                         more compliant, as the point moves far by a small turn [-] */
#define UNSTEADY 1e-4 /* the same, below which only points that stay bear [-] */
#define CREASE 1e-6   /* slope of the gap along a rim at a minimum, from which on it has a crease there [-] */

/* Names of contacts, beside those of objects' points on the face: of the side, of up to two minima of each rim, and of points of each
 * rim that stay. */
enum { SIDE = OBJECTS_SIDE, RIMS = SIDE - 1, MINIMA = 2, STAYING = RIMS - 2 * MINIMA };

/* Points of a rim at most: one of every part, or of few parts less than 2 AROUND. */
enum { MOST = 2 * (FINGERFEM_MOST_VERTICES + AROUND) };

/* A plate as a slice. */
static void as_slice(const fingerfem_segment *segment, const chain_body *body, rubber_slice *found)
{
    memset(found, 0, sizeof *found);
    found->of = segment;
    found->thickness = 2.0 * segment->half_lengths[0];
    memcpy(found->centre, body->centre, sizeof found->centre);
    memcpy(found->rotation, body->rotation, sizeof found->rotation);
    memcpy(found->shape[0], body->centre, sizeof body->centre);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) found->shape[1 << j][i] = segment->half_lengths[j] * body->rotation[3 * i + j];
}

/* Add the contact of a point, by its coordinates in the plate. At a minimum along a rim, it is the more compliant the less the gap is
 * curved there, t . H t + n . dt/dl with the tangent t, over a circle's curvature. Where the gap has a crease, as in a hull, the point
 * stays. */
static void note(const rubber_slice *plate, const fingerfem_object *object, double d, int name, const near_point *point, objects_contacts *all)
{
    objects_feature feature = {.kind = OBJECTS_FACE};
    border_point border = point->border;
    double p[3], n[3], compliance = OBJECTS_COMPLIANCE;
    const double *half = plate->of->half_lengths, *t = border.tangent;
    for (int i = 0; i < 3; i++) p[i] = half[i] * point->at[i];
    const double gap = objects_feature_at(object, d, plate->centre, plate->rotation, p, &feature, n);
    const int minimum = name < SIDE && name > STAYING, crease = fabs(n[1] * t[0] + n[2] * t[1]) > CREASE;
    if (minimum && !crease) {
        const double tangent[3] = {0.0, t[0], t[1]};
        double turned[3];
        objects_normal_change(&feature, fabs(gap + object->radius), n, tangent, turned);
        const double steady = half[1] * (objects_dot(tangent, turned) + objects_border_bend(&border, n));
        if (!(steady > UNSTEADY)) return;
        compliance *= 1.0 + STEADY * STEADY / (steady * steady);
    }
    const int k = objects_note(all, name, &feature, gap, p, n);
    if (k < 0) return;
    all->borders[k] = border;
    if (crease) all->borders[k].slides = 0;
    all->compliance[k] = compliance;
}

/* Whether two points of a rim are one. */
static int same(const near_point *one, const near_point *other) { return one->at[1] == other->at[1] && one->at[2] == other->at[2]; }

/* Points around one rim and their gaps: corners of a polygon, or points of every part, AROUND at least; returns their number. */
static int points_of(const rubber_slice *plate, const fingerfem_object *object, double d, int front, near_point *found)
{
    const int period = border_period(plate->of), all = period * ((AROUND + period - 1) / period);
    int count = 0;
    for (int k = 0; k < all; k++) {
        near_point *own = found + count;
        *own = (near_point){.at = {front ? 1.0 : -1.0}, .parameter = (double)period * k / all};
        own->border = border_at(plate->of, own->parameter);
        for (int i = 0; i < 2; i++) own->at[1 + i] = own->border.at[i] / plate->of->half_lengths[1 + i];
        if (count && (same(own, own - 1) || same(own, found))) continue;
        slice_look(plate, object, d, own);
        own->border.slides = 0;
        count++;
    }
    return count;
}

/* Contacts of one rim, with gaps below `near` [m]: points that stay, which a circle needs on its front alone, and minima that slide. */
static void rim(const rubber_slice *plate, const fingerfem_object *object, double d, int front, double near, objects_contacts *all)
{
    near_point around[MOST], minima[MINIMA];
    const int points = points_of(plate, object, d, front, around), stay = front || plate->of->vertices > 1;
    int count = 0;
    for (int k = 0; k < points && stay; k++)
        if (around[k].gap < near) note(plate, object, d, STAYING - MOST * front - k, around + k, all);
    /* minima, from points that are nearer than both neighbours: the first one the nearest, then another */
    for (int k = 0; k < points; k++) {
        const near_point *before = around + (k + points - 1) % points, *after = around + (k + 1) % points;
        if (before->gap <= around[k].gap || after->gap < around[k].gap || around[k].gap > near + plate->of->half_lengths[1]) continue;
        near_point point = around[k];
        slice_nearest_around(plate, object, d, 0, &point);
        if (!point.border.slides || (count == MINIMA && minima[1].gap <= point.gap)) continue;
        if (count < MINIMA) count++;
        minima[count - 1] = point;
        if (count == 2 && minima[0].gap > minima[1].gap) minima[1] = minima[0], minima[0] = point;
    }
    /* two minima keep their names as the nearer one changes: that at the larger y is the first one, or at the larger z */
    const double *one = minima[0].at, *two = minima[1].at;
    const int axis = count == 2 && fabs(one[2] - two[2]) > fabs(one[1] - two[1]) ? 2 : 1, swap = count == 2 && one[axis] < two[axis];
    for (int k = 0; k < count; k++)
        if (minima[k].gap < near) note(plate, object, d, RIMS - MINIMA * front - (swap ? 1 - k : k), minima + k, all);
}

/* Points of an object before the front face, or in the plate near to it: the centre of a ball, or vertices of a hull. Returns the least gap [m]. */
static double face(const rubber_slice *plate, const fingerfem_object *object, double d, objects_contacts *all)
{
    const double *half = plate->of->half_lengths;
    double least = INFINITY;
    const int count = object->shape == FINGERFEM_SPHERE ? 1 : object->shape == FINGERFEM_HULL ? object->corners : 0;
    for (int k = 0; k < count; k++) {
        objects_feature feature = {.kind = OBJECTS_POINT};
        double place[3];
        for (int i = 0; i < 3; i++) {
            const double vertex = object->shape == FINGERFEM_HULL ? object->vertices[3 * k + i] : 0.0;
            place[i] = object->centre[i] + d * object->direction[i] + vertex - plate->centre[i];
        }
        objects_turned_back(plate->rotation, place, feature.s);
        /* stop: it is beside the plate, or in it, nearer to the side than to the front */
        const double depth = border_depth(plate->of, feature.s + 1);
        if (depth <= 0.0 || depth < half[0] - feature.s[0]) continue;
        /* the point before it on the face, and the gap along x */
        const double p[3] = {half[0], feature.s[1], feature.s[2]}, n[3] = {-1.0, 0.0, 0.0}, gap = feature.s[0] - half[0] - object->radius;
        objects_note(all, OBJECTS_POINTS + k, &feature, gap, p, n);
        least = fmin(least, gap);
    }
    return least;
}

void plate_find_around(const fingerfem_segment *segment, const fingerfem_object *object, double d, int number, const chain_body *body,
                       objects_contacts *all)
{
    rubber_slice plate;
    near_point nearest = {.at = {0.0}};
    as_slice(segment, body, &plate);
    all->plate = number;
    memcpy(all->half_lengths, segment->half_lengths, sizeof all->half_lengths);
    /* points on the face, and the closest point of the side and of both rims */
    const double before = face(&plate, object, d, all);
    slice_begin_around(&plate, object, d, &nearest);
    slice_nearest_around(&plate, object, d, 1, &nearest);
    const double near = fmin(before, nearest.gap) + SPREAD * fmax(segment->half_lengths[1], segment->half_lengths[2]);
    if (fabs(nearest.at[0]) < 1.0 && nearest.gap < near) note(&plate, object, d, SIDE, &nearest, all);
    for (int front = 0; front < 2; front++) rim(&plate, object, d, front, near, all);
}

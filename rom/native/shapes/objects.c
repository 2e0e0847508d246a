/* Contacts of planes, balls, cylinders and hulls with a plate, how they change as it moves, and distances of points. */
#include "objects.h"
#include <math.h>
#include <string.h>
#include "hull.h"

#define FAR 1.0       /* d from which an object approaches [m] */
#define MARCHES 60    /* most of Newton's steps to the distance at which it touches */
#define TOUCHED 1e-12 /* converged: gap [m] */
#define TINY 1e-12    /* squared sine between a line and an edge, below which corners alone count [-] */

typedef double vector[3];

/* The axis that an edge is along. */
static int edge_axis(int name) { return (name - OBJECTS_CORNERS) / 4; }

/* The middle of an edge. */
static void edge_middle(int name, const double *half, double *p)
{
    /* the two bits of k are the signs along the other two axes */
    const int j = edge_axis(name), k = (name - OBJECTS_CORNERS) % 4;
    objects_corner((k & 1) << (j == 0) | (k >> 1) << (j == 2 ? 1 : 2), half, p);
    p[j] = 0.0;
}

/* Contacts with a plane: all corners p, with the gap a . (p - s). */
static void before_face(const objects_feature *face, objects_contacts *found)
{
    for (int k = 0; k < OBJECTS_CORNERS; k++) {
        vector p;
        objects_corner(k, found->half_lengths, p);
        objects_note(found, k, face, objects_dot(face->a, p) - objects_dot(face->a, face->s), p, face->a);
    }
}

/* Contact of a point p of the plate with a cylinder about a line. */
static void beside(int name, const objects_feature *line, double radius, const double *p, objects_contacts *found)
{
    vector n;
    /* r = (p - s) - a (a . (p - s)), gap = |r| - radius, n = r / |r| */
    for (int i = 0; i < 3; i++) n[i] = p[i] - line->s[i];
    const double length = objects_dot(line->a, n);
    for (int i = 0; i < 3; i++) n[i] -= length * line->a[i];
    const double size = sqrt(objects_dot(n, n));
    for (int i = 0; i < 3; i++) n[i] /= size;
    objects_note(found, name, line, size - radius, p, n);
}

/* Contacts with a cylinder: all corners, and the edges of which the closest point lies between the ends. */
static void cylinder(const objects_feature *line, double radius, objects_contacts *found)
{
    objects_feature crossing = *line;
    vector p, r;
    /* corners */
    crossing.kind = OBJECTS_EDGES;
    for (int k = 0; k < OBJECTS_CORNERS; k++) {
        objects_corner(k, found->half_lengths, p);
        beside(k, line, radius, p, found);
    }
    /* edges along axis j: closest point p_j = -(r_j - a_j a.r) / (1 - a_j^2), r from s to the edge's middle */
    for (int name = OBJECTS_CORNERS; name < OBJECTS_POINTS; name++) {
        const int j = edge_axis(name);
        const double below = 1.0 - line->a[j] * line->a[j];
        if (below < TINY) continue;
        edge_middle(name, found->half_lengths, p);
        for (int i = 0; i < 3; i++) r[i] = p[i] - line->s[i];
        crossing.edge = j;
        p[j] = -(r[j] - line->a[j] * objects_dot(line->a, r)) / below;
        if (fabs(p[j]) < found->half_lengths[j]) beside(name, &crossing, radius, p, found);
    }
}

void objects_find(const fingerfem_object *object, const double *half_lengths, double d, int plate, const double *centre,
                  const double *rotation, objects_contacts *found)
{
    vector place;
    objects_feature own = {.kind = OBJECTS_FACE};
    memcpy(found->half_lengths, half_lengths, sizeof found->half_lengths);
    found->plate = plate;
    /* where the object is, from the plate's centre, along the axes of space */
    for (int i = 0; i < 3; i++) place[i] = object->centre[i] + d * object->direction[i] - centre[i];
    if (object->shape == FINGERFEM_HULL) {
        hull_find(object, place, rotation, found);
        return;
    }
    /* its feature as the plate sees it, and the contacts by its shape */
    objects_turned_back(rotation, place, own.s);
    objects_turned_back(rotation, object->axis, own.a);
    own.kind = object->shape == FINGERFEM_PLANE ? OBJECTS_FACE : OBJECTS_LINE;
    if (object->shape == FINGERFEM_PLANE) before_face(&own, found);
    else if (object->shape == FINGERFEM_SPHERE) objects_note_point(found, OBJECTS_POINTS, own.s, object->radius);
    else cylinder(&own, object->radius, found);
}

double objects_feature_at(const fingerfem_object *object, double d, const double *centre, const double *rotation, const double *p,
                          objects_feature *feature, double *n)
{
    vector place;
    feature->kind = OBJECTS_FACE;
    for (int i = 0; i < 3; i++) place[i] = object->centre[i] + d * object->direction[i] - centre[i];
    if (object->shape == FINGERFEM_HULL) return hull_feature(object, place, rotation, p, feature, n);
    objects_turned_back(rotation, place, feature->s);
    objects_turned_back(rotation, object->axis, feature->a);
    /* r = p - s; plane: gap = a . r */
    for (int i = 0; i < 3; i++) n[i] = p[i] - feature->s[i];
    const double along = objects_dot(feature->a, n);
    if (object->shape == FINGERFEM_PLANE) {
        memcpy(n, feature->a, sizeof(vector));
        return along;
    }
    /* ball: gap = |r| - radius, n = r / |r|; cylinder: with r across its axis */
    feature->kind = object->shape == FINGERFEM_SPHERE ? OBJECTS_POINT : OBJECTS_LINE;
    for (int i = 0; i < 3 && feature->kind == OBJECTS_LINE; i++) n[i] -= along * feature->a[i];
    const double size = sqrt(objects_dot(n, n));
    for (int i = 0; i < 3; i++) n[i] = size > 0.0 ? n[i] / size : i == 0;
    return size - object->radius;
}

void objects_normal_change(const objects_feature *feature, double distance, const double *n, const double *v, double *found)
{
    /* a face: 0; a point: (v - n n . v) / distance; a line: the same without v's part along it */
    const double along = feature->kind == OBJECTS_LINE ? objects_dot(feature->a, v) : 0.0, part = objects_dot(n, v);
    for (int i = 0; i < 3; i++)
        found[i] = feature->kind == OBJECTS_FACE || !(distance > 0.0) ? 0.0 : (v[i] - along * feature->a[i] - part * n[i]) / distance;
}

/* Add how contact k slides, to the change dp of its point, and dn of its normal, which are without it: along the outline, and, on a side
 * between rims, along the axis. With these tangents t_i, which stay orthogonal to n,
 *
 *     (t_i . H t_j + n . dt_i/ds_j) ds_j = -t_i . dn,    dp += t_j ds_j,    dn += H t_j ds_j. */
static void slide(const objects_contacts *contacts, int k, double distance, double *dp, double *dn)
{
    const border_point *border = contacts->borders + k;
    const objects_feature *feature = contacts->features + k;
    const double *n = contacts->wrenches[k];
    const vector ways[2] = {{0.0, border->tangent[0], border->tangent[1]}, {1.0, 0.0, 0.0}};
    vector t[2], turned[2], moved = {0.0}, more;
    double system[4] = {0.0}, right[2] = {0.0}, ds[2] = {0.0};
    int count = 0;
    for (int way = 0; way < 2; way++) {
        if (way ? contacts->names[k] != OBJECTS_SIDE : !border->slides) continue;
        memcpy(t[count], ways[way], sizeof(vector));
        objects_normal_change(feature, distance, n, t[count], turned[count]);
        system[3 * count] = way ? 0.0 : objects_border_bend(border, n); /* on the diagonal */
        right[count] = -objects_dot(t[count], dn);
        count++;
    }
    for (int a = 0; a < count; a++)
        for (int b = 0; b < count; b++) system[2 * a + b] += objects_dot(t[a], turned[b]);
    const double det = system[0] * system[3] - system[1] * system[2];
    if (count == 1 && system[0] > 0.0) ds[0] = right[0] / system[0];
    if (count == 2 && det > 0.0) {
        ds[0] = (system[3] * right[0] - system[1] * right[1]) / det;
        ds[1] = (system[0] * right[1] - system[2] * right[0]) / det;
    }
    for (int a = 0; a < count; a++)
        for (int i = 0; i < 3; i++) moved[i] += t[a][i] * ds[a];
    objects_normal_change(feature, distance, n, moved, more);
    for (int i = 0; i < 3; i++) {
        dp[i] += moved[i];
        dn[i] += more[i];
    }
}

/* Changes at contact k, seen from the plate, as its feature's point s moves by ds and its direction a changes by da: dp
 * of the plate's point, and dr of the vector r along which the normal lies, n = r / |r|. */
static void changes(const objects_contacts *contacts, int k, const double *ds, const double *da, double *dp, double *dr)
{
    const objects_feature *feature = contacts->features + k;
    const double *s = feature->s, *a = feature->a, *p = contacts->points[k], *half = contacts->halves[k];
    const int name = contacts->names[k];
    vector r, moved;
    memset(dp, 0, sizeof(vector));
    switch (feature->kind) {
    case OBJECTS_FACE: memcpy(dr, da, sizeof(vector)); return;
    case OBJECTS_POINT:
        /* a vertex opposite a face moves the face's point along; r = p - s */
        for (int i = 0; i < 3; i++) {
            dp[i] = name >= OBJECTS_POINTS && fabs(s[i]) < half[i] ? ds[i] : 0.0;
            dr[i] = dp[i] - ds[i];
        }
        return;
    case OBJECTS_LINE:
        /* a corner p stays; r = (p - s) - a (a . (p - s)) */
        for (int i = 0; i < 3; i++) {
            r[i] = p[i] - s[i];
            moved[i] = -ds[i];
        }
        const double length = objects_dot(a, r), grows = objects_dot(da, r) + objects_dot(a, moved);
        for (int i = 0; i < 3; i++) dr[i] = moved[i] - length * da[i] - grows * a[i];
        return;
    case OBJECTS_EDGES: { /* u = -(r_j - a_j a.r) / (1 - a_j^2), r from s to the edge's middle; n is along a x e_j */
        const int j = feature->edge;
        const double below = 1.0 - a[j] * a[j];
        vector unit = {0.0}, along;
        for (int i = 0; i < 3; i++) r[i] = (i == j ? 0.0 : p[i]) - s[i];
        /* derivative of this quotient, u = -above / below */
        const double above = r[j] - a[j] * objects_dot(a, r);
        const double dabove = -ds[j] - da[j] * objects_dot(a, r) - a[j] * (objects_dot(da, r) - objects_dot(a, ds));
        dp[j] = -(dabove * below + above * 2.0 * a[j] * da[j]) / (below * below);
        /* r = +-a x e_j, on the side of the normal */
        unit[j] = 1.0;
        objects_cross(a, unit, along);
        const double sign = copysign(1.0, objects_dot(along, contacts->wrenches[k]));
        objects_cross(da, unit, dr);
        for (int i = 0; i < 3; i++) dr[i] *= sign;
    }
    }
}

/* Seen from a plate that moves by v and turns by t, the object's features move by ds = -v - t x s, da = -t x a. */
void objects_change_with(const fingerfem_object *object, const objects_contacts *contacts, int k, int m, double *dp,
                        double *dn)
{
    const objects_feature *feature = contacts->features + k;
    const double *n = contacts->wrenches[k], *a = feature->a;
    double size = fabs(contacts->gaps[k] + object->radius);
    vector unit = {0.0}, ds = {0.0}, da = {0.0};
    /* |r|: the distance from a point or a line, 1 for a face, |a x e_j| for edges */
    if (feature->kind == OBJECTS_FACE) size = 1.0;
    if (feature->kind == OBJECTS_EDGES) size = sqrt(1.0 - a[feature->edge] * a[feature->edge]);
    /* motion of the feature, with s as seen from the plate: features are noted as if it stood off by `bent` */
    unit[m % 3] = 1.0;
    if (m < 3) {
        ds[m] = -1.0;
    } else {
        vector s;
        for (int i = 0; i < 3; i++) s[i] = feature->s[i] + contacts->bent[k][i];
        objects_cross(s, unit, ds);
        objects_cross(feature->a, unit, da);
    }
    /* dn = (dr - n (n . dr)) / |r| */
    changes(contacts, k, ds, da, dp, dn);
    const double part = objects_dot(n, dn);
    for (int i = 0; i < 3; i++) dn[i] = size > 0.0 ? (dn[i] - part * n[i]) / size : 0.0;
    if (contacts->names[k] < 0) slide(contacts, k, size, dp, dn);
}

void objects_change(const fingerfem_object *object, const objects_contacts *contacts, int k,
                    double (*change)[FINGERFEM_WRENCH])
{
    const double *n = contacts->wrenches[k];
    vector dp, dn, one, two, p;
    /* wrench (n, p x n) of the point of the bent plate; column m: dn, and dp x n + p x dn */
    for (int i = 0; i < 3; i++) p[i] = contacts->points[k][i] + contacts->bent[k][i];
    for (int m = 0; m < FINGERFEM_WRENCH; m++) {
        objects_change_with(object, contacts, k, m, dp, dn);
        objects_cross(dp, n, one);
        objects_cross(p, dn, two);
        for (int i = 0; i < 3; i++) {
            change[i][m] = dn[i];
            change[3 + i][m] = one[i] + two[i];
        }
    }
}

double objects_distance(const fingerfem_object *object, double d, const double *place, double *normal)
{
    vector r;
    /* the point, seen from the object's place */
    for (int i = 0; i < 3; i++) r[i] = place[i] - object->centre[i] - d * object->direction[i];
    if (object->shape == FINGERFEM_HULL) return hull_distance(object, r, normal);
    const double along = objects_dot(object->axis, r);
    /* plane: gap = a . r */
    if (object->shape == FINGERFEM_PLANE) {
        memcpy(normal, object->axis, sizeof(vector));
        return along;
    }
    /* ball: gap = |r| - radius, n = r / |r|; cylinder: with r across its axis; capsule: with r from its axis' nearest point */
    const double half = object->half_length, part = object->shape == FINGERFEM_CYLINDER ? along : fmax(-half, fmin(half, along));
    for (int i = 0; i < 3; i++) r[i] -= part * object->axis[i];
    const double size = sqrt(objects_dot(r, r)), aside = size - object->radius, beyond = fabs(along) - half;
    for (int i = 0; i < 3; i++) normal[i] = size > 0.0 ? r[i] / size : -object->direction[i];
    if (object->shape != FINGERFEM_CYLINDER || half == 0.0 || beyond <= fmin(aside, 0.0)) return aside;
    /* cylinder with ends: from an end's plane, or from its rim, which is `aside` and `beyond` away */
    const double gap = aside > 0.0 ? sqrt(aside * aside + beyond * beyond) : beyond;
    const double radial = aside > 0.0 ? aside / gap : 0.0, axial = copysign(aside > 0.0 ? beyond / gap : 1.0, along);
    for (int i = 0; i < 3; i++) normal[i] = radial * normal[i] + axial * object->axis[i];
    return gap;
}

/* By Newton's method from far away: the distance of a convex body is convex in d, so that no step goes past the root.
 * Where the point is outside at `least`, and the gap grows with d, it stays outside from there on. */
double objects_reach(const fingerfem_object *object, const double *place, double margin, double least)
{
    double d = FAR;
    vector n;
    /* stop: the point is outside at `least`, and the gap grows with d */
    if (isfinite(least)) {
        const double gap = objects_distance(object, least, place, n) - margin;
        if (gap >= 0.0 && objects_dot(n, object->direction) < 0.0) return least;
    }
    /* Newton's method, d -= gap / (dgap/dd); a plane needs one step */
    for (int step = 0; step < MARCHES && d > least; step++) {
        const double gap = objects_distance(object, d, place, n) - margin, slope = -objects_dot(n, object->direction);
        if (gap > 0.0 && slope <= 0.0) return least; /* the object passes by */
        if (fabs(gap) < TOUCHED || (object->shape == FINGERFEM_PLANE && step)) return d;
        d -= gap / slope;
    }
    return least;
}

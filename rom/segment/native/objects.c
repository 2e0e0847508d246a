#include "objects.h"
#include <math.h>
#include <string.h>

#define TINY 1e-12 /* of a squared sine below which a line is along an edge, and corners alone count [-] */
#define EDGES 8    /* names below are corners */

typedef double vector[3];

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double *a, const double *b, double *out)
{
    const vector found = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    memcpy(out, found, sizeof found);
}

/* R^T v. */
static void turned_back(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[i] * v[0] + rotation[3 + i] * v[1] + rotation[6 + i] * v[2];
}

/* Note a contact at p with normal n; in place of that with the largest gap if there is no room. */
static void note(objects_contacts *all, int name, double gap, const double *p, const double *n)
{
    int at = all->count;
    if (at == FINGERFEM_MOST_CONTACTS) {
        at = 0;
        for (int k = 1; k < all->count; k++)
            if (all->gaps[k] > all->gaps[at]) at = k;
        if (all->gaps[at] <= gap) return;
    } else {
        all->count++;
    }
    all->names[at] = name;
    all->gaps[at] = gap;
    memcpy(all->points[at], p, sizeof(vector));
    memcpy(all->wrenches[at], n, sizeof(vector));
    cross(p, n, all->wrenches[at] + 3);
}

static void corner(int k, const double *half, double *p)
{
    for (int i = 0; i < 3; i++) p[i] = (k >> i & 1 ? 1.0 : -1.0) * half[i];
}

/* The axis that an edge is along. */
static int edge_axis(int name) { return (name - EDGES) / 4; }

/* The middle of an edge. */
static void edge_middle(int name, const double *half, double *p)
{
    const int j = edge_axis(name), k = (name - EDGES) % 4;
    corner((k & 1) << (j == 0) | (k >> 1) << (j == 2 ? 1 : 2), half, p);
    p[j] = 0.0;
}

/* A plane of normal a: the corners. */
static void plane(objects_contacts *found)
{
    for (int k = 0; k < EDGES; k++) {
        vector p;
        corner(k, found->half_lengths, p);
        note(found, k, dot(found->a, p) - dot(found->a, found->s), p, found->a);
    }
}

/* A sphere: the plate's point nearest to its centre; if that is inside the plate, out through the nearest face. */
static void sphere(double radius, objects_contacts *found)
{
    const double *half = found->half_lengths, *s = found->s;
    vector p, n;
    double square = 0.0;
    int nearest = 0;
    for (int i = 0; i < 3; i++) {
        p[i] = fabs(s[i]) < half[i] ? s[i] : copysign(half[i], s[i]);
        n[i] = p[i] - s[i];
        square += n[i] * n[i];
        if (half[i] - fabs(s[i]) < half[nearest] - fabs(s[nearest])) nearest = i;
    }
    double size = sqrt(square);
    if (size == 0.0) {
        size = -(half[nearest] - fabs(s[nearest]));
        n[nearest] = copysign(size, s[nearest]);
    }
    for (int i = 0; i < 3; i++) n[i] /= fabs(size);
    note(found, 0, size - radius, p, n);
}

/* A point p of the plate beside a cylinder's axis. */
static void beside(double radius, int name, const double *p, objects_contacts *found)
{
    vector n;
    for (int i = 0; i < 3; i++) n[i] = p[i] - found->s[i];
    const double length = dot(found->a, n);
    for (int i = 0; i < 3; i++) n[i] -= length * found->a[i];
    const double size = sqrt(dot(n, n));
    for (int i = 0; i < 3; i++) n[i] /= size;
    note(found, name, size - radius, p, n);
}

/* A cylinder along a: the corners, and the edges where they pass nearest between their ends. */
static void cylinder(double radius, objects_contacts *found)
{
    vector p, r;
    for (int k = 0; k < EDGES; k++) {
        corner(k, found->half_lengths, p);
        beside(radius, k, p, found);
    }
    for (int name = EDGES; name < EDGES + 12; name++) {
        const int j = edge_axis(name);
        const double below = 1.0 - found->a[j] * found->a[j];
        if (below < TINY) continue;
        edge_middle(name, found->half_lengths, p);
        for (int i = 0; i < 3; i++) r[i] = p[i] - found->s[i];
        p[j] = -(r[j] - found->a[j] * dot(found->a, r)) / below;
        if (fabs(p[j]) < found->half_lengths[j]) beside(radius, name, p, found);
    }
}

void objects_find(const fingerfem_object *object, const double *half_lengths, double d, const double *centre,
                  const double *rotation, objects_contacts *found)
{
    vector place;
    for (int i = 0; i < 3; i++) place[i] = object->centre[i] + d * object->direction[i] - centre[i];
    turned_back(rotation, place, found->s);
    turned_back(rotation, object->axis, found->a);
    memcpy(found->half_lengths, half_lengths, sizeof found->half_lengths);
    found->count = 0;
    if (object->shape == FINGERFEM_PLANE) plane(found);
    else if (object->shape == FINGERFEM_SPHERE) sphere(object->radius, found);
    else cylinder(object->radius, found);
}

/* Changes of the plate's point at a contact and of what the normal is along, from the object to that point, as the object
 * is seen to move by ds and its axis to turn by da. */
static void point_changes(const fingerfem_object *object, const objects_contacts *contacts, int k, const double *ds,
                          const double *da, double *dp, double *dr)
{
    const double *s = contacts->s, *a = contacts->a, *p = contacts->points[k], *half = contacts->half_lengths;
    memset(dp, 0, sizeof(vector));
    if (object->shape == FINGERFEM_SPHERE) {
        for (int i = 0; i < 3; i++) {
            dp[i] = fabs(s[i]) < half[i] ? ds[i] : 0.0;
            dr[i] = dp[i] - ds[i];
        }
        return;
    }
    vector r;
    if (contacts->names[k] >= EDGES) { /* u = -(r_j - a_j a.r) / (1 - a_j^2), r from s to the edge's middle */
        const int j = edge_axis(contacts->names[k]);
        const double below = 1.0 - a[j] * a[j];
        edge_middle(contacts->names[k], half, r);
        for (int i = 0; i < 3; i++) r[i] -= s[i];
        const double above = r[j] - a[j] * dot(a, r);
        const double dabove = -ds[j] - da[j] * dot(a, r) - a[j] * (dot(da, r) - dot(a, ds));
        dp[j] = -(dabove * below + above * 2.0 * a[j] * da[j]) / (below * below);
    }
    for (int i = 0; i < 3; i++) r[i] = p[i] - s[i];
    vector moved;
    for (int i = 0; i < 3; i++) moved[i] = dp[i] - ds[i];
    const double length = dot(a, r), grows = dot(da, r) + dot(a, moved);
    for (int i = 0; i < 3; i++) dr[i] = moved[i] - length * da[i] - grows * a[i];
}

void objects_change(const fingerfem_object *object, const objects_contacts *contacts, int k,
                    double (*change)[FINGERFEM_WRENCH])
{
    const double *n = contacts->wrenches[k], *p = contacts->points[k];
    for (int m = 0; m < FINGERFEM_WRENCH; m++) {
        /* By v, t, what is fixed to the object is seen to move by ds = -v - t x s, da = -t x a. */
        vector unit = {0.0}, ds = {0.0}, da = {0.0}, dp = {0.0}, dn, one, two;
        unit[m % 3] = 1.0;
        if (m < 3) {
            ds[m] = -1.0;
        } else {
            cross(contacts->s, unit, ds);
            cross(contacts->a, unit, da);
        }
        if (object->shape == FINGERFEM_PLANE) {
            memcpy(dn, da, sizeof dn);
        } else {
            const double size = fabs(contacts->gaps[k] + object->radius);
            point_changes(object, contacts, k, ds, da, dp, dn);
            const double part = dot(n, dn);
            for (int i = 0; i < 3; i++) dn[i] = size > 0.0 ? (dn[i] - part * n[i]) / size : 0.0;
        }
        cross(dp, n, one);
        cross(p, dn, two);
        for (int i = 0; i < 3; i++) {
            change[i][m] = dn[i];
            change[3 + i][m] = one[i] + two[i];
        }
    }
}

double objects_distance(const fingerfem_object *object, double d, const double *place)
{
    vector r;
    for (int i = 0; i < 3; i++) r[i] = place[i] - object->centre[i] - d * object->direction[i];
    const double along = dot(object->axis, r);
    if (object->shape == FINGERFEM_PLANE) return along;
    if (object->shape == FINGERFEM_CYLINDER)
        for (int i = 0; i < 3; i++) r[i] -= along * object->axis[i];
    return sqrt(dot(r, r)) - object->radius;
}

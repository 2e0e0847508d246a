#include "objects.h"
#include <math.h>
#include <string.h>

#define TINY 1e-12 /* of a squared sine below which a line is along an edge, and corners alone count [-] */

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

/* An object as the plate sees it: a point s and a direction a of it, and how both change as the plate moves: by v, t,
 * ds = -v - t x s, da = -t x a. */
typedef struct {
    vector s, a;
    vector ds[FINGERFEM_WRENCH], da[FINGERFEM_WRENCH];
} seen;

static void see(const fingerfem_object *object, double d, const double *centre, const double *rotation, seen *found)
{
    vector place;
    for (int i = 0; i < 3; i++) place[i] = object->centre[i] + d * object->direction[i] - centre[i];
    turned_back(rotation, place, found->s);
    turned_back(rotation, object->axis, found->a);
    memset(found->ds, 0, sizeof found->ds);
    memset(found->da, 0, sizeof found->da);
    for (int k = 0; k < 3; k++) {
        vector unit = {0.0};
        unit[k] = 1.0;
        found->ds[k][k] = -1.0;
        cross(found->s, unit, found->ds[3 + k]);
        cross(found->a, unit, found->da[3 + k]);
    }
}

/* Note a contact at p with normal n, and their changes by the six motions; in place of that with the largest gap if there
 * is no room. */
static void note(objects_contacts *all, int name, double gap, const double *p, const double *n, const vector *dp,
                 const vector *dn)
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
    memcpy(all->wrenches[at], n, sizeof(vector));
    cross(p, n, all->wrenches[at] + 3);
    for (int k = 0; k < FINGERFEM_WRENCH; k++) {
        vector one, two;
        cross(dp[k], n, one);
        cross(p, dn[k], two);
        for (int i = 0; i < 3; i++) {
            all->changes[at][i][k] = dn[k][i];
            all->changes[at][3 + i][k] = one[i] + two[i];
        }
    }
}

/* The normal along r, its gap over a radius, and its changes. */
static double along(const double *r, double radius, const vector *dr, double *n, vector *dn)
{
    const double size = sqrt(dot(r, r));
    for (int i = 0; i < 3; i++) n[i] = r[i] / size;
    for (int k = 0; k < FINGERFEM_WRENCH; k++) {
        const double part = dot(n, dr[k]);
        for (int i = 0; i < 3; i++) dn[k][i] = (dr[k][i] - part * n[i]) / size;
    }
    return size - radius;
}

static void corner(int k, const double *half, double *p)
{
    for (int i = 0; i < 3; i++) p[i] = (k >> i & 1 ? 1.0 : -1.0) * half[i];
}

/* A plane of normal a: the corners. */
static void plane(const seen *object, const double *half, objects_contacts *found)
{
    const vector still[FINGERFEM_WRENCH] = {{0.0}};
    for (int k = 0; k < 8; k++) {
        vector p;
        corner(k, half, p);
        note(found, k, dot(object->a, p) - dot(object->a, object->s), p, object->a, still, object->da);
    }
}

/* A sphere: the plate's point nearest to its centre. */
static void sphere(const seen *object, const double *half, double radius, objects_contacts *found)
{
    vector p, r, n, dp[FINGERFEM_WRENCH], dr[FINGERFEM_WRENCH], dn[FINGERFEM_WRENCH];
    for (int i = 0; i < 3; i++) {
        const int free = fabs(object->s[i]) < half[i];
        p[i] = free ? object->s[i] : copysign(half[i], object->s[i]);
        r[i] = p[i] - object->s[i];
        for (int k = 0; k < FINGERFEM_WRENCH; k++) {
            dp[k][i] = free ? object->ds[k][i] : 0.0;
            dr[k][i] = dp[k][i] - object->ds[k][i];
        }
    }
    if (dot(r, r) == 0.0) { /* the centre is inside the plate: it is out through the nearest face */
        int nearest = 0;
        for (int i = 1; i < 3; i++)
            if (half[i] - fabs(object->s[i]) < half[nearest] - fabs(object->s[nearest])) nearest = i;
        const double depth = half[nearest] - fabs(object->s[nearest]);
        memset(n, 0, sizeof n);
        memset(dn, 0, sizeof dn);
        n[nearest] = -copysign(1.0, object->s[nearest]);
        note(found, 0, -depth - radius, p, n, dp, dn);
        return;
    }
    const double gap = along(r, radius, dr, n, dn);
    note(found, 0, gap, p, n, dp, dn);
}

/* A point p of the plate that moves by dp, and a line: gap and normal of the cylinder around it. */
static void beside(const seen *object, double radius, int name, const double *p, const vector *dp,
                   objects_contacts *found)
{
    vector r, across, n, dacross[FINGERFEM_WRENCH], dn[FINGERFEM_WRENCH];
    const double *a = object->a;
    for (int i = 0; i < 3; i++) r[i] = p[i] - object->s[i];
    const double length = dot(a, r);
    for (int i = 0; i < 3; i++) across[i] = r[i] - length * a[i];
    for (int k = 0; k < FINGERFEM_WRENCH; k++) {
        vector dr;
        for (int i = 0; i < 3; i++) dr[i] = dp[k][i] - object->ds[k][i];
        const double grows = dot(object->da[k], r) + dot(a, dr);
        for (int i = 0; i < 3; i++) dacross[k][i] = dr[i] - length * object->da[k][i] - grows * a[i];
    }
    const double gap = along(across, radius, dacross, n, dn);
    note(found, name, gap, p, n, dp, dn);
}

/* Where the edge through p0 along axis j of the plate is nearest to a line, if that is between its ends. */
static void edge(const seen *object, const double *half, double radius, int j, int name, const double *p0,
                 objects_contacts *found)
{
    const double *a = object->a, aj = a[j], below = 1.0 - aj * aj;
    vector r, p, dp[FINGERFEM_WRENCH] = {{0.0}};
    for (int i = 0; i < 3; i++) r[i] = p0[i] - object->s[i];
    const double above = r[j] - aj * dot(a, r), u = -above / below;
    if (below < TINY || fabs(u) >= half[j]) return;
    memcpy(p, p0, sizeof p);
    p[j] = u;
    for (int k = 0; k < FINGERFEM_WRENCH; k++) {
        const double *ds = object->ds[k], *da = object->da[k];
        const double dabove = -ds[j] - da[j] * dot(a, r) - aj * (dot(da, r) - dot(a, ds));
        dp[k][j] = -(dabove * below + above * 2.0 * aj * da[j]) / (below * below);
    }
    beside(object, radius, name, p, dp, found);
}

/* A cylinder along a: the corners, and the edges where they pass nearest between their ends. */
static void cylinder(const seen *object, const double *half, double radius, objects_contacts *found)
{
    const vector still[FINGERFEM_WRENCH] = {{0.0}};
    for (int k = 0; k < 8; k++) {
        vector p;
        corner(k, half, p);
        beside(object, radius, k, p, still, found);
    }
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 4; k++) {
            vector p0;
            corner((k & 1) << (j == 0) | (k >> 1) << (j == 2 ? 1 : 2), half, p0);
            p0[j] = 0.0;
            edge(object, half, radius, j, 8 + 4 * j + k, p0, found);
        }
}

void objects_find(const fingerfem_object *object, const double *half_lengths, double d, const double *centre,
                  const double *rotation, objects_contacts *found)
{
    seen own;
    see(object, d, centre, rotation, &own);
    found->count = 0;
    if (object->shape == FINGERFEM_PLANE) plane(&own, half_lengths, found);
    else if (object->shape == FINGERFEM_SPHERE) sphere(&own, half_lengths, object->radius, found);
    else cylinder(&own, half_lengths, object->radius, found);
}

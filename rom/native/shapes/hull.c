/* Contacts of a rounded hull with a plate: corners of the plate with the closest features of the hull, vertices of the
 * hull, and pairs of edges. The hull stands along the axes of space. */
#include "hull.h"
#include <math.h>
#include <string.h>

#define ALIKE 1e-9 /* relative difference of distances at which a face goes before its own edge [-] */

#define PARALLEL 1e-6 /* sine between edges below which corners alone count [-] */
#define BESIDE 0.3   /* an edge of the plate counts if the normal's components out of its faces are at most this [-] */

typedef double vector[3];

static void minus(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

/* Whether a point lies in a triangle, seen along its normal; its border belongs to it. */
static int in_triangle(const fingerfem_object *object, const int32_t *triangle, const double *normal, const double *point)
{
    /* inside if ((b - a) x (x - a)) . n >= 0 for all edges a to b, counterclockwise */
    for (int k = 0; k < 3; k++) {
        const double *from = object->vertices + 3 * triangle[k], *to = object->vertices + 3 * triangle[(k + 1) % 3];
        vector side, arm, out;
        minus(to, from, side);
        minus(point, from, arm);
        objects_cross(side, arm, out);
        if (objects_dot(out, normal) < 0.0) return 0;
    }
    return 1;
}

/* Closest feature of the sharp hull to a point. Returns the distance, negative inside; n is the unit vector from the
 * feature to the point. */
static double nearest(const fingerfem_object *object, const double *point, objects_feature *feature, double *n)
{
    int face = 0;
    double highest = -INFINITY, least = INFINITY;
    vector arm;
    /* highest of the signed distances n . x - height; inside the hull, this is the answer */
    for (int k = 0; k < object->faces; k++) {
        const double height = objects_dot(object->normals + 3 * k, point) - object->heights[k];
        if (height > highest) highest = height, face = k;
    }
    /* vertices: |x - v| */
    feature->kind = OBJECTS_FACE;
    for (int k = 0; k < object->corners && highest > 0.0; k++) {
        minus(point, object->vertices + 3 * k, arm);
        const double size = sqrt(objects_dot(arm, arm));
        if (size >= least) continue;
        least = size;
        feature->kind = OBJECTS_POINT;
        memcpy(feature->s, object->vertices + 3 * k, sizeof(vector));
        for (int i = 0; i < 3; i++) n[i] = size > 0.0 ? arm[i] / size : object->normals[3 * face + i];
    }
    /* edges: distance from the line, if the foot lies between the ends */
    for (int k = 0; k < object->edges && highest > 0.0; k++) {
        const double *from = object->vertices + 3 * object->ends[2 * k], *a = object->along + 3 * k;
        minus(point, from, arm);
        const double share = objects_dot(arm, a);
        if (share <= 0.0 || share >= object->lengths[k]) continue;
        for (int i = 0; i < 3; i++) arm[i] -= share * a[i];
        const double size = sqrt(objects_dot(arm, arm));
        if (size >= least || size == 0.0) continue;
        least = size;
        feature->kind = OBJECTS_LINE;
        memcpy(feature->s, from, sizeof(vector));
        memcpy(feature->a, a, sizeof(vector));
        for (int i = 0; i < 3; i++) n[i] = arm[i] / size;
    }
    /* faces: n . x - height, if the foot lies in one of their triangles */
    for (int k = 0; k < object->triangles && highest > 0.0; k++) {
        const int own = object->triangle_faces[k];
        const double *normal = object->normals + 3 * own;
        const double height = objects_dot(normal, point) - object->heights[own];
        if (height < 0.0 || height > least * (1.0 + ALIKE)) continue;
        if (!in_triangle(object, object->triangle_corners + 3 * k, normal, point)) continue;
        least = height;
        feature->kind = OBJECTS_FACE;
        face = own;
    }
    /* face: its normal n, and s = height n */
    if (feature->kind == OBJECTS_FACE) {
        memcpy(n, object->normals + 3 * face, sizeof(vector));
        memcpy(feature->a, n, sizeof(vector));
        for (int i = 0; i < 3; i++) feature->s[i] = object->heights[face] * n[i];
    }
    return highest > 0.0 ? least : highest;
}

double hull_distance(const fingerfem_object *object, const double *point, double *normal)
{
    objects_feature feature;
    return nearest(object, point, &feature, normal) - object->radius;
}

/* A feature as the plate sees it: s <- R^T (s + place), a <- R^T a. */
static void seen(const double *place, const double *rotation, objects_feature *feature)
{
    vector s;
    for (int i = 0; i < 3; i++) s[i] = feature->s[i] + place[i];
    objects_turned_back(rotation, s, feature->s);
    memcpy(s, feature->a, sizeof s);
    objects_turned_back(rotation, s, feature->a);
}

double hull_feature(const fingerfem_object *object, const double *place, const double *rotation, const double *p, objects_feature *feature,
                    double *n)
{
    vector point, normal;
    for (int i = 0; i < 3; i++) point[i] = objects_dot(rotation + 3 * i, p) - place[i];
    const double distance = nearest(object, point, feature, normal);
    seen(place, rotation, feature);
    objects_turned_back(rotation, normal, n);
    return distance - object->radius;
}

/* Contact of an edge of the hull, seen from the plate, with the plate's edge along axis j on given sides, if their
 * closest points lie between the ends. `normal` is their common perpendicular, out of the hull. `between`: it lies
 * between the normals of the faces at both edges, so that the edges span a face of the Minkowski sum. */
static void across(const fingerfem_object *object, int edge, int j, const objects_feature *feature, const double *normal,
                   const double *sides, int between, objects_contacts *found)
{
    const double *half = found->half_lengths, *a = feature->a;
    vector p, r;
    /* middle of the plate's edge, and r from the begin of the hull's edge to it */
    for (int i = 0; i < 3; i++) p[i] = i == j ? 0.0 : sides[i] * half[i];
    minus(p, feature->s, r);
    /* closest points: at p_j on the plate's edge, at `share` on the hull's edge [m] */
    const double below = 1.0 - a[j] * a[j], along = objects_dot(a, r), height = objects_dot(normal, r);
    p[j] = -(r[j] - a[j] * along) / below;
    const double share = along + a[j] * p[j];
    if (fabs(p[j]) >= half[j] || share <= 0.0 || share >= object->lengths[edge]) return;
    /* stop: on the hull's other side; or, if `between`, deeper than its sides are distinguished */
    if (height < (between ? object->radius - objects_shallow(object, half) : 0.0)) return;
    /* a name of its own for every pair of edges */
    const int side = 2 * (sides[(j + 1) % 3] > 0.0) + (sides[(j + 2) % 3] > 0.0);
    const int name = OBJECTS_POINTS + object->corners + 12 * edge + 4 * j + side;
    objects_note(found, name, feature, height - object->radius, p, normal);
}

/* Contacts of an edge of the hull with the four edges of the plate along its axis j. Where the plate lies along a face
 * of the hull, their common perpendicular is that face's normal or a little beside it. */
static void crossing(const fingerfem_object *object, int edge, int j, const double *place, const double *rotation,
                     objects_contacts *found)
{
    objects_feature feature = {.kind = OBJECTS_EDGES, .edge = j};
    /* components of the plate's edge e along the normals of the faces at the hull's edge */
    const double *a = object->along + 3 * edge;
    const double e[3] = {rotation[j], rotation[3 + j], rotation[6 + j]};
    const double one = objects_dot(object->normals + 3 * object->sides[2 * edge], e);
    const double other = objects_dot(object->normals + 3 * object->sides[2 * edge + 1], e);
    vector n, normal, sides;
    /* common perpendicular a x e, out of the hull; parallel edges have none */
    objects_cross(a, e, n);
    const double sine = sqrt(objects_dot(n, n)), size = copysign(sine, one - other);
    if (sine < PARALLEL) return;
    for (int i = 0; i < 3; i++) n[i] /= size;
    /* normal and edge as the plate sees them */
    objects_turned_back(rotation, n, normal);
    memcpy(feature.s, object->vertices + 3 * object->ends[2 * edge], sizeof(vector));
    memcpy(feature.a, a, sizeof(vector));
    seen(place, rotation, &feature);
    /* the four edges; skip one where the normal points out of the plate by more than BESIDE */
    const int i = (j + 1) % 3, k = (j + 2) % 3;
    for (sides[i] = -1.0; sides[i] < 2.0; sides[i] += 2.0)
        for (sides[k] = -1.0; sides[k] < 2.0; sides[k] += 2.0) {
            if (sides[i] * normal[i] > BESIDE || sides[k] * normal[k] > BESIDE) continue;
            const int between = one * other < 0.0 && sides[i] * normal[i] < 0.0 && sides[k] * normal[k] < 0.0;
            across(object, edge, j, &feature, normal, sides, between, found);
        }
}

void hull_find(const fingerfem_object *object, const double *place, const double *rotation, objects_contacts *found)
{
    const double *half = found->half_lengths;
    /* corners of the plate, each with the closest feature of the hull */
    for (int k = 0; k < OBJECTS_CORNERS; k++) {
        objects_feature feature = {.kind = OBJECTS_FACE};
        vector p, n;
        objects_corner(k, half, p);
        const double gap = hull_feature(object, place, rotation, p, &feature, n);
        objects_note(found, k, &feature, gap, p, n);
    }
    /* vertices of the hull, unless the plate's closest point is a corner */
    for (int k = 0; k < object->corners; k++) {
        objects_feature feature = {.kind = OBJECTS_POINT};
        memcpy(feature.s, object->vertices + 3 * k, sizeof(vector));
        seen(place, rotation, &feature);
        int beyond = 0;
        for (int i = 0; i < 3; i++) beyond += fabs(feature.s[i]) >= half[i];
        if (beyond < 3) objects_note_point(found, OBJECTS_POINTS + k, feature.s, object->radius);
    }
    /* pairs of edges */
    for (int k = 0; k < object->edges; k++)
        for (int j = 0; j < 3; j++) crossing(object, k, j, place, rotation, found);
}

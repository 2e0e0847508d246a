/* A hull's faces, edges and vertices before the corners, edges and faces of a plate, distinguished in the hull's own frame. */
#include "hull.h"
#include <math.h>
#include <string.h>

#define ALIKE 1e-9 /* of a distance: a point before a face is not before its edge besides [-] */

#define PARALLEL 1e-6 /* sine between edges below which corners alone count [-] */
#define BESIDE 0.3   /* of a normal's component along a face of the plate whose edge it still is that of [-] */

typedef double vector[3];

static void minus(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

/* Whether a point lies in a triangle, seen along its normal; its border belongs to it. */
static int in_triangle(const fingerfem_object *object, const int32_t *triangle, const double *normal, const double *point)
{
    for (int k = 0; k < 3; k++) { /* counterclockwise */
        const double *from = object->vertices + 3 * triangle[k], *to = object->vertices + 3 * triangle[(k + 1) % 3];
        vector side, arm, out;
        minus(to, from, side);
        minus(point, from, arm);
        objects_cross(side, arm, out);
        if (objects_dot(out, normal) < 0.0) return 0;
    }
    return 1;
}

/* The feature of the sharp hull that is nearest to a point, and the distance, negative inside; n from it to the point. */
static double nearest(const fingerfem_object *object, const double *point, objects_feature *feature, double *n)
{
    int face = 0;
    double highest = -INFINITY, least = INFINITY;
    vector arm;
    for (int k = 0; k < object->faces; k++) {
        const double height = objects_dot(object->normals + 3 * k, point) - object->heights[k];
        if (height > highest) highest = height, face = k;
    }
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

/* A feature as the plate sees it. */
static void seen(const double *place, const double *rotation, objects_feature *feature)
{
    vector s;
    for (int i = 0; i < 3; i++) s[i] = feature->s[i] + place[i];
    objects_turned_back(rotation, s, feature->s);
    memcpy(s, feature->a, sizeof s);
    objects_turned_back(rotation, s, feature->a);
}

/* An edge of the hull, seen from the plate, and the edge of the plate along its axis j on given sides, whose common
 * perpendicular is `normal`, out of the hull; `between` says whether it lies between the faces' normals at both. */
static void across(const fingerfem_object *object, int edge, int j, const objects_feature *feature, const double *normal,
                   const double *sides, int between, objects_contacts *found)
{
    const double *half = found->half_lengths, *a = feature->a;
    vector p, r;
    for (int i = 0; i < 3; i++) p[i] = i == j ? 0.0 : sides[i] * half[i];
    minus(p, feature->s, r);
    const double below = 1.0 - a[j] * a[j], along = objects_dot(a, r), height = objects_dot(normal, r);
    p[j] = -(r[j] - a[j] * along) / below;
    const double share = along + a[j] * p[j];
    if (fabs(p[j]) >= half[j] || share <= 0.0 || share >= object->lengths[edge]) return;
    if (height < (between ? object->radius - objects_shallow(object, half) : 0.0)) return; /* on the hull's other side */
    const int side = 2 * (sides[(j + 1) % 3] > 0.0) + (sides[(j + 2) % 3] > 0.0);
    const int name = OBJECTS_POINTS + object->corners + 12 * edge + 4 * j + side;
    objects_note(found, name, feature, height - object->radius, p, normal);
}

/* An edge of the hull and the edges of the plate along its axis j that it may cross, where both are nearest between their
 * ends. Where the plate lies along a face, their common perpendicular is that face's normal or a little beside it. */
static void crossing(const fingerfem_object *object, int edge, int j, const double *place, const double *rotation,
                     objects_contacts *found)
{
    objects_feature feature = {.kind = OBJECTS_EDGES, .edge = j};
    const double *a = object->along + 3 * edge;
    const double e[3] = {rotation[j], rotation[3 + j], rotation[6 + j]};
    const double one = objects_dot(object->normals + 3 * object->sides[2 * edge], e);
    const double other = objects_dot(object->normals + 3 * object->sides[2 * edge + 1], e);
    vector n, normal, sides;
    objects_cross(a, e, n);
    const double sine = sqrt(objects_dot(n, n)), size = copysign(sine, one - other);
    if (sine < PARALLEL) return;
    for (int i = 0; i < 3; i++) n[i] /= size;
    objects_turned_back(rotation, n, normal);
    memcpy(feature.s, object->vertices + 3 * object->ends[2 * edge], sizeof(vector));
    memcpy(feature.a, a, sizeof(vector));
    seen(place, rotation, &feature);
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
    for (int k = 0; k < OBJECTS_CORNERS; k++) {
        objects_feature feature = {.kind = OBJECTS_FACE};
        vector p, point, n, normal;
        objects_corner(k, half, p);
        for (int i = 0; i < 3; i++) point[i] = objects_dot(rotation + 3 * i, p) - place[i];
        const double distance = nearest(object, point, &feature, n);
        seen(place, rotation, &feature);
        objects_turned_back(rotation, n, normal);
        objects_note(found, k, &feature, distance - object->radius, p, normal);
    }
    for (int k = 0; k < object->corners; k++) {
        objects_feature feature = {.kind = OBJECTS_POINT};
        memcpy(feature.s, object->vertices + 3 * k, sizeof(vector));
        seen(place, rotation, &feature);
        int beyond = 0;
        for (int i = 0; i < 3; i++) beyond += fabs(feature.s[i]) >= half[i];
        if (beyond < 3) objects_note_point(found, OBJECTS_POINTS + k, feature.s, object->radius);
    }
    for (int k = 0; k < object->edges; k++)
        for (int j = 0; j < 3; j++) crossing(object, k, j, place, rotation, found);
}

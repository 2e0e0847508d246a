/* A hull's faces, edges and vertices before the corners, edges and faces of a plate, told apart in the hull's own frame. */
#include "hull.h"
#include <math.h>
#include <string.h>

#define ALIKE 1e-9 /* of a distance: a point before a face is not before its edge besides [-] */

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

double hull_distance(const fingerfem_object *object, const double *point)
{
    objects_feature feature;
    vector n;
    return nearest(object, point, &feature, n) - object->radius;
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

/* An edge of the hull and that edge of the plate along its axis j which it may cross: the normals of the two faces at the
 * hull's edge, and of those at the plate's, hold the contact's normal between them; both are nearest between their ends. */
static void crossing(const fingerfem_object *object, int edge, int j, const double *place, const double *rotation,
                     objects_contacts *found)
{
    objects_feature feature = {OBJECTS_EDGES, {0.0}, {0.0}, j};
    const double *a = object->along + 3 * edge, *half = found->half_lengths;
    const double e[3] = {rotation[j], rotation[3 + j], rotation[6 + j]};
    const double one = objects_dot(object->normals + 3 * object->sides[2 * edge], e);
    const double other = objects_dot(object->normals + 3 * object->sides[2 * edge + 1], e);
    if (one * other >= 0.0) return;
    vector n, normal, p;
    objects_cross(a, e, n);
    const double size = copysign(sqrt(objects_dot(n, n)), one);
    for (int i = 0; i < 3; i++) n[i] /= size;
    memcpy(feature.s, object->vertices + 3 * object->ends[2 * edge], sizeof(vector));
    memcpy(feature.a, a, sizeof(vector));
    seen(place, rotation, &feature);
    objects_turned_back(rotation, n, normal);
    for (int i = 0; i < 3; i++) p[i] = i == j ? 0.0 : -copysign(half[i], normal[i]);
    vector r;
    minus(p, feature.s, r);
    const double below = 1.0 - feature.a[j] * feature.a[j], along = objects_dot(feature.a, r);
    p[j] = -(r[j] - feature.a[j] * along) / below;
    const double share = along + feature.a[j] * p[j];
    if (fabs(p[j]) >= half[j] || share <= 0.0 || share >= object->lengths[edge]) return;
    const double gap = objects_dot(normal, r) - object->radius;
    if (gap < -objects_shallow(object, half)) return; /* they pass each other on the hull's other side */
    const int name = OBJECTS_POINTS + object->corners + 12 * edge + 4 * j;
    const int sign = 2 * (p[(j + 1) % 3] > 0.0) + (p[(j + 2) % 3] > 0.0);
    objects_note(found, name + sign, &feature, gap, p, normal);
}

void hull_find(const fingerfem_object *object, const double *place, const double *rotation, objects_contacts *found)
{
    const double *half = found->half_lengths;
    for (int k = 0; k < OBJECTS_CORNERS; k++) {
        objects_feature feature = {OBJECTS_FACE, {0.0}, {0.0}};
        vector p, point, n, normal;
        objects_corner(k, half, p);
        for (int i = 0; i < 3; i++) point[i] = objects_dot(rotation + 3 * i, p) - place[i];
        const double distance = nearest(object, point, &feature, n);
        seen(place, rotation, &feature);
        objects_turned_back(rotation, n, normal);
        objects_note(found, k, &feature, distance - object->radius, p, normal);
    }
    for (int k = 0; k < object->corners; k++) {
        objects_feature feature = {OBJECTS_POINT, {0.0}, {0.0}};
        memcpy(feature.s, object->vertices + 3 * k, sizeof(vector));
        seen(place, rotation, &feature);
        int beyond = 0;
        for (int i = 0; i < 3; i++) beyond += fabs(feature.s[i]) >= half[i];
        if (beyond < 3) objects_note_point(found, OBJECTS_POINTS + k, feature.s, object->radius);
    }
    for (int k = 0; k < object->edges; k++)
        for (int j = 0; j < 3; j++) crossing(object, k, j, place, rotation, found);
}

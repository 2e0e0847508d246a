/* The list of contacts: room for new ones, and what is noted of each. */
#include "objects_contacts.h"
#include <math.h>
#include <string.h>

#define DEEP 0.2   /* of the radius: an object deeper in the free plate approaches it in steps [-] */

typedef double vector[3];

/* Index of a new contact: the next free one; without room that of the largest gap, or -1 if all gaps are smaller. */
static int room_for(objects_contacts *all, double gap)
{
    int at = 0;
    if (all->count < FINGERFEM_MOST_CONTACTS) return all->count++;
    /* no room: find the largest gap */
    for (int k = 1; k < all->count; k++)
        if (all->gaps[k] > all->gaps[at]) at = k;
    return all->gaps[at] > gap ? at : -1;
}

/* Write a contact of the present part and object at an index, with the wrench (n, p x n). */
static void put(objects_contacts *all, int at, int name, const objects_feature *feature, double gap, const double *p, const double *n)
{
    /* identity, and what only rubber has; see objects_note_rubber */
    all->plates[at] = all->plate;
    all->slices[at] = -1;
    all->domes[at] = all->lifts[at] = 0.0;
    all->shares[at] = 1.0;
    all->profiles[at] = (indentation_profile){.rise = 0.0};
    all->borders[at] = (border_point){.slides = 0};
    all->objects[at] = all->object;
    all->names[at] = name;
    all->features[at] = *feature;
    all->gaps[at] = gap;
    all->compliance[at] = OBJECTS_COMPLIANCE;
    /* point, normal, and wrench of a unit force */
    memcpy(all->halves[at], all->half_lengths, sizeof(vector));
    memset(all->bent[at], 0, sizeof(vector));
    memcpy(all->points[at], p, sizeof(vector));
    memcpy(all->wrenches[at], n, sizeof(vector));
    objects_cross(p, n, all->wrenches[at] + 3);
}

int objects_note(objects_contacts *all, int name, const objects_feature *feature, double gap, const double *p, const double *n)
{
    const int at = room_for(all, gap);
    if (at >= 0) put(all, at, name, feature, gap, p, n);
    return at;
}

int objects_note_rubber(objects_contacts *all, int name, double gap, const double *material, double compliance, double dome,
                        const indentation_profile *profile, const double *p, const double *n)
{
    const objects_feature none = {.kind = OBJECTS_FACE};
    const int at = room_for(all, gap);
    if (at < 0) return at;
    put(all, at, name, &none, gap, p, n);
    memcpy(all->material[at], material, sizeof(vector));
    all->slices[at] = all->slice;
    all->domes[at] = dome;
    all->profiles[at] = *profile;
    all->compliance[at] = compliance;
    return at;
}

void objects_copy(const objects_contacts *from, int j, objects_contacts *to, int k)
{
    to->features[k] = from->features[j];
    to->gaps[k] = from->gaps[j];
    memcpy(to->points[k], from->points[j], sizeof(vector));
    memcpy(to->wrenches[k], from->wrenches[j], sizeof from->wrenches[j]);
}

void objects_corner(int k, const double *half, double *p)
{
    for (int i = 0; i < 3; i++) p[i] = (k >> i & 1 ? 1.0 : -1.0) * half[i];
}

void objects_note_point(objects_contacts *all, int name, const double *s, double radius)
{
    const double *half = all->half_lengths;
    objects_feature point = {.kind = OBJECTS_POINT, .s = {s[0], s[1], s[2]}};
    vector p, n;
    int nearest = 0;
    /* closest point p of the plate, n = p - s, and the face nearest to s */
    for (int i = 0; i < 3; i++) {
        p[i] = fabs(s[i]) < half[i] ? s[i] : copysign(half[i], s[i]);
        n[i] = p[i] - s[i];
        if (half[i] - fabs(s[i]) < half[nearest] - fabs(s[nearest])) nearest = i;
    }
    /* gap = |n| - radius; if s is inside: out through that face, with a negative distance */
    double size = sqrt(objects_dot(n, n));
    for (int i = 0; i < 3 && size > 0.0; i++) n[i] /= size;
    if (size == 0.0) {
        size = fabs(s[nearest]) - half[nearest];
        n[nearest] = -copysign(1.0, s[nearest]);
    }
    objects_note(all, name, &point, size - radius, p, n);
}

double objects_shallow(const fingerfem_object *object, const double *half_lengths)
{
    if (object->shape == FINGERFEM_PLANE) return INFINITY;
    if (object->shape == FINGERFEM_HULL) return fmin(half_lengths[0], fmin(half_lengths[1], half_lengths[2]));
    return DEEP * object->radius;
}

#include <math.h>
#include "contact.h"

#define MARCHES 60    /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */

static void locate(placed *at)
{
    map_rotation(at->pose, at->rotation);
    for (int i = 0; i < 3; i++) {
        at->centre[i] = 0.0;
        for (int j = 0; j < 3; j++) at->centre[i] -= at->rotation[3 * i + j] * at->pose[j];
    }
}

void placed_under(const contracted_map *map, const double *wrench, double d, placed *at)
{
    const fingerfem_segment *segment = map->touching->segment;
    double by_wrench[W * FINGERFEM_POSE];
    map_pose(segment, map->contracted, wrench, map->products, at->pose, by_wrench);
    for (int k = 0; k < W; k++)
        map_motion(at->pose, by_wrench + FINGERFEM_POSE * k, W, k, &at->compliance[0][0]);
    locate(at);
    objects_find(map->touching->object, segment->half_lengths, d, at->centre, at->rotation, &at->contacts);
}

/* The plate without a wrench: where it is, and its motion by the tensions. */
void placed_free(const contracted_map *map, placed *at)
{
    const int t = map->touching->segment->tensions;
    double by_tensions[MAP_MOST_TENSIONS * FINGERFEM_POSE];
    map_free(map->touching->segment, map->contracted, at->pose, by_tensions);
    for (int k = 0; k < t; k++)
        map_motion(at->pose, by_tensions + FINGERFEM_POSE * k, MAP_MOST_TENSIONS, k, &at->by_tensions[0][0]);
    locate(at);
}

/* The plate's motion by the tensions, at the wrench that `place` was asked for last. */
void placed_by_tensions(const contracted_map *map, placed *at)
{
    const fingerfem_segment *segment = map->touching->segment;
    const int stride = FINGERFEM_POSE * segment->groups;
    for (int k = 0; k < segment->tensions; k++) {
        map_eight sum = {0.0};
        for (int g = 0; g < segment->groups; g++)
            sum += map->products[FINGERFEM_POSE * g] * map_load(map->contracted + stride * (1 + k) + FINGERFEM_POSE * g);
        double change[FINGERFEM_POSE];
        map_store(change, sum);
        map_motion(at->pose, change, MAP_MOST_TENSIONS, k, &at->by_tensions[0][0]);
    }
}

/* The direction in which d moves the object, seen from the plate. */
void placed_leaving(const contracted_map *map, const placed *at, double *found)
{
    const double *e = map->touching->object->direction, *r = at->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * e[0] + r[3 + i] * e[1] + r[6 + i] * e[2];
}

int placed_nearest(const objects_contacts *contacts)
{
    int least = 0;
    for (int k = 1; k < contacts->count; k++)
        if (contacts->gaps[k] < contacts->gaps[least]) least = k;
    return least;
}

/* The largest d at which the object touches the plate where it is; -infinity if it passes by. By Newton's method from far
 * away: the distance of convex bodies is convex in d, so that it never goes too far. */
double placed_touch_distance(const contracted_map *map, placed *at)
{
    const fingerfem_object *object = map->touching->object;
    double e[3], d = 1.0;
    placed_leaving(map, at, e);
    for (int step = 0; step < MARCHES; step++) {
        objects_find(object, map->touching->segment->half_lengths, d, at->centre, at->rotation, &at->contacts);
        const int k = placed_nearest(&at->contacts);
        const double *n = at->contacts.wrenches[k], gap = at->contacts.gaps[k];
        const double slope = -(n[0] * e[0] + n[1] * e[1] + n[2] * e[2]);
        if (fabs(gap) < TOUCHED) return d;
        if (gap > 0.0 && slope <= 0.0) return -INFINITY;
        d -= gap / slope;
    }
    return -INFINITY;
}

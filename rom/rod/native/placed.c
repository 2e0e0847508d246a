#include <math.h>
#include "contact.h"

#define MARCHES 60    /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */
#define NEAR 1e-4     /* gap that may close as the plate is bent, by some um [m] */

/* How far the point of contact k is off, (3), where the corners of its plate are. */
static void point_off(const fingerfem_segment *segment, const double *corners, const objects_contacts *contacts, int k,
                      double *off)
{
    if (contacts->names[k] < OBJECTS_CORNERS) memcpy(off, corners + 3 * contacts->names[k], 3 * sizeof *off);
    else tensions_bent(segment, corners, contacts->points[k], off);
}

/* Contact k of an object at d with a plate that is no box: its point is off, as if the plate stood so far away. A round
 * object that is near is seen from there. */
static void bend(const contact_problem *problem, double d, int plate, int k, placed *at)
{
    objects_contacts *contacts = &at->contacts;
    const fingerfem_segment *segment = problem->touching->chain->segments[plate];
    const chain_plate *own = at->chain.plates + plate;
    double place[3], *off = contacts->bent[k], *wrench = contacts->wrenches[k];
    point_off(segment, problem->map->corners[plate], contacts, k, off);
    int j = 0;
    objects_contacts seen = {.count = 0};
    if (contacts->features[k].kind != OBJECTS_FACE && contacts->gaps[k] < NEAR) {
        for (int i = 0; i < 3; i++) place[i] = own->centre[i] + objects_dot(own->rotation + 3 * i, off);
        objects_find(problem->touching->object, segment->half_lengths, d, plate, place, own->rotation, &seen);
    }
    while (j < seen.count && seen.names[j] != contacts->names[k]) j++;
    if (j < seen.count) objects_copy(&seen, j, contacts, k);
    else contacts->gaps[k] += objects_dot(off, wrench);
    for (int i = 0; i < 3; i++) place[i] = contacts->points[k][i] + off[i];
    objects_cross(place, wrench, wrench + 3);
}

/* The contacts of an object at d with one plate, a box but for what tensions bend it. */
static void find(const contact_problem *problem, double d, int plate, placed *at)
{
    const chain_plate *own = at->chain.plates + plate;
    const fingerfem_segment *segment = problem->touching->chain->segments[plate];
    objects_find(problem->touching->object, segment->half_lengths, d, plate, own->centre, own->rotation, &at->contacts);
    for (int k = 0; k < at->contacts.count && segment->corner_monomials; k++)
        if (at->contacts.plates[k] == plate) bend(problem, d, plate, k, at);
}

void placed_under(const contact_problem *problem, const double *wrench, double d, placed *at)
{
    chain_under(problem->map, wrench, &at->chain);
    at->contacts.count = 0;
    for (int plate = 0; plate < problem->touching->chain->plates; plate++) find(problem, d, plate, at);
}

void placed_leaving(const contact_problem *problem, const chain_plate *plate, double *found)
{
    const double *e = problem->touching->object->direction, *r = plate->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * e[0] + r[3 + i] * e[1] + r[6 + i] * e[2];
}

int placed_nearest(const objects_contacts *contacts)
{
    int least = 0;
    for (int k = 1; k < contacts->count; k++)
        if (contacts->gaps[k] < contacts->gaps[least]) least = k;
    return least;
}

void placed_bend(const contact_problem *problem, const objects_contacts *contacts, int k, double *found)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const int plate = contacts->plates[k];
    const fingerfem_segment *segment = chain->segments[plate];
    memset(found, 0, (size_t)(3 * chain->tensions) * sizeof *found);
    for (int j = 0; j < segment->tensions; j++) {
        double corners[FINGERFEM_CORNERS];
        tensions_corners(segment, problem->map->rods[plate].monomials + segment->monomials * (1 + j), corners);
        point_off(segment, corners, contacts, k, found + 3 * chain->own[chain->tensions * plate + j]);
    }
}

/* Of one plate, by Newton's method from far away: the distance of convex bodies is convex in d, so that it never goes too
 * far. */
static double touch_distance(const contact_problem *problem, int plate, placed *at)
{
    double e[3], d = 1.0;
    placed_leaving(problem, at->chain.plates + plate, e);
    for (int step = 0; step < MARCHES; step++) {
        at->contacts.count = 0;
        find(problem, d, plate, at);
        const int k = placed_nearest(&at->contacts);
        const double *n = at->contacts.wrenches[k], gap = at->contacts.gaps[k];
        const double slope = -(n[0] * e[0] + n[1] * e[1] + n[2] * e[2]);
        if (fabs(gap) < TOUCHED) return d;
        if (gap > 0.0 && slope <= 0.0) return -INFINITY;
        d -= gap / slope;
    }
    return -INFINITY;
}

double placed_touch_distance(const contact_problem *problem, placed *at)
{
    const int plates = problem->touching->chain->plates;
    int first = 0;
    double farthest = -INFINITY;
    for (int plate = 0; plate < plates; plate++) {
        const double d = touch_distance(problem, plate, at);
        if (d > farthest) farthest = d, first = plate;
    }
    if (plates > 1 && isfinite(farthest)) touch_distance(problem, first, at);
    return farthest;
}

int fingerfem_contacts(const fingerfem_touching *touching, const double *tensions, double d, const double *centres,
                       const double *rotations, double *memory, int32_t *plates, int32_t *names, double *gaps, double *points,
                       double *normals, double *point_changes, double *normal_changes)
{
    const fingerfem_chain *chain = touching->chain;
    chain_rods map;
    const contact_problem problem = {touching, &map, W * chain->plates};
    placed at = {.contacts.count = 0};
    double held[TENSIONS_MOST];
    tensions_all_clamped(chain->segments[0], tensions, held);
    chain_set_tensions(chain, held, memory, &map);
    for (int plate = 0; plate < chain->plates; plate++) {
        memcpy(at.chain.plates[plate].centre, centres + 3 * plate, 3 * sizeof *centres);
        memcpy(at.chain.plates[plate].rotation, rotations + 9 * plate, 9 * sizeof *rotations);
        find(&problem, d, plate, &at);
    }
    for (int k = 0; k < at.contacts.count; k++) {
        plates[k] = at.contacts.plates[k];
        names[k] = at.contacts.names[k];
        gaps[k] = at.contacts.gaps[k];
        for (int i = 0; i < 3; i++) points[3 * k + i] = at.contacts.points[k][i] + at.contacts.bent[k][i];
        memcpy(normals + 3 * k, at.contacts.wrenches[k], 3 * sizeof *normals);
        for (int m = 0; m < W; m++) {
            double dp[3], dn[3];
            objects_change_with(touching->object, &at.contacts, k, m, dp, dn);
            for (int i = 0; i < 3; i++) {
                point_changes[(3 * k + i) * W + m] = dp[i];
                normal_changes[(3 * k + i) * W + m] = dn[i];
            }
        }
    }
    return at.contacts.count;
}

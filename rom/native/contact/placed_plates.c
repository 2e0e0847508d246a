/* Contacts of plates with objects: prisms about an outline, or boxes, which tensions bend; and where an object touches them first. */
#include <math.h>
#include "contact.h"
#include "plate_around.h"
#include "slices.h"

#define MARCHES 60    /* Newton steps towards the touch distance */
#define TOUCHED 1e-12 /* gap that counts as closed [m] */
#define NEAR 1e-4     /* gap below which a contact is found again where its plate is bent, by some um [m] */

/* Displacement, (3), of the point of contact k from a box, by the displacements of the plate's corners, (8, 3). */
static void point_off(const fingerfem_segment *segment, const double *corners, const objects_contacts *contacts, int k,
                      double *off)
{
    if (contacts->names[k] < OBJECTS_CORNERS) memcpy(off, corners + 3 * contacts->names[k], 3 * sizeof *off);
    else tensions_bent(segment, corners, contacts->points[k], off);
}

/* Correct contact k of object j at d for the bending of its plate, which displaces its point by `off`: the gap grows by
 * n . off. A near contact that is not with a face is found again, with the whole plate displaced so. */
static void bend(const contact_problem *problem, int j, double d, int plate, int k, placed *at)
{
    objects_contacts *contacts = &at->contacts, seen;
    const fingerfem_segment *segment = problem->touching->chain->segments[plate];
    const chain_body *own = at->chain.bodies + chain_plate_of(problem->map, plate);
    double place[3], *off = contacts->bent[k], *wrench = contacts->wrenches[k];
    point_off(segment, problem->map->corners[plate], contacts, k, off);
    int same = 0;
    seen.count = 0; /* zeros in all of it would take longer than the rest */
    /* contacts of the plate displaced by R off */
    if (contacts->features[k].kind != OBJECTS_FACE && contacts->gaps[k] < NEAR) {
        for (int i = 0; i < 3; i++) place[i] = own->centre[i] + objects_dot(own->rotation + 3 * i, off);
        objects_find(contact_object(problem, j), segment->half_lengths, d, plate, place, own->rotation, &seen);
    }
    /* the same corner or edge among these replaces the contact; without it the gap grows by n . off */
    while (same < seen.count && seen.names[same] != contacts->names[k]) same++;
    if (same < seen.count) objects_copy(&seen, same, contacts, k);
    else contacts->gaps[k] += objects_dot(off, wrench);
    /* moment of a unit force: (p + off) x n */
    for (int i = 0; i < 3; i++) place[i] = contacts->points[k][i] + off[i];
    objects_cross(place, wrench, wrench + 3);
}

void placed_plate(const contact_problem *problem, int j, double d, int plate, placed *at)
{
    const chain_body *own = at->chain.bodies + chain_plate_of(problem->map, plate);
    const fingerfem_segment *segment = problem->touching->chain->segments[plate];
    objects_contacts *contacts = &at->contacts;
    contacts->object = j;
    if (segment->vertices) {
        plate_find_around(segment, contact_object(problem, j), d, plate, own, contacts);
        return;
    }
    objects_find(contact_object(problem, j), segment->half_lengths, d, plate, own->centre, own->rotation, contacts);
    for (int k = 0; k < contacts->count && segment->corner_monomials; k++)
        if (contacts->plates[k] == plate && contacts->objects[k] == j) bend(problem, j, d, plate, k, at);
}

int placed_nearest(const objects_contacts *contacts)
{
    int least = 0;
    for (int k = 1; k < contacts->count; k++)
        if (contacts->gaps[k] < contacts->gaps[least]) least = k;
    return least;
}

void placed_bend(const contact_problem *problem, const placed *at, int k, double *found)
{
    const objects_contacts *contacts = &at->contacts;
    const fingerfem_chain *chain = problem->touching->chain;
    const int plate = contacts->plates[k];
    memset(found, 0, (size_t)(3 * chain->tensions) * sizeof *found);
    /* a slice of rubber */
    if (plate >= FINGERFEM_MOST_PLATES) {
        slices_bend(problem->map, placed_slice_of(at, k), &at->chain, contacts->names[k], contacts->material[k], found);
        return;
    }
    const fingerfem_segment *segment = chain->segments[plate];
    if (segment->vertices) return; /* nothing bends a prism */
    /* a plate: displacement of the point by the change of its corners with every tension */
    for (int j = 0; j < segment->tensions; j++) {
        double corners[FINGERFEM_CORNERS];
        tensions_corners(segment, rod_monomials(problem->map->rods + plate, 0) + segment->monomials * (1 + j), corners);
        point_off(segment, corners, contacts, k, found + 3 * chain->own[chain->tensions * plate + j]);
    }
}

/* The largest d at which object j touches one plate, by Newton's method from d = 1 m: the gap of convex bodies is
 * convex in d, so that no step passes the root. -infinity if the object passes by. */
static double touch_distance(const contact_problem *problem, int j, int plate, placed *at)
{
    double e[3], d = 1.0;
    placed_leaving(problem, j, at->chain.bodies + chain_plate_of(problem->map, plate), e);
    for (int step = 0; step < MARCHES; step++) {
        at->contacts.count = 0;
        placed_plate(problem, j, d, plate, at);
        /* least gap, and its slope dg/dd = -n . e */
        const int k = placed_nearest(&at->contacts);
        const double *n = at->contacts.wrenches[k], gap = at->contacts.gaps[k];
        const double slope = -(n[0] * e[0] + n[1] * e[1] + n[2] * e[2]);
        /* stop: the object touches, or passes by; else d -= g / (dg/dd) */
        if (fabs(gap) < TOUCHED) return d;
        if (gap > 0.0 && slope <= 0.0) return -INFINITY;
        d -= gap / slope;
    }
    return -INFINITY;
}

double placed_touch_distance(const contact_problem *problem, int j, placed *at)
{
    const int plates = problem->touching->chain->plates;
    int first = 0;
    double farthest = -INFINITY;
    /* largest d of all plates */
    for (int plate = 0; plate < plates; plate++) {
        const double d = touch_distance(problem, j, plate, at);
        if (d > farthest) farthest = d, first = plate;
    }
    /* contacts of the plate that is touched first */
    if (plates > 1 && isfinite(farthest)) touch_distance(problem, j, first, at);
    return farthest;
}

#include <math.h>
#include "contact.h"

#define MARCHES 60    /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */

/* The contacts of an object at d with one plate. */
static void find(const contact_problem *problem, double d, int plate, placed *at)
{
    const chain_plate *own = at->chain.plates + plate;
    const fingerfem_chain *chain = problem->touching->chain;
    objects_find(problem->touching->object, chain->segments[plate]->half_lengths, d, plate, own->centre, own->rotation,
                 &at->contacts);
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

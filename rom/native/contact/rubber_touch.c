/* Where an object touches the surface of the free finger first. */
#include <math.h>
#include "rubber.h"
#include "slices.h"

#define STEPS 40      /* towards the touch distance */
#define TOUCHED 1e-12 /* [m] */
#define BULGED 0.01   /* of half the side: error of a face between its edges, besides the bulge of a bent beam [-] */
#define RIDGED 0.2    /* of the height of a ridge over a tendon: its error [-] */
#define BETWEEN 0.3   /* of half the side: how far the surface may be from its nearest sampled point [-] */
#define BULGING 0.2   /* likewise from the nearest edge, along the normal of a face, as faces bulge [-] */
#define ALIKE 1e-9    /* touch distances that differ by less are of one point [m] */
#define NEARER 1.2    /* times the margin of the sampled points: slices with larger gaps are skipped [-] */
#define FEW 8  /* stride between the sections of one pass */
#define FACE 8 /* points per face, from edge to edge, at which the distance of a round object is sampled */
#define AROUND 16 /* points around an outline, at least, likewise of any object */

static const int around[EDGES + 1] = {0, 1, 3, 2, 0}; /* corners of a section, from edge to edge */

/* Corners of a section in order around it, the first one again at the end: face k lies between corners k and k + 1. */
static void section_at(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    double own[EDGES][3];
    rubber_between(segment, points, place, own);
    for (int k = 0; k <= EDGES; k++) memcpy(corners[k], own[around[k]], sizeof own[0]);
}

/* Number of sampled points around a section: per face of a box, or per part of an outline. A plane touches a box at a corner. */
static int samples(const fingerfem_segment *segment, const fingerfem_object *object)
{
    if (segment->vertices) return border_period(segment) * (border_period(segment) < AROUND ? AROUND / border_period(segment) : 1);
    return EDGES * (object->shape == FINGERFEM_PLANE ? 1 : FACE);
}

/* Sampled point k of `count` around a section, from its corners in order. */
static void sample(const fingerfem_segment *segment, double (*corners)[3], int k, int count, double *place)
{
    if (segment->vertices) {
        /* bilinear between the corners */
        const border_point own = border_at(segment, (double)border_period(segment) * k / count);
        const double b = own.at[0] / segment->half_lengths[1], c = own.at[1] / segment->half_lengths[2];
        const double weights[EDGES] = {0.25 * (1.0 - b) * (1.0 - c), 0.25 * (1.0 - b) * (1.0 + c), 0.25 * (1.0 + b) * (1.0 + c), 0.25 * (1.0 + b) * (1.0 - c)};
        rubber_point_of(weights, corners[0], place);
        return;
    }
    /* a share of the way from one corner to the next */
    const int edge = k * EDGES / count;
    const double share = (double)(k * EDGES - edge * count) / count;
    for (int i = 0; i < 3; i++) place[i] = corners[edge][i] + share * (corners[edge + 1][i] - corners[edge][i]);
}

/* Note a point of space as the one touched first, in a plate's frame, with the wrench (n, p x n) of a unit force. */
static void note(const chain_body *plate, const double *place, const double *normal, touched_point *first)
{
    for (int i = 0; i < 3; i++) {
        double arm[3];
        for (int j = 0; j < 3; j++) arm[j] = place[j] - plate->centre[j];
        first->p[i] = plate->rotation[i] * arm[0] + plate->rotation[3 + i] * arm[1] + plate->rotation[6 + i] * arm[2];
        first->wrench[i] = plate->rotation[i] * normal[0] + plate->rotation[3 + i] * normal[1] + plate->rotation[6 + i] * normal[2];
    }
    objects_cross(first->p, first->wrench, first->wrench + 3);
    memset(first->bends, 0, sizeof first->bends);
    first->plate = plate;
}

/* Bound of the surface's distance from its sampled points, before object j [m]. */
static double margin_of(const contact_problem *problem, int j)
{
    const int flat = contact_object(problem, j)->shape == FINGERFEM_PLANE && !problem->touching->chain->segments[0]->vertices;
    return (flat ? BULGING : BETWEEN) * rubber_half(problem->touching->chain);
}

/* Whether all points of a section stay farther from the object than a margin, at d and at all larger ones: the distance
 * from a convex body is convex, so it is nowhere below its tangent at the section's middle. */
static int passes(const fingerfem_object *object, double (*corners)[3], double margin, double d)
{
    double centre[3] = {0.0}, normal[3], least = INFINITY;
    for (int k = 0; k < EDGES; k++)
        for (int i = 0; i < 3; i++) centre[i] += corners[k][i] / EDGES;
    /* lower bound of the gap: min_k g(c) + n . (x_k - c) over the corners; it grows with d if n . e <= 0 */
    const double gap = objects_distance(object, d, centre, normal) - objects_dot(normal, centre);
    for (int k = 0; k < EDGES; k++) least = fmin(least, gap + objects_dot(normal, corners[k]));
    return least > margin && objects_dot(normal, object->direction) <= 0.0;
}

/* Upper bound of the touch distance of the free rubber: the largest d at which the object is within the margin of a
 * sampled point; or `least` if that is larger. */
static double upper_bound(const contact_problem *problem, int number, const chain_state *free, double least)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const fingerfem_object *object = contact_object(problem, number);
    const double margin = margin_of(problem, number);
    double corners[EDGES + 1][3], place[3], farthest = least;
    for (int q = 0; q < chain->plates; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        const chain_body *plate = free->bodies + q;
        const int count = samples(segment, object);
        if (!segment->knots) continue;
        /* corners of all knots in space */
        double *points = rubber_points(problem->map->rods + q, &plate->end, 1);
        rubber_in_space(plate->centre, plate->rotation, EDGES * segment->knots, points);
        for (int begin = 0; begin < FEW; begin++) /* every FEW-th section: then most others are skipped */
            for (int n = segment->places - 2 - begin; n > 0; n -= FEW) { /* without those at clamp and plate */
                section_at(segment, points, n, corners);
                /* raise the bound to the largest d of this section's points, unless the whole section is farther */
                if (isfinite(farthest) && passes(object, corners, margin, farthest)) continue;
                for (int k = 0; k < count; k++) {
                    sample(segment, corners, k, count, place);
                    farthest = objects_reach(object, place, margin, farthest);
                }
            }
    }
    return farthest;
}

double rubber_off(const contact_problem *problem, const placed *at, int k)
{
    const fingerfem_segment *segment = problem->touching->chain->segments[placed_slice_of(at, k)->segment];
    const int name = at->contacts.names[k], face = name < SLICE_FACES ? -1 : name % OUTLINE_CORNERS; /* across y, then across z; negative of an edge */
    const rubber_slice *slice = placed_slice_of(at, k);
    if (slices_outlined(slice)) return problem->touching->chain->surface_error + BULGED * segment->half_lengths[1];
    /* coordinate zeta along the face, and height of the ridge on it; an edge has zeta = 1 */
    const double across = face < 0 ? 1.0 : at->contacts.material[k][face < 2 ? 2 : 1];
    const double ridge = face < 0 ? 0.0 : slice->ridges[face / 2][face % 2];
    /* error of the surface: e_0 + (0.01 h + 0.2 ridge) (1 - zeta^2), h half the side [m] */
    return problem->touching->chain->surface_error + (BULGED * segment->half_lengths[1] + RIDGED * ridge) * (1.0 - across * across);
}

/* By Newton's method from an upper bound: the gap of every slice is convex in d, so that no step goes below its root.
 * The next d is the largest of all slices' steps. */
double rubber_reach(const contact_problem *problem, int j, placed *free, double least, touched_point *first)
{
    const double *direction = contact_object(problem, j)->direction;
    double d = upper_bound(problem, j, &free->chain, least), seen[3];
    for (int step = 0; step < STEPS && d > least; step++) {
        const objects_contacts *contacts = &free->contacts;
        double next = -INFINITY;
        int touched = -1;
        /* slices of the free finger near the object at d */
        free->contacts.count = free->slices = 0;
        placed_slices(problem, j, 1, SLICE_FLAT, d, NEARER * margin_of(problem, j), free);
        /* Newton step of every contact, d - g / (dg/dd) with dg/dd = -n . e; the largest one leads */
        for (int k = 0; k < contacts->count; k++) {
            objects_turned_back(placed_slice_of(free, k)->rotation, direction, seen);
            const double slope = -objects_dot(contacts->wrenches[k], seen), own = d - contacts->gaps[k] / slope;
            if (slope > 0.0 && own > next) next = own, touched = k;
        }
        if (touched < 0 || next <= least + ALIKE) return least; /* it passes by, or touches a plate's edge that the rubber has too */
        if (fabs(d - next) > TOUCHED && step < STEPS - 1) { /* upwards, too: rounding, and faces that bulge */
            d = next;
            continue;
        }
        /* converged: the touched point and its normal in space, their error, and the motion by the tensions */
        const rubber_slice *slice = placed_slice_of(free, touched);
        double x[3], normal[3];
        placed_point(free, touched, x, normal);
        note(free->chain.bodies + slice->segment, x, normal, first);
        first->off = rubber_off(problem, free, touched);
        rubber_moves(problem->map, &free->chain, slice, contacts->material[touched], first->bends);
        return d;
    }
    return least;
}

double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *loads, double *memory)
{
    const fingerfem_chain *chain = touching->chain;
    double held[TENSIONS_MOST], d = point[chain->tensions], least = INFINITY;
    chain_rods map;
    placed at;
    const contact_problem problem = {touching, &map, {0.0}, NULL, 1.0};
    if (d == INFINITY) return INFINITY;
    d = fmax(touching->objects[0]->nearest, fmin(touching->objects[0]->farthest, d));
    /* bodies under the loads, and the contacts of all slices with the object */
    chain_placed(chain, point, loads, memory, held, &map, &at.chain);
    at.contacts.count = at.slices = 0;
    placed_slices(&problem, 0, 0, SLICE_FLAT, d, INFINITY, &at);
    /* least gap, without the slices next to plates */
    for (int k = 0; k < at.contacts.count; k++) {
        const rubber_slice *slice = placed_slice_of(&at, k);
        const int place = slices_place(&map, slice->segment, slice->number);
        if (place < chain->segments[slice->segment]->places - 2 && (place || !slice->segment)) least = fmin(least, at.contacts.gaps[k]);
    }
    return least;
}

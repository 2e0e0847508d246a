/* Slices of rubber between neighbouring cross-sections: which ones an object may touch, and where they are. */
#include "slices.h"
#include <math.h>
#include "rubber.h"

#define BULGING 1.13 /* half the side of a square that contains a bulging section, over that of the section [-] */
#define NEAR_END 0.6 /* (distance from an end / half the side)^2 where a ridge has half its height [-] */
#define SLENDER 3.0 /* phi / (side / length)^2 = 2 (1 + nu) / k of a square section [-] */

int slices_place(const chain_rods *map, int segment, int number)
{
    /* slices are numbered after all plates, segment by segment */
    int first = FINGERFEM_MOST_PLATES;
    for (int q = 0; q < segment; q++) first += map->chain->segments[q]->places;
    return number >= first && number < first + map->chain->segments[segment]->places ? number - first : -1;
}

void slices_section(const chain_rods *map, const chain_state *state, int q, int element, double *place, double *rotation)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    /* distal section of an element */
    if (element < segment->elements) {
        chain_section(map, state, q, element, place, rotation);
        return;
    }
    /* the clamp: front of the plate before, or the origin for the first segment */
    const chain_body *before = q ? state->bodies + chain_plate_of(map, q - 1) : NULL;
    memcpy(rotation, before ? before->rotation : upright, sizeof upright);
    for (int i = 0; i < 3; i++)
        place[i] = before ? before->centre[i] + before->rotation[3 * i] * map->chain->segments[q - 1]->half_lengths[0] : 0.0;
}

/* A gap that no point of an element between two sections is below, with places and rotations: sections are within a square of half the side `across`
 * about the axis. The distance from a convex body is nowhere below its tangent at the middle of the chord. */
static double least_gap(const fingerfem_object *object, double d, double across, double (*places)[3], double (*rotations)[9])
{
    double middle[3], n[3], chord[3], square = 0.0, turned = 0.0, bent = 0.0, wide = 0.0;
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * (places[0][i] + places[1][i]);
        chord[i] = places[0][i] - places[1][i];
        square += chord[i] * chord[i];
    }
    const double gap = objects_distance(object, d, middle, n), length = sqrt(square);
    for (int i = 0; i < 9; i++) turned += (rotations[0][i] - rotations[1][i]) * (rotations[0][i] - rotations[1][i]);
    for (int end = 0; end < 2; end++) {
        const double *R = rotations[end];
        double off = 0.0;
        /* how far the section's axis is off the chord's direction; and how far the section reaches along n */
        for (int i = 0; i < 3; i++) off += (length * R[3 * i] - chord[i]) * (length * R[3 * i] - chord[i]);
        bent += sqrt(off);
        wide = fmax(wide, fabs(n[0] * R[1] + n[1] * R[4] + n[2] * R[7]) + fabs(n[0] * R[2] + n[1] * R[5] + n[2] * R[8]));
    }
    /* the axis is off the chord by less than a quarter of `bent`; a section between turns from the nearer end by at most half the angle between both
     * ends, which is sqrt(turned / 2), and 3/4 of those to the chord; a turn lets it reach farther by sqrt(2) times as much */
    const double axis = 0.5 * fabs(objects_dot(n, chord)) + 0.25 * bent;
    return gap - axis - across * (wide + 0.6 * sqrt(turned) + 1.1 * bent / length);
}

int slices_near(const chain_rods *map, const chain_state *state, int q, const fingerfem_object *object, double d, double near,
                unsigned char *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    /* half the side of a square that contains a bulging section [m] */
    const double across = BULGING * fmax(1.0, segment->begins) * fmax(segment->half_lengths[1], segment->half_lengths[2]);
    double places[2][3], rotations[2][9];
    int any = 0;
    slices_section(map, state, q, 0, places[0], rotations[0]);
    for (int e = 0; e < segment->elements; e++) {
        slices_section(map, state, q, e + 1, places[1], rotations[1]);
        any |= found[e] = least_gap(object, d, across, places, rotations) < near;
        memcpy(places[0], places[1], sizeof places[0]);
        memcpy(rotations[0], rotations[1], sizeof rotations[0]);
    }
    return any;
}

const double *slices_corners(const chain_rods *map, const chain_state *state, int q, int free, const unsigned char *near)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    double *points = map->rods[q].work, *own = points + OUTLINE_KNOT * (segment->knots - 1), place[3], rotation[9];
    int from = segment->knots, to = 0;
    /* last knot: the plate's back, a flat box */
    slices_section(map, state, q, 0, place, rotation);
    rubber_flat(segment, 1.0, -segment->half_lengths[0], place, rotation, own);
    /* knots of which sections at the ends of near slices are made: `from` to `to` - 1 */
    for (int n = 0; n < segment->places - 1; n++) {
        if (!near[segment->place_elements[n]]) continue;
        from = from < segment->first[n] ? from : segment->first[n];
        to = segment->first[n + 1] + segment->near;
    }
    /* those of all elements, from the plate to the clamp, brought from their distal sections to space */
    for (int e = 0; e < segment->elements; e++) {
        own -= OUTLINE_KNOT * rubber_knots(segment, e);
        const int begin = (int)(own - points) / OUTLINE_KNOT, count = rubber_knots(segment, e);
        const int first = from > begin ? from - begin : 0, last = to < begin + count ? to - begin : count;
        if (first >= last) continue;
        slices_section(map, state, q, e, place, rotation);
        rubber_corners(map->rods + q, e, free, first, last, own);
        rubber_in_space(place, rotation, OUTLINE_CORNERS * (last - first), own + OUTLINE_KNOT * first);
    }
    /* first knot: the clamped section, a flat box */
    slices_section(map, state, q, segment->elements, place, rotation);
    rubber_flat(segment, segment->begins, 0.0, place, rotation, points);
    return points;
}

/* A bound by convexity: the distance from a convex body is nowhere below its tangent at the slice's middle. */
double slices_least_gap(const rubber_section *begin, const rubber_section *end, const fingerfem_object *object, double d)
{
    double centre[3] = {0.0}, normal[3], least = INFINITY;
    /* mean c of all corners */
    for (int k = 0; k < OUTLINE_CORNERS; k++)
        for (int i = 0; i < 3; i++) centre[i] += (begin->corners[k][i] + end->corners[k][i]) / (2 * OUTLINE_CORNERS);
    /* min over the corners x of the tangent plane g(c) + n . (x - c), and faces beyond them */
    const double gap = objects_distance(object, d, centre, normal) - objects_dot(normal, centre);
    for (int k = 0; k < OUTLINE_CORNERS; k++)
        least = fmin(least, gap + fmin(objects_dot(normal, begin->corners[k]), objects_dot(normal, end->corners[k])));
    return least - fmax(begin->beyond, end->beyond);
}

/* Length of a segment's rubber at rest, from its clamp to its plate's back [m]. */
static double rubber_length(const fingerfem_segment *segment)
{
    double found = -segment->half_lengths[0];
    for (int e = 0; e < segment->elements; e++) found += segment->element_lengths[e];
    return found;
}

void slices_make(const chain_rods *map, const chain_state *state, int q, const rubber_section *begin, const rubber_section *end, int place,
                 rubber_slice *found)
{
    const fingerfem_segment *segment = map->chain->segments[q];
    double axes[3][3], rotation[9];
    memcpy(found->bulges[0], begin->bulges, sizeof found->bulges[0]);
    memcpy(found->bulges[1], end->bulges, sizeof found->bulges[1]);
    /* corners in the order of bits (end, y, z), and along every coordinate the mean of both ends, and half their difference */
    for (int k = 0; k < SLICE_TERMS; k++) memcpy(found->shape[k], (k & 1 ? end : begin)->corners[(k & 2) | k >> 2], sizeof found->shape[k]);
    for (int bit = 1; bit < SLICE_TERMS; bit *= 2)
        for (int k = 0; k < SLICE_TERMS; k++)
            for (int i = 0; i < 3 && !(k & bit); i++) {
                const double from = found->shape[k][i], to = found->shape[k | bit][i];
                found->shape[k][i] = 0.5 * (from + to);
                found->shape[k | bit][i] = 0.5 * (to - from);
            }
    /* mean of the corners, and mean edges along x, y and z */
    memcpy(found->centre, found->shape[0], sizeof found->centre);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) axes[j][i] = 2.0 * found->shape[1 << j][i];
    /* height of ridges here: factor a^2 / (a^2 + NEAR_END), a = distance from the nearer end / half the side */
    const double share = fmin(place + 0.5, segment->places - 1.5 - place) / (segment->places - 1);
    const double away = share * rubber_length(segment) / segment->half_lengths[1];
    found->raised = away * away / (away * away + NEAR_END);
    for (int face = 0; face < OUTLINE_CORNERS; face++)
        found->ridges[face / 2][face % 2] = found->raised * slices_ridge(map->rods + q, segment->place_elements[place], face / 2, face % 2);
    /* frame by Gram-Schmidt: x along the slice, y across x, z = x cross y */
    found->thickness = sqrt(objects_dot(axes[0], axes[0]));
    slices_unit(axes[0]);
    const double along = objects_dot(axes[0], axes[1]);
    for (int i = 0; i < 3; i++) axes[1][i] -= along * axes[0][i];
    slices_unit(axes[1]);
    objects_cross(axes[0], axes[1], axes[2]);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) found->rotation[3 * i + j] = axes[j][i];
    /* identity: segment, element, and number among all slices */
    found->of = segment;
    found->segment = q;
    found->element = segment->place_elements[place];
    found->number = place + FINGERFEM_MOST_PLATES;
    for (int k = 0; k < q; k++) found->number += map->chain->segments[k]->places;
    /* its element as a beam: length l, nu / l, sides a of squares that bend as the section, phi, E I = E a^4 / 12 */
    found->share = segment->place_shares[place];
    found->length = segment->element_lengths[found->element];
    found->modulus = segment->element_moduli[found->element];
    found->root = sqrt(found->modulus);
    found->bulging = segment->poisson / found->length;
    const double size = segment->begins + (1.0 - segment->begins) * (place + 0.5) / (segment->places - 1);
    const double sides[2] = {segment->depths[0] * size, segment->depths[1] * size};
    found->slender = SLENDER * (sides[0] / found->length) * (sides[1] / found->length);
    for (int i = 0; i < 2; i++) {
        const double square = sides[i] * sides[i], bending = found->modulus * segment->young_modulus * square * square / 12.0;
        found->flexibility[i] = found->length * found->length * found->length / bending;
    }
    /* centres of the sections where its element begins and ends */
    for (int k = 0; k < SLICE_ENDS; k++) {
        double centre[3];
        slices_section(map, state, q, found->element + k, centre, rotation);
        for (int i = 0; i < 3; i++) centre[i] -= found->centre[i];
        objects_turned_back(found->rotation, centre, found->ends[k]);
    }
}

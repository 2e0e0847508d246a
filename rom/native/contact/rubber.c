/* The surface of the rubber: corners of its knots, and cross-sections between them. */
#include "rubber.h"
#include <math.h>

void rubber_in_space(const double *centre, const double *rotation, int count, double *points)
{
    for (double *p = points; p < points + 3 * count; p += 3) {
        const double seen[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
            p[i] = centre[i] + rotation[3 * i] * seen[0] + rotation[3 * i + 1] * seen[1] + rotation[3 * i + 2] * seen[2];
    }
}

int rubber_knots(const fingerfem_segment *segment, int element) { return rubber_outline(segment, element)->knots; }

double rubber_half(const fingerfem_chain *chain)
{
    double found = 0.0;
    for (int k = 0; k < chain->plates; k++)
        found = fmax(found, fmax(1.0, chain->segments[k]->begins) * fmax(chain->segments[k]->half_lengths[1], chain->segments[k]->half_lengths[2]));
    return found;
}

void rubber_flat(const fingerfem_segment *segment, double size, double along, const double *place, const double *rotation,
                 double *corners)
{
    const double y = size * segment->half_lengths[1], z = size * segment->half_lengths[2];
    for (int edge = 0; edge < EDGES; edge++) {
        const double corner[3] = {along, edge & 2 ? y : -y, edge & 1 ? z : -z};
        memcpy(corners + 3 * edge, corner, sizeof corner);
    }
    rubber_in_space(place, rotation, EDGES, corners);
}

const double *rubber_contracted(const rod_state *rod, int element)
{
    double *own = rod->outlines + rod->outlines_stride * rod_set_of(rod, element);
    if (own[0] == 0.0) outline_contract(rubber_outline(rod->segment, element), rod_monomials(rod, element), own + ROD_OUTLINED);
    own[0] = 1.0;
    return own + ROD_OUTLINED;
}

void rubber_shape(const rod_state *rod, int element, const double *monomials, double *corners)
{
    const fingerfem_outline *outline = rubber_outline(rod->segment, element);
    double *products = corners + outline->numbers, *changes = products + outline->products;
    if (monomials != rod_monomials(rod, element)) outline_contract(outline, monomials, changes);
    const double *contracted = monomials == rod_monomials(rod, element) ? rubber_contracted(rod, element) : changes;
    outline_under(outline, contracted, rod->elements[element].wrench, 0, outline->numbers, products, corners);
}

void rubber_corners(const rod_state *rod, int element, int free, int first, int last, double *corners)
{
    const fingerfem_outline *outline = rubber_outline(rod->segment, element);
    double *own = rod->work + OUTLINE_KNOT * rod->segment->knots;
    const int from = OUTLINE_KNOT * first, to = OUTLINE_KNOT * last;
    if (free && !rod->masses) outline_free(outline, rod_monomials(rod, element), own);
    else outline_under(outline, rubber_contracted(rod, element), rod->elements[element].wrench, from, to, own + outline->numbers, own);
    memcpy(corners + from, own + from, (size_t)(to - from) * sizeof *own);
}

double *rubber_points(const rod_state *rod, const rod_end *clamp, int free)
{
    static const double origin[3] = {0.0}, upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const fingerfem_segment *segment = rod->segment;
    /* backwards from the last knot, the plate's face, over the knots of all elements, to the clamp's section */
    double *points = rod->work, *own = points + OUTLINE_KNOT * (segment->knots - 1);
    rubber_flat(segment, 1.0, -segment->half_lengths[0], origin, upright, own);
    for (int k = 0; k < segment->elements; k++) {
        own -= OUTLINE_KNOT * rubber_knots(segment, k);
        rubber_corners(rod, k, free, 0, rubber_knots(segment, k), own);
        rubber_in_space(rod->elements[k].place, rod->elements[k].rotation, EDGES * rubber_knots(segment, k), own); /* here the plate's */
    }
    rubber_flat(segment, segment->begins, 0.0, clamp->place, clamp->rotation, points);
    return points;
}

void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3])
{
    const double *weights = segment->between + segment->near * place, *from = points + OUTLINE_KNOT * segment->first[place];
    double *flat = corners[0];
    memset(flat, 0, OUTLINE_KNOT * sizeof *flat);
    /* corners of the section: sum_k w_k (corners of knot k) */
    for (int k = 0; k < segment->near; k++, from += OUTLINE_KNOT)
        for (int j = 0; j < OUTLINE_KNOT; j++) flat[j] += weights[k] * from[j];
}

int rubber_element_of(const fingerfem_segment *segment, int knot, int *number)
{
    int from = segment->knots - 1, k = 0;
    *number = 0;
    if (knot == from) return -1;
    for (; k < segment->elements; k++) {
        from -= rubber_outline(segment, k)->knots;
        *number = knot - from;
        if (*number >= 0) break;
    }
    return k;
}

void rubber_point_of(const double *weights, const double *corners, double *found)
{
    for (int i = 0; i < 3; i++) {
        found[i] = 0.0;
        for (int edge = 0; edge < EDGES; edge++) found[i] += weights[edge] * corners[3 * edge + i];
    }
}

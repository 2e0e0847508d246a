/* The surface of a finger as sections that are drawn. */
#include "rubber.h"
#include "slices.h"

/* Corners of a segment's plate, bent by its tensions, (8, 3): x, then y, then z, each - and +, the last one fastest. */
static void plate_corners(const fingerfem_segment *segment, const double *bent, const chain_body *plate, double *corners)
{
    /* p_i = +-half_i, and what the tensions move it by; `own` counts corners with x fastest */
    for (int k = 0; k < FINGERFEM_CORNERS / 3; k++) {
        const int signs[3] = {k >> 2 & 1, k >> 1 & 1, k & 1}, own = signs[0] + 2 * signs[1] + 4 * signs[2];
        double seen[3];
        for (int i = 0; i < 3; i++)
            seen[i] = (signs[i] ? 1.0 : -1.0) * segment->half_lengths[i] + (segment->corner_monomials ? bent[3 * own + i] : 0.0);
        memcpy(corners + 3 * k, seen, sizeof seen);
    }
    rubber_in_space(plate->centre, plate->rotation, FINGERFEM_CORNERS / 3, corners);
}

int fingerfem_chain_sections(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                             double *corners)
{
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    unsigned char all[FINGERFEM_MOST_ELEMENTS];
    /* all elements count as near; every segment must have an outline */
    memset(all, 1, sizeof all);
    for (int k = 0; k < chain->plates; k++)
        if (!chain->segments[k]->knots) return 0;
    chain_placed(chain, tensions, loads, memory, held, &map, &state);
    for (int k = 0; k < chain->plates; k++) {
        const fingerfem_segment *segment = chain->segments[k];
        /* sections at all places but the last */
        const double *points = slices_corners(&map, &state, k, 0, all);
        for (int place = 0; place < segment->places - 1; place++, corners += OUTLINE_KNOT)
            rubber_between(segment, points, place, (double(*)[3])corners);
        /* in place of the last one: the plate's back, then its front */
        plate_corners(segment, map.corners[k], state.bodies + chain_plate_of(&map, k), corners);
        corners += FINGERFEM_CORNERS;
    }
    return 1;
}

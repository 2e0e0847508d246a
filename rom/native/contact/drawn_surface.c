/* The surface of the rubber: as boxes, and as sections that are drawn. */
#include <math.h>
#include "rubber.h"
#include "slices.h"

/* Corners of the section at a share of a segment's rubber, from 0 at its begin to 1 at its plate. */
static void section_at(const fingerfem_segment *segment, const double *points, double share, double (*corners)[3])
{
    /* place as a real number: `first` and a remainder */
    const int last = segment->places - 1;
    const double place = share * last;
    const int first = place < last ? (int)place : last - 1;
    double next[EDGES][3];
    /* linear between the neighbouring places */
    rubber_between(segment, points, first, corners);
    rubber_between(segment, points, first + 1, next);
    for (int edge = 0; edge < EDGES; edge++)
        for (int i = 0; i < 3; i++) corners[edge][i] += (place - first) * (next[edge][i] - corners[edge][i]);
}

/* Make a vector's length 1; returns it. */
static double unit(double *vector)
{
    const double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    for (int i = 0; i < 3; i++) vector[i] /= length;
    return length;
}

int fingerfem_rubber_boxes(const fingerfem_segment *segment, const double *inputs, const double *begins, const double *centre,
                           const double *rotation, int count, double *memory, double *centres, double *halves, double *axes)
{
    double sections[2][EDGES][3], held[TENSIONS_MOST];
    rod_state rod;
    rod_end clamp;
    if (!segment->knots) return 0;
    /* rod at clamped tensions under the wrench */
    tensions_all_clamped(segment, inputs, held);
    rod_set_tensions(segment, held, memory, memory + rod_memory(segment, 0), &rod);
    rod_contract(&rod);
    rod_under(&rod, (rod_part){0, segment->elements}, inputs + segment->tensions, &clamp);
    /* corners of all knots in space; the first section is the given one */
    double *points = rubber_points(&rod, &clamp, 0);
    rubber_in_space(centre, rotation, EDGES * segment->knots, points);
    memcpy(points, begins, OUTLINE_KNOT * sizeof *points);
    section_at(segment, points, 0.0, sections[0]);
    /* box k, between sections k and k + 1 */
    for (int k = 0; k < count; k++) {
        const double(*before)[3] = sections[k % 2], (*after)[3] = sections[(k + 1) % 2];
        double x[3], y[3], depth[3], along = 0.0;
        section_at(segment, points, (k + 1.0) / count, sections[(k + 1) % 2]);
        /* centre, x from centre to centre, and the mean edges along y and z */
        for (int i = 0; i < 3; i++) {
            double both[EDGES];
            for (int edge = 0; edge < EDGES; edge++) both[edge] = 0.5 * (before[edge][i] + after[edge][i]);
            centres[3 * k + i] = 0.25 * (both[0] + both[1] + both[2] + both[3]);
            x[i] = 0.25 * (after[0][i] + after[1][i] + after[2][i] + after[3][i]) - 0.25 * (before[0][i] + before[1][i] + before[2][i] + before[3][i]);
            y[i] = 0.5 * (both[2] + both[3] - both[0] - both[1]);
            depth[i] = 0.5 * (both[1] + both[3] - both[0] - both[2]);
        }
        /* half lengths, and axes by Gram-Schmidt: y across x, z = x cross y */
        halves[3 * k] = 0.5 * unit(x);
        for (int i = 0; i < 3; i++) along += x[i] * y[i];
        for (int i = 0; i < 3; i++) y[i] -= along * x[i];
        halves[3 * k + 1] = 0.5 * unit(y);
        const double z[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
        halves[3 * k + 2] = 0.5 * fabs(depth[0] * z[0] + depth[1] * z[1] + depth[2] * z[2]);
        /* axes are columns */
        for (int i = 0; i < 3; i++) {
            axes[9 * k + 3 * i] = x[i];
            axes[9 * k + 3 * i + 1] = y[i];
            axes[9 * k + 3 * i + 2] = z[i];
        }
    }
    return 1;
}

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

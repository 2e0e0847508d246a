/* The surface of the rubber: as boxes, and as sections that are drawn. */
#include <math.h>
#include "rubber.h"

/* Corners of a section: number 0 is where the rubber begins, then come its stations, then the plate's back. */
static void section(const fingerfem_segment *segment, const double *points, const double *begins, int number, const double *centre,
                    const double *rotation, double (*corners)[3])
{
    if (number == 0) {
        memcpy(corners, begins, 3 * EDGES * sizeof *begins);
        return;
    }
    for (int edge = 0; edge < EDGES; edge++) {
        const double *half = segment->half_lengths;
        double seen[3] = {-half[0], edge & 2 ? half[1] : -half[1], edge & 1 ? half[2] : -half[2]};
        for (int i = 0; i < 3 && number <= segment->stations; i++) seen[i] = points[3 * (EDGES * (number - 1) + edge) + i];
        for (int i = 0; i < 3; i++)
            corners[edge][i] = centre[i] + rotation[3 * i] * seen[0] + rotation[3 * i + 1] * seen[1] + rotation[3 * i + 2] * seen[2];
    }
}

/* Corners of the section at a share of the way over all of them. */
static void section_at(const fingerfem_segment *segment, const double *points, const double *begins, double share,
                       const double *centre, const double *rotation, double (*corners)[3])
{
    const int last = segment->stations + 1;
    const double place = share * last;
    const int first = place < last ? (int)place : last - 1;
    double next[EDGES][3];
    section(segment, points, begins, first, centre, rotation, corners);
    section(segment, points, begins, first + 1, centre, rotation, next);
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
    double *points = memory + segment->skin_terms;
    double sections[2][EDGES][3];
    if (!segment->skin_terms) return 0;
    rubber_points(segment, inputs, memory, points);
    section_at(segment, points, begins, 0.0, centre, rotation, sections[0]);
    for (int k = 0; k < count; k++) {
        const double(*before)[3] = sections[k % 2], (*after)[3] = sections[(k + 1) % 2];
        double x[3], y[3], depth[3], along = 0.0;
        section_at(segment, points, begins, (k + 1.0) / count, centre, rotation, sections[(k + 1) % 2]);
        for (int i = 0; i < 3; i++) {
            double both[EDGES];
            for (int edge = 0; edge < EDGES; edge++) both[edge] = 0.5 * (before[edge][i] + after[edge][i]);
            centres[3 * k + i] = 0.25 * (both[0] + both[1] + both[2] + both[3]);
            x[i] = 0.25 * (after[0][i] + after[1][i] + after[2][i] + after[3][i]) - 0.25 * (before[0][i] + before[1][i] + before[2][i] + before[3][i]);
            y[i] = 0.5 * (both[2] + both[3] - both[0] - both[1]);
            depth[i] = 0.5 * (both[1] + both[3] - both[0] - both[2]);
        }
        halves[3 * k] = 0.5 * unit(x);
        for (int i = 0; i < 3; i++) along += x[i] * y[i];
        for (int i = 0; i < 3; i++) y[i] -= along * x[i];
        halves[3 * k + 1] = 0.5 * unit(y);
        const double z[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
        halves[3 * k + 2] = 0.5 * fabs(depth[0] * z[0] + depth[1] * z[1] + depth[2] * z[2]);
        for (int i = 0; i < 3; i++) {
            axes[9 * k + 3 * i] = x[i];
            axes[9 * k + 3 * i + 1] = y[i];
            axes[9 * k + 3 * i + 2] = z[i];
        }
    }
    return 1;
}

/* Where a point that a plate sees is in space. */
static void in_space(const chain_plate *plate, const double *seen, double *place)
{
    for (int i = 0; i < 3; i++) {
        const double *row = plate->rotation + 3 * i;
        place[i] = plate->centre[i] + row[0] * seen[0] + row[1] * seen[1] + row[2] * seen[2];
    }
}

/* Corners of a segment's plate, bent by its tensions, (8, 3): x, then y, then z, each - and +, the last one fastest. */
static void plate_corners(const fingerfem_segment *segment, const double *bent, const chain_plate *plate, double *corners)
{
    for (int k = 0; k < FINGERFEM_CORNERS / 3; k++) {
        const int signs[3] = {k >> 2 & 1, k >> 1 & 1, k & 1}, own = signs[0] + 2 * signs[1] + 4 * signs[2];
        double seen[3];
        for (int i = 0; i < 3; i++)
            seen[i] = (signs[i] ? 1.0 : -1.0) * segment->half_lengths[i] + (segment->corner_monomials ? bent[3 * own + i] : 0.0);
        in_space(plate, seen, corners + 3 * k);
    }
}

/* Sections, FINGERFEM_JOINED of them, (4, 3), between two: cubics by the corners' tangents there, over the way. */
static void join(double (*from)[3], double (*leaving)[3], double (*to)[3], double (*arriving)[3], double *corners)
{
    for (int k = 1; k <= FINGERFEM_JOINED; k++) {
        const double s = (double)k / (FINGERFEM_JOINED + 1), r = 1.0 - s;
        for (int edge = 0; edge < EDGES; edge++)
            for (int i = 0; i < 3; i++)
                *corners++ = r * r * (1.0 + 2.0 * s) * from[edge][i] + s * s * (1.0 + 2.0 * r) * to[edge][i] +
                             s * r * (r * leaving[edge][i] - s * arriving[edge][i]);
    }
}

/* Tangents of the corners: those along an axis, as long as the way, where a plate or the clamp holds the rubber ... */
static void held_tangents(const double *axis, double (*from)[3], double (*to)[3], double (*tangents)[3])
{
    for (int edge = 0; edge < EDGES; edge++) {
        double way = 0.0;
        for (int i = 0; i < 3; i++) way += (to[edge][i] - from[edge][i]) * (to[edge][i] - from[edge][i]);
        for (int i = 0; i < 3; i++) tangents[edge][i] = sqrt(way) * axis[i];
    }
}

/* ... and those of the places next to each other, which lie a share of the way apart. */
static void own_tangents(double (*one)[3], double (*next)[3], double (*from)[3], double (*to)[3], double (*tangents)[3])
{
    for (int edge = 0; edge < EDGES; edge++) {
        double way = 0.0, step = 0.0;
        for (int i = 0; i < 3; i++) {
            way += (to[edge][i] - from[edge][i]) * (to[edge][i] - from[edge][i]);
            step += (next[edge][i] - one[edge][i]) * (next[edge][i] - one[edge][i]);
        }
        for (int i = 0; i < 3; i++) tangents[edge][i] = sqrt(way / step) * (next[edge][i] - one[edge][i]);
    }
}

int fingerfem_chain_sections(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory,
                             double *corners)
{
    const int t = chain->tensions;
    double held[TENSIONS_MOST], before[EDGES][3], along[3] = {1.0, 0.0, 0.0};
    chain_rods map;
    chain_state state;
    tensions_all_clamped(chain->segments[0], tensions, held);
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    chain_under(&map, wrenches, &state);
    for (int edge = 0; edge < EDGES; edge++) rubber_begin(chain, edge, before[edge]);
    for (int k = 0; k < chain->plates; k++) {
        const fingerfem_segment *segment = chain->segments[k];
        const chain_plate *plate = state.plates + k;
        double inputs[TENSIONS_MOST + W], seen[EDGES][3];
        double *points = map.work + segment->skin_terms;
        if (!segment->skin_terms) return 0;
        for (int i = 0; i < segment->tensions; i++) inputs[i] = held[chain->own[t * k + i]];
        memcpy(inputs + segment->tensions, plate->borne, sizeof plate->borne);
        rubber_points(segment, inputs, map.work, points);
        memcpy(corners, before, sizeof before);
        double(*first)[3] = (double(*)[3])(corners + 3 * EDGES * (1 + FINGERFEM_JOINED)), leaving[EDGES][3], arriving[EDGES][3];
        double(*last)[3] = first + EDGES * (segment->places - 1), (*back)[3] = last + EDGES * (1 + FINGERFEM_JOINED);
        for (int place = 0; place < segment->places; place++) {
            rubber_between(segment, points, place, seen);
            for (int edge = 0; edge < EDGES; edge++) in_space(plate, seen[edge], first[EDGES * place + edge]);
        }
        plate_corners(segment, map.corners[k], plate, back[0]);
        const double axis[3] = {plate->rotation[0], plate->rotation[3], plate->rotation[6]};
        held_tangents(along, before, first, leaving);
        own_tangents(first, first + EDGES, before, first, arriving);
        join(before, leaving, first, arriving, corners + 3 * EDGES);
        own_tangents(last - EDGES, last, last, back, leaving);
        held_tangents(axis, last, back, arriving);
        join(last, leaving, back, arriving, last[EDGES]);
        memcpy(along, axis, sizeof axis);
        corners = back[2 * EDGES];
        memcpy(before, corners - 3 * EDGES, sizeof before);
    }
    return 1;
}

/* Shortenings of tendons where one force f presses across a chain, at a position along its axis. Between the two cross-sections
 * of an element of length L, at the share a of it from its end, the force is passed to both as by a beam that mainly shears
 * (contact/slice_forces.c with a large phi): forces a f and (1 - a) f, and opposite couples a (1 - a) L / 2 e_x x f. Then the
 * bending moment of the resultants has the force's own integral over the element, so that sections beyond turn as under the
 * force itself. All forces turn with their sections. */
#include <math.h>
#include "shortenings.h"

enum { ENDS = 2, FORCE = 2, FELT = 1 + FORCE /* position, and the force along y and z */ };

/* What a body supports: a share of the force, and that share times a lever [m] as its moment; and both by the position. */
typedef struct {
    int segment, element;
    double share, lever, share_slope, lever_slope;
} support;

/* The position in segment q, from its clamp [m], is in element e, which ends at `from` [m]: both sections support it. Returns their
 * number, 1 next to the ground. */
static int in_element(const fingerfem_chain *chain, int q, int e, double along, double from, support *found)
{
    const fingerfem_segment *segment = chain->segments[q];
    const double back = e ? 0.0 : segment->half_lengths[0]; /* an element at a plate begins at its back */
    const double length = segment->element_lengths[e] - back, a = (along - from) / length, b = 1.0 - a;
    const double couple = 0.5 * a * b * length, slope = 0.5 * (b - a);
    found[0] = (support){q, e, a, -couple - a * back, 1.0 / length, -slope - back / length};
    if (e + 1 < segment->elements) {
        found[1] = (support){q, e + 1, b, couple, -1.0 / length, slope};
        return 2;
    }
    /* the last element ends at the front of the plate before, or at the ground, which supports without a change */
    if (!q) return 1;
    const double front = chain->segments[q - 1]->half_lengths[0];
    found[1] = (support){q - 1, 0, b, couple + b * front, -1.0 / length, slope - front / length};
    return 2;
}

/* Bodies that support a force at a position, which is clamped to the finger [m]. Returns their number. */
static int supports_of(const fingerfem_chain *chain, double *position, support *found)
{
    double begin = 0.0; /* of the segment [m] */
    *position = *position > 0.0 ? *position : 0.0;
    for (int q = 0;; q++) {
        const fingerfem_segment *segment = chain->segments[q];
        const double half = segment->half_lengths[0];
        double length = 0.0, from; /* from the segment's clamp to its plate's centre; to where an element ends */
        for (int e = 0; e < segment->elements; e++) length += segment->element_lengths[e];
        /* beyond this segment's plate: the next one; there is none beyond the tip */
        if (*position > begin + length + half) {
            if (q + 1 < chain->plates) {
                begin += length + half;
                continue;
            }
            *position = begin + length + half;
        }
        const double along = *position - begin;
        /* on its plate, which supports all, with the lever from its centre */
        if (along >= length - half) {
            found[0] = (support){q, 0, 1.0, along - length, 0.0, 1.0};
            return 1;
        }
        /* the element, from the plate to the clamp */
        from = length;
        for (int e = 0; e < segment->elements; e++) {
            from -= segment->element_lengths[e];
            if (along >= from || e + 1 == segment->elements) return in_element(chain, q, e, along, from, found);
        }
    }
}

/* Add the wrench of a share of the force and a lever: s f and l e_x x f. */
static void press(double share, double lever, const double *force, double *wrench)
{
    const double moved[W] = {0.0, share * force[0], share * force[1], 0.0, -lever * force[1], lever * force[0]};
    for (int i = 0; i < W; i++) wrench[i] += moved[i];
}

/* The changes of the shortenings by unit changes of the position, c = 0, or of a component of the force. */
static void change_of(const chain_rods *map, const chain_state *state, const shortenings_segment *segments, int ends,
                      const support *supports, const int *bodies, const double *force, int c, double *found)
{
    const int w = chain_size(map);
    const double unit[FORCE] = {c == 1, c == 2};
    double wrench[CHAIN_WRENCH] = {0.0}, tensions[TENSIONS_MOST] = {0.0}, motion[CHAIN_WRENCH];
    for (int k = 0; k < ends; k++) {
        if (c) press(supports[k].share, supports[k].lever, unit, wrench + W * bodies[k]);
        else press(supports[k].share_slope, supports[k].lever_slope, force, wrench + W * bodies[k]);
    }
    /* motions of all bodies, C dw, by the wrenches on those that support */
    for (int i = 0; i < w; i++) {
        motion[i] = 0.0;
        for (int k = 0; k < ends; k++)
            for (int j = W * bodies[k]; j < W * bodies[k] + W; j++) motion[i] += state->bodies[i / W].motion[i % W][j] * wrench[j];
    }
    shortenings_change(state, map, segments, tensions, wrench, motion, found);
}

int fingerfem_chain_point_force(const fingerfem_chain *chain, const double *tensions, double position, const double *force,
                                double *memory, double *shortenings, double *changes)
{
    const int t = chain->tensions, columns = t + FELT;
    double held[TENSIONS_MOST], wrench[CHAIN_WRENCH] = {0.0}, at = position;
    int bodies[ENDS], inside = chain_clamped(chain, tensions, held);
    support supports[ENDS];
    chain_rods map;
    chain_state state;
    shortenings_segment segments[MOST_BODIES];
    const int ends = supports_of(chain, &at, supports);
    inside &= at == position;
    /* rods at the tensions; the sections that support become bodies, from the clamp to the tip, so that numbers stay */
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    for (int k = ends - 1; k >= 0; k--) chain_add_body(&map, supports[k].segment, supports[k].element);
    for (int k = 0; k < ends; k++) {
        bodies[k] = chain_body_of(&map, supports[k].segment, supports[k].element);
        press(supports[k].share, supports[k].lever, force, wrench + W * bodies[k]);
    }
    /* bodies under the force; motions by wrenches and by tensions */
    inside &= chain_under(&map, wrench, &state);
    chain_by_tensions(&map, &state);
    for (int b = 0; b < map.count; b++) inside &= state.bodies[b].end.inside;
    /* no laws of shortenings: NaN */
    if (!shortenings_known(&map, segments, columns, shortenings, changes)) return inside;
    /* columns of the tensions, 0 where they are clamped; then of the position, 0 where that is, and of the force */
    for (int c = 0; c < columns; c++) {
        double unit[TENSIONS_MOST] = {0.0}, none[CHAIN_WRENCH] = {0.0}, motion[CHAIN_WRENCH], found[TENSIONS_MOST];
        const int clamped = c < t ? held[c] != tensions[c] : c == t && at != position;
        if (c < t) {
            unit[c] = 1.0;
            for (int i = 0; i < chain_size(&map); i++) motion[i] = state.bodies[i / W].motion[i % W][chain_size(&map) + c];
            shortenings_change(&state, &map, segments, unit, none, motion, found);
        } else {
            change_of(&map, &state, segments, ends, supports, bodies, force, c - t, found);
        }
        for (int j = 0; j < t; j++) changes[columns * j + c] = clamped ? 0.0 : found[j];
    }
    return inside;
}

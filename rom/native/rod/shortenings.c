/* Shortenings of tendons: those in an element are a law of the tensions and of its transmitted wrench, as its pose
 * is. A tendon's shortening is the sum over all elements between the clamp and its plate. */
#include "shortenings.h"
#include <math.h>
#include "chain_weight.h"

enum { ROW = SHORTENINGS_ROW, POSE = FINGERFEM_POSE, LOADS = WIDE_LOAD * WIDE };

/* Derivatives of the wrench that an element transmits: a row for every component, by the load on the body of its part,
 * which is a wrench where nothing weighs, and by the tensions. */
typedef struct {
    double by_load[W][LOADS], by_tensions[W][POSE];
} transmitted;

/* Motions of a rod that weighs, by the load of its body and by the tensions; and what weighs beyond. */
typedef struct {
    rod_mass beyond;
    weight_motion by_load[WIDE_LOAD], by_tensions[WIDE_EIGHT];
} weighed;

/* Derivatives of the wrench that element k transmits. The motions are those of its distal section on entry, and
 * those of its proximal one on return. */
static void transmit(const rod_state *rod, rod_part part, int k, follow_motion *by_wrench, follow_motion *by_tensions, transmitted *found)
{
    const fingerfem_segment *segment = rod->segment;
    const rod_element *element = rod->elements + k;
    const double *wrench = rod->elements[part.first].wrench, *contracted = rod_contracted(rod, k);
    const int t = segment->tensions;
    double own[TENSIONS_MOST * POSE];
    /* derivatives of the pose by the tensions, at fixed wrench */
    element_by_tensions(segment, segment->law[segment->law_of[k]], contracted, rod->products + k * rod->products_stride, own);
    /* by the body's wrench: changes of the transmitted wrench, of the pose, of the proximal section */
    for (int six = 0; six < WIDE_SIX; six++) {
        wide carried[W], change[W] = {{0.0}};
        follow_carry(wrench, element, by_wrench + six, 1, WIDE * six, carried);
        follow_by_wrench(element, carried, change);
        follow_move(element, change, by_wrench + six);
        for (int i = 0; i < W; i++) wide_store(found->by_load[i] + WIDE * six, carried[i]);
    }
    /* likewise by the tensions */
    for (int j = 0; WIDE * j < t; j++) {
        wide carried[W], change[W] = {{0.0}};
        follow_by_inputs(t, own, WIDE * j, change);
        follow_carry(wrench, element, by_tensions + j, 0, 0, carried);
        follow_by_wrench(element, carried, change);
        follow_move(element, change, by_tensions + j);
        for (int i = 0; i < W; i++) wide_store(found->by_tensions[i] + WIDE * j, carried[i]);
    }
}

/* The same of a rod that weighs, where its body sees the acceleration `pull`. */
static void transmit_weight(const rod_state *rod, int k, const double *pull, weighed *motions, transmitted *found)
{
    const fingerfem_segment *segment = rod->segment;
    const double *contracted = rod_contracted(rod, k);
    double own[TENSIONS_MOST * POSE];
    weight_step step;
    element_by_tensions(segment, segment->law[segment->law_of[k]], contracted, rod->products + k * rod->products_stride, own);
    weight_step_of(rod, k, pull, &motions->beyond, &step);
    for (int n = 0; n < WIDE_LOAD; n++) {
        wide carried[W], change[W] = {{0.0}};
        weight_change unit;
        weight_load_unit(n, &unit);
        weight_follow(&step, &unit, change, motions->by_load + n, carried);
        for (int i = 0; i < W; i++) wide_store(found->by_load[i] + WIDE * n, carried[i]);
    }
    for (int n = 0; WIDE * n < segment->tensions; n++) {
        wide carried[W], change[W] = {{0.0}};
        follow_by_inputs(segment->tensions, own, WIDE * n, change);
        weight_follow(&step, NULL, change, motions->by_tensions + n, carried);
        for (int i = 0; i < W; i++) wide_store(found->by_tensions[i] + WIDE * n, carried[i]);
    }
    weight_beyond(&step, &motions->beyond);
}

static inline void add(double size, const double *row, double *sum)
{
    for (int o = 0; o < POSE; o++) sum[o] += size * row[o];
}

/* Add the shortenings of six tendons in element k, of which the law was contracted, and their derivatives. */
static void add_six(const rod_state *rod, int k, const fingerfem_law *law, const double *contracted, const transmitted *changes,
                    int first, shortenings_segment *found)
{
    double values[(1 + W) * POSE], own[TENSIONS_MOST * POSE], *products = rod->products + k * rod->products_stride;
    element_pose(law, contracted, rod->elements[k].wrench, products, values); /* with the same products as its pose */
    element_by_tensions(rod->segment, law, contracted, products, own);
    add(1.0, values, found->values + first);
    /* dS/dF_j = partial derivative + sum_i dS/dw_i dw_i/dF_j */
    for (int j = 0; j < rod->segment->tensions; j++) {
        add(1.0, own + POSE * j, found->by_tensions[j] + first);
        for (int i = 0; i < W; i++) add(changes->by_tensions[i][j], values + POSE * (1 + i), found->by_tensions[j] + first);
    }
    /* dS/dv_j = sum_i dS/dw_i dw_i/dv_j, with the body's load v */
    for (int j = 0; j < (rod->masses ? ROD_LOAD : W); j++)
        for (int i = 0; i < W; i++) add(changes->by_load[i][j], values + POSE * (1 + i), found->by_load[j] + first);
}

/* Shortenings in a part of a rod under the wrench of the last `rod_under`, or, of a rod that weighs, where its body sees the
 * acceleration `pull`. */
static void under(const rod_state *rod, rod_part part, const double *pull, shortenings_segment *found)
{
    const fingerfem_segment *segment = rod->segment;
    const int sixes = segment->sixes;
    follow_motion by_wrench[WIDE_SIX] = {{{{0.0}}, {{0.0}}}}, by_tensions[WIDE_EIGHT] = {{{{0.0}}, {{0.0}}}};
    transmitted changes;
    weighed motions;
    if (pull) memset(&motions, 0, sizeof motions);
    if (pull && !part.first) motions.beyond.mass = rod->masses[0];
    for (int k = part.first; k < part.last; k++) {
        const fingerfem_law *const *laws = segment->shortening + sixes * segment->law_of[k];
        if (pull) transmit_weight(rod, k, pull, &motions, &changes);
        else transmit(rod, part, k, by_wrench, by_tensions, &changes);
        /* every six tendons; a law is contracted anew where the element before has another one, or other tensions */
        for (int six = 0; six < sixes; six++) {
            double *contracted = rod->work + six * rod->contracted_stride;
            if (k == part.first || rod_set_of(rod, k) != rod_set_of(rod, k - 1))
                element_contract(segment, laws[six], rod_monomials(rod, k), 1, contracted);
            add_six(rod, k, laws[six], contracted, &changes, POSE * six, found);
        }
    }
}

/* Shortenings in a segment without a wrench. */
static void without_wrench(const rod_state *rod, shortenings_segment *found)
{
    const fingerfem_segment *segment = rod->segment;
    /* law by law: all its elements shorten alike; or element by element */
    for (int i = 0; i < (rod->guided ? segment->elements : segment->laws) * segment->sixes; i++) {
        double values[(1 + TENSIONS_MOST) * POSE], count = rod->guided;
        const int first = POSE * (i % segment->sixes), set = i / segment->sixes, law = rod->guided ? segment->law_of[set] : set;
        for (int k = 0; k < segment->elements && !rod->guided; k++) count += segment->law_of[k] == set;
        element_free(segment, segment->shortening[segment->sixes * law + i % segment->sixes], rod_monomials(rod, set), values);
        add(count, values, found->values + first);
        for (int j = 0; j < segment->tensions; j++) add(count, values + POSE * (1 + j), found->by_tensions[j] + first);
    }
}

int shortenings_of(const chain_rods *map, int free, shortenings_segment *segments)
{
    for (int b = 0; b < map->count; b++) {
        const chain_place *body = map->bodies + b;
        memset(segments + b, 0, sizeof *segments);
        if (body->segment == CHAIN_GROUND) continue;
        const rod_state *rod = map->rods + body->segment;
        if (!rod->segment->sixes) return 0;
        if (map->weight) under(rod, body->part, map->weight->bodies[b].load + W, segments + b);
        else if (free) without_wrench(rod, segments + b);
        else under(rod, body->part, NULL, segments + b);
    }
    return 1;
}

/* Indices among the chain's tensions of those in the segment of a body; the ground has none. */
static const int32_t *tensions_of(const chain_rods *map, int b, int *count)
{
    const fingerfem_chain *chain = map->chain;
    const int q = map->bodies[b].segment;
    *count = q < 0 ? 0 : chain->segments[q]->tensions;
    return chain->own + (q < 0 ? 0 : chain->tensions * q);
}

void shortenings_together(const chain_rods *map, const shortenings_segment *segments, double *found)
{
    memset(found, 0, (size_t)map->chain->tensions * sizeof *found);
    /* sum over the parts of all segments that a tendon passes */
    for (int b = 0; b < map->count; b++) {
        int count;
        const int32_t *own = tensions_of(map, b, &count);
        for (int j = 0; j < count; j++) found[own[j]] += segments[b].values[shortenings_at(j)];
    }
}

/* Motion of a body relative to the one before, dc_b - A^T (dc + t x a) and dtheta_b - A^T t, (6), from the motions
 * of both in space, each in its own frame; a and A are arm and relative rotation. */
static void relative_to_before(const chain_body *plate, const double *motion, double *found)
{
    const double *before = motion - W, *turn = before + 3;
    double moved[3];
    /* motion of the body as if it were fixed to the one before: dc + t x a, and t */
    follow_cross(turn, plate->arm, moved);
    for (int i = 0; i < 3; i++) moved[i] += before[i];
    for (int i = 0; i < 3; i++) {
        const double *column = plate->relative + i;
        found[i] = motion[i] - column[0] * moved[0] - column[3] * moved[1] - column[6] * moved[2];
        found[3 + i] = motion[3 + i] - column[0] * turn[0] - column[3] * turn[1] - column[6] * turn[2];
    }
}

void shortenings_change(const chain_state *state, const chain_rods *map, const shortenings_segment *segments,
                        const double *tensions, const double *wrenches, const double *motion, double *found)
{
    double change[ROD_LOAD] = {0.0}, relative[W], moment[3]; /* of the load that a body transmits */
    const int begin = map->bodies[0].segment == CHAIN_GROUND, loads = map->weight ? ROD_LOAD : W;
    memset(found, 0, (size_t)map->chain->tensions * sizeof *found);
    /* from tip to base, with the change of the transmitted wrench */
    for (int b = map->count - 1; b >= begin; b--) {
        int count;
        const int32_t *own = tensions_of(map, b, &count);
        const shortenings_segment *segment = segments + b;
        const chain_load *load = map->weight ? map->weight->bodies + b : NULL;
        for (int i = 0; i < W; i++) change[i] += wrenches[W * b + i];
        /* the acceleration by weight turns in the body's frame: dg = g x dtheta */
        if (load) follow_cross(load->load + W, motion + W * b + 3, change + W);
        /* dS_j = dS_j/dw . dw + sum_i dS_j/dF_i dF_i */
        for (int j = 0; j < count; j++) {
            double sum = 0.0;
            for (int i = 0; i < loads; i++) sum += segment->by_load[i][shortenings_at(j)] * change[i];
            for (int i = 0; i < count; i++) sum += segment->by_tensions[i][shortenings_at(j)] * tensions[own[i]];
            found[own[j]] += sum;
        }
        if (b == begin) break;
        /* change of the wrench that the body before transmits */
        relative_to_before(state->bodies + b, motion + W * b, relative);
        for (int i = 0; i < 3 && load; i++) {
            moment[i] = 0.0;
            for (int j = 0; j < count; j++) moment[i] += load->own.moment_by_inputs[i][j] * tensions[own[j]];
        }
        if (load) {
            double whole[W];
            chain_weight_change(load, change, moment, whole);
            memcpy(change, whole, sizeof whole);
        }
        chain_pass_change(state->bodies + b, relative, change);
    }
}

int shortenings_known(const chain_rods *map, shortenings_segment *segments, int columns, double *shortenings, double *changes)
{
    const int t = map->chain->tensions, known = shortenings_of(map, 0, segments);
    for (int j = 0; j < t && !known; j++) shortenings[j] = NAN;
    for (int j = 0; j < t * columns && !known; j++) changes[j] = NAN;
    if (known) shortenings_together(map, segments, shortenings);
    return known;
}

int fingerfem_chain_shortenings(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                                double *shortenings, double *changes)
{
    const int t = chain->tensions, columns = t + W * chain->plates;
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    shortenings_segment segments[MOST_BODIES];
    const int inside = chain_placed(chain, tensions, loads, memory, held, &map, &state), w = chain_size(&map);
    /* no laws of shortenings: NaN */
    if (!shortenings_known(&map, segments, columns, shortenings, changes)) return inside;
    /* column c: a unit change of tension c, or of a component of a plate's wrench */
    for (int c = 0; c < columns; c++) {
        double by_tensions[TENSIONS_MOST] = {0.0}, by_wrenches[CHAIN_WRENCH] = {0.0}, motion[CHAIN_WRENCH], found[TENSIONS_MOST];
        const int clamped = c < t && held[c] != tensions[c];
        const int row = c < t ? 0 : W * chain_plate_of(&map, (c - t) / W) + (c - t) % W;
        if (c < t) by_tensions[c] = 1.0;
        else by_wrenches[row] = 1.0;
        /* motions of all bodies by that input; then its column, 0 for a clamped tension */
        for (int i = 0; i < w; i++) motion[i] = state.bodies[i / W].motion[i % W][c < t ? w + c : row];
        shortenings_change(&state, &map, segments, by_tensions, by_wrenches, motion, found);
        for (int j = 0; j < t; j++) changes[columns * j + c] = clamped ? 0.0 : found[j];
    }
    return inside;
}

int fingerfem_chain_elements(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                             double *places, double *rotations, double *carried)
{
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    const int inside = chain_placed(chain, tensions, loads, memory, held, &map, &state);
    /* pose in space of every element's distal section, and the wrench through it */
    for (int k = 0; k < chain->plates; k++)
        for (int e = 0; e < chain->segments[k]->elements; e++, places += 3, rotations += 9, carried += W) {
            chain_section(&map, &state, k, e, places, rotations);
            memcpy(carried, map.rods[k].elements[e].wrench, W * sizeof *carried);
        }
    return inside;
}

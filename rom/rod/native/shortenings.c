/* How much shorter tendons are: an element's shortenings are a law of tensions and its transmitted wrench, as its pose is, and
 * a tendon's is the sum over all elements between the clamp and its plate. */
#include "shortenings.h"
#include <math.h>
#include "rod_follow.h"

enum { ROW = SHORTENINGS_ROW, POSE = FINGERFEM_POSE };

/* How the wrench that an element transmits changes: rows of a component, (6, 8), by the wrench on the plate, and by the
 * tensions. */
typedef struct {
    double by_wrench[W][POSE], by_tensions[W][POSE];
} transmitted;

/* The next element's changes, from the motions of its distal section, which become those of its proximal one. */
static void transmit(const rod_state *rod, int k, follow_motion *by_wrench, follow_motion *by_tensions, transmitted *found)
{
    const fingerfem_segment *segment = rod->segment;
    const rod_element *element = rod->elements + k;
    const double *wrench = rod->elements[0].wrench, *contracted = rod->contracted + segment->law_of[k] * rod->contracted_stride;
    const int t = segment->tensions;
    double own[TENSIONS_MOST * POSE];
    element_by_tensions(segment, segment->law[segment->law_of[k]], contracted, rod->products + k * rod->products_stride, own);
    for (int part = 0; part < WIDE_SIX; part++) {
        wide carried[W], change[W] = {{0.0}};
        follow_carry(wrench, element, by_wrench + part, 1, WIDE * part, carried);
        follow_by_wrench(element, carried, change);
        follow_move(element, change, by_wrench + part);
        for (int i = 0; i < W; i++) wide_store(found->by_wrench[i] + WIDE * part, carried[i]);
    }
    for (int part = 0; WIDE * part < t; part++) {
        wide carried[W], change[W] = {{0.0}};
        follow_by_inputs(t, own, WIDE * part, change);
        follow_carry(wrench, element, by_tensions + part, 0, 0, carried);
        follow_by_wrench(element, carried, change);
        follow_move(element, change, by_tensions + part);
        for (int i = 0; i < W; i++) wide_store(found->by_tensions[i] + WIDE * part, carried[i]);
    }
}

static inline void add(double size, const double *row, double *sum)
{
    for (int o = 0; o < POSE; o++) sum[o] += size * row[o];
}

/* Add six tendons of an element, of which the law has been contracted. */
static void add_six(const rod_state *rod, int k, const fingerfem_law *law, const double *contracted, const transmitted *changes,
                    int first, shortenings_segment *found)
{
    double values[(1 + W) * POSE], own[TENSIONS_MOST * POSE], *products = rod->products + k * rod->products_stride;
    element_pose(law, contracted, rod->elements[k].wrench, products, values); /* whose products are those of its pose */
    element_by_tensions(rod->segment, law, contracted, products, own);
    add(1.0, values, found->values + first);
    for (int j = 0; j < rod->segment->tensions; j++) {
        add(1.0, own + POSE * j, found->by_tensions[j] + first);
        for (int i = 0; i < W; i++) add(changes->by_tensions[i][j], values + POSE * (1 + i), found->by_tensions[j] + first);
    }
    for (int j = 0; j < W; j++)
        for (int i = 0; i < W; i++) add(changes->by_wrench[i][j], values + POSE * (1 + i), found->by_wrench[j] + first);
}

/* Of a segment that `rod_under` has placed. */
static void under(const rod_state *rod, shortenings_segment *found)
{
    const fingerfem_segment *segment = rod->segment;
    const int sixes = segment->sixes;
    follow_motion by_wrench[WIDE_SIX] = {{{{0.0}}, {{0.0}}}}, by_tensions[WIDE_EIGHT] = {{{{0.0}}, {{0.0}}}};
    transmitted changes;
    for (int k = 0; k < segment->elements; k++) {
        const fingerfem_law *const *laws = segment->shortening + sixes * segment->law_of[k];
        transmit(rod, k, by_wrench, by_tensions, &changes);
        for (int six = 0; six < sixes; six++) {
            double *contracted = rod->work + six * rod->contracted_stride;
            if (!k || segment->law_of[k] != segment->law_of[k - 1])
                element_contract(segment, laws[six], rod->monomials, contracted);
            add_six(rod, k, laws[six], contracted, &changes, POSE * six, found);
        }
    }
}

/* Of a segment that `rod_free` has placed. */
static void without_wrench(const rod_state *rod, shortenings_segment *found)
{
    const fingerfem_segment *segment = rod->segment;
    for (int i = 0; i < segment->laws * segment->sixes; i++) {
        double values[(1 + TENSIONS_MOST) * POSE], count = 0.0;
        const int first = POSE * (i % segment->sixes);
        for (int k = 0; k < segment->elements; k++) count += segment->law_of[k] == i / segment->sixes;
        element_free(segment, segment->shortening[i], rod->monomials, values);
        add(count, values, found->values + first);
        for (int j = 0; j < segment->tensions; j++) add(count, values + POSE * (1 + j), found->by_tensions[j] + first);
    }
}

int shortenings_of(const chain_rods *map, int free, shortenings_segment *segments)
{
    for (int k = 0; k < map->chain->plates; k++) {
        if (!map->rods[k].segment->sixes) return 0;
        memset(segments + k, 0, sizeof *segments);
        if (free) without_wrench(map->rods + k, segments + k);
        else under(map->rods + k, segments + k);
    }
    return 1;
}

void shortenings_together(const fingerfem_chain *chain, const shortenings_segment *segments, double *found)
{
    memset(found, 0, (size_t)chain->tensions * sizeof *found);
    for (int k = 0; k < chain->plates; k++)
        for (int j = 0; j < chain->segments[k]->tensions; j++)
            found[chain->own[chain->tensions * k + j]] += segments[k].values[shortenings_at(j)];
}

/* The motion of a plate relative to the one before, R^T dc and R^T dtheta, (6), from those of both in space. */
static void relative_to_before(const chain_plate *plate, const double *motion, double *found)
{
    const double *before = motion - W, *turn = before + 3;
    double moved[3];
    follow_cross(turn, plate->arm, moved);
    for (int i = 0; i < 3; i++) moved[i] += before[i];
    for (int i = 0; i < 3; i++) {
        const double *column = plate->relative + i;
        found[i] = motion[i] - column[0] * moved[0] - column[3] * moved[1] - column[6] * moved[2];
        found[3 + i] = motion[3 + i] - column[0] * turn[0] - column[3] * turn[1] - column[6] * turn[2];
    }
}

void shortenings_change(const chain_state *state, const fingerfem_chain *chain, const shortenings_segment *segments,
                        const double *tensions, const double *wrenches, const double *motion, double *found)
{
    double change[W] = {0.0}, relative[W]; /* of the wrench that a segment's plate transmits */
    memset(found, 0, (size_t)chain->tensions * sizeof *found);
    for (int k = chain->plates - 1; k >= 0; k--) {
        const int32_t *own = chain->own + chain->tensions * k;
        const shortenings_segment *segment = segments + k;
        for (int i = 0; i < W; i++) change[i] += wrenches[W * k + i];
        for (int j = 0; j < chain->segments[k]->tensions; j++) {
            double sum = 0.0;
            for (int i = 0; i < W; i++) sum += segment->by_wrench[i][shortenings_at(j)] * change[i];
            for (int i = 0; i < chain->segments[k]->tensions; i++)
                sum += segment->by_tensions[i][shortenings_at(j)] * tensions[own[i]];
            found[own[j]] += sum;
        }
        if (!k) break;
        relative_to_before(state->plates + k, motion + W * k, relative);
        chain_pass_change(state->plates + k, relative, change);
    }
}

int fingerfem_chain_shortenings(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory,
                                double *shortenings, double *changes)
{
    const int t = chain->tensions, w = W * chain->plates;
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    shortenings_segment segments[FINGERFEM_MOST_PLATES];
    int inside = chain_placed(chain, tensions, wrenches, memory, held, &map, &state);
    if (!shortenings_of(&map, 0, segments)) {
        for (int j = 0; j < t; j++) shortenings[j] = NAN;
        for (int j = 0; j < t * (t + w); j++) changes[j] = NAN;
        return inside;
    }
    shortenings_together(chain, segments, shortenings);
    for (int c = 0; c < t + w; c++) {
        double by_tensions[TENSIONS_MOST] = {0.0}, by_wrenches[CHAIN_WRENCH] = {0.0}, motion[CHAIN_WRENCH], found[TENSIONS_MOST];
        const int clamped = c < t && held[c] != tensions[c];
        if (c < t) by_tensions[c] = 1.0;
        else by_wrenches[c - t] = 1.0;
        for (int i = 0; i < w; i++) motion[i] = state.plates[i / W].motion[i % W][c < t ? w + c : c - t];
        shortenings_change(&state, chain, segments, by_tensions, by_wrenches, motion, found);
        for (int j = 0; j < t; j++) changes[(t + w) * j + c] = clamped ? 0.0 : found[j];
    }
    return inside;
}

int fingerfem_chain_elements(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory,
                             double *places, double *rotations, double *carried)
{
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    const int inside = chain_placed(chain, tensions, wrenches, memory, held, &map, &state);
    for (int k = 0; k < chain->plates; k++) {
        const chain_plate *plate = state.plates + k;
        for (int e = 0; e < chain->segments[k]->elements; e++, places += 3, rotations += 9, carried += W) {
            const rod_element *element = map.rods[k].elements + e;
            for (int i = 0; i < 3; i++) {
                const double *row = plate->rotation + 3 * i, *Q = element->rotation, *p = element->place;
                places[i] = plate->centre[i] + row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
                for (int j = 0; j < 3; j++) rotations[3 * i + j] = row[0] * Q[j] + row[1] * Q[3 + j] + row[2] * Q[6 + j];
            }
            memcpy(carried, element->wrench, sizeof element->wrench);
        }
    }
    return inside;
}

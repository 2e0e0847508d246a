/* Input of friction in guides from the elements: shortenings of their tendons, and angles of their bending, with the derivatives
 * by the tensions in each element itself. */
#include "guides.h"
#include <math.h>
#include "shortenings.h"

enum { POSE = FINGERFEM_POSE, T = TENSIONS_MOST };

#define STRAIGHT 1e-18 /* sin^2 of half an angle below which its derivative is not defined, and 0 is taken [-] */

/* The angle by which a pose with the Gibbs vector g is bent: sin^2(angle / 2) = (g_y^2 + g_z^2) / (1 + g.g). It is the turn of all
 * tendons along the element; twist does not turn them. */
static void bend_of(const double *pose, int count, const int32_t *own, const double *by_tensions, guides_element *found)
{
    const double *g = pose + 3, size = 1.0 + g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    const double square = (g[1] * g[1] + g[2] * g[2]) / size;
    found->bend = 2.0 * asin(sqrt(fmin(square, 1.0)));
    for (int i = 0; i < count; i++) {
        const double *dg = by_tensions + POSE * i + 3;
        const double along = g[0] * dg[0] + g[1] * dg[1] + g[2] * dg[2], across = g[1] * dg[1] + g[2] * dg[2];
        found->bend_by[own[i]] = square > STRAIGHT ? 2.0 * (across - square * along) / size / sqrt(square * (1.0 - square)) : 0.0;
    }
}

/* Shortenings of six tendons of an element and their derivatives by its tensions, (count, 8), to the chain's tendons. */
static void leave_six(int count, const int32_t *own, int first, const double *values, const double *by_tensions, guides_element *found)
{
    for (int i = 0; i < SHORTENINGS_SIX && first + i < count; i++) {
        found->shortening[own[first + i]] = values[i];
        for (int j = 0; j < count; j++) found->by_tensions[own[first + i]][own[j]] = by_tensions[POSE * j + i];
    }
}

void guides_without_wrench(guides_state *state)
{
    const fingerfem_chain *chain = state->chain;
    for (int k = 0; k < state->count; k++) {
        guides_element *element = state->elements + k;
        const fingerfem_segment *segment = chain->segments[element->segment];
        const int32_t *own = chain->own + chain->tensions * element->segment;
        const int t = segment->tensions, law = segment->law_of[element->element];
        const double *tensions = guides_tensions(state, k);
        double inside[T], values[(1 + T) * POSE];
        for (int i = 0; i < t; i++) inside[i] = guides_held(state, own[i], tensions[own[i]]);
        tensions_monomials(segment, inside, 1, state->monomials);
        /* pose, then the shortenings of every six tendons */
        element_free(segment, segment->law[law], state->monomials, values);
        bend_of(values, t, own, values + POSE, element);
        for (int six = 0; six < segment->sixes; six++) {
            element_free(segment, segment->shortening[segment->sixes * law + six], state->monomials, values);
            leave_six(t, own, SHORTENINGS_SIX * six, values, values + POSE, element);
        }
    }
}

void guides_under(const chain_rods *map, guides_state *state)
{
    const fingerfem_chain *chain = state->chain;
    for (int k = 0; k < state->count; k++) {
        guides_element *element = state->elements + k;
        const int e = element->element;
        const rod_state *rod = map->rods + element->segment;
        const fingerfem_segment *segment = rod->segment;
        const int32_t *own = chain->own + chain->tensions * element->segment;
        const int law = segment->law_of[e];
        double values[(1 + W) * POSE], by[T * POSE], seen[W], *products = rod->products + e * rod->products_stride;
        /* pose under its wrench, then the shortenings of every six tendons, with the same products */
        element_by_tensions(segment, segment->law[law], rod_contracted(rod, e), products, by);
        bend_of(rod->elements[e].pose, segment->tensions, own, by, element);
        rod_seen(rod, e, seen);
        for (int six = 0; six < segment->sixes; six++) {
            const fingerfem_law *shortening = segment->shortening[segment->sixes * law + six];
            element_contract(segment, shortening, rod_monomials(rod, e), 1, rod->work);
            element_pose(shortening, rod->work, seen, products, values);
            element_by_tensions(segment, shortening, rod->work, products, by);
            leave_six(segment->tensions, own, SHORTENINGS_SIX * six, values, by, element);
        }
    }
}

void guides_leave(const chain_rods *map, double *memory)
{
    const fingerfem_chain *chain = map->chain;
    const int32_t wound[T] = {0};
    const double wanted[T] = {0.0};
    const guides_goal goal = {wanted, wound};
    double motors[T], slips[T] = {0.0};
    guides_state state;
    guides_begin(chain, &goal, motors, guides_memory_in(chain, memory), &state);
    guides_under(map, &state);
    for (int k = 0; k < state.count; k++) {
        const guides_element *element = state.elements + k;
        for (int j = 0; j < chain->tensions; j++) slips[j] += element->shortening[j];
        memcpy(chain->guides->slips + chain->tensions * element->number, slips, (size_t)chain->tensions * sizeof *slips);
        chain->guides->bends[element->number] = element->bend;
    }
}

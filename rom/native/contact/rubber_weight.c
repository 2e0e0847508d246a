/* The free rubber that weighs: as tensions move it, the wrench through its elements changes, and so do their shapes. */
#include "rubber_weight.h"
#include <math.h>

#define WAY 1e-4 /* change of a wrench over its box, by which a shape is differentiated; it is a polynomial of low degree [-] */

/* Change of the position of a knot's weighted corners with the wrench through its element: by a central difference. */
static void by_wrench(const rod_state *rod, int element, int number, const double *at, const double *change, double *found)
{
    const fingerfem_outline *outline = rod->segment->outline[rod->segment->law_of[element]];
    double *corners = rod->work + OUTLINE_KNOT * rod->segment->knots, largest = 0.0, wrench[W], sides[2][3];
    /* the largest change over its box, and the share of it that is WAY */
    for (int i = 0; i < W; i++) largest = fmax(largest, fabs(change[i]) / outline->upper[i]);
    for (int i = 0; i < 3; i++) found[i] = 0.0;
    if (!(largest > 0.0)) return;
    const double way = WAY / largest;
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < W; i++) wrench[i] = rod->elements[element].wrench[i] + (side ? way : -way) * change[i];
        outline_under(outline, rubber_contracted(rod, element), wrench, 0, outline->numbers, corners + outline->numbers, corners);
        rubber_point_of(at, corners + OUTLINE_KNOT * number, sides[side]);
    }
    for (int i = 0; i < 3; i++) found[i] = (sides[1][i] - sides[0][i]) / (2.0 * way);
}

/* As `knot_moves` of rubber_moves.c: weight dp + b x arm + Q dc. */
void rubber_weight_moves(const chain_rods *map, int q, const rod_end *clamp, int knot, const double *at, double (*found)[TENSIONS_MOST])
{
    const fingerfem_chain *chain = map->chain;
    const rod_state *rod = map->rods + q;
    const fingerfem_segment *segment = rod->segment;
    chain_load *load = map->weight->bodies + q;
    const int32_t *own = chain->own + chain->tensions * q;
    int number;
    const int k = rubber_element_of(segment, knot, &number), rubber = k < segment->elements;
    if (k < 0) return; /* the plate itself */
    /* motions of the section that the knot is seen from, and the change of the wrench through its element */
    double wrench[W][TENSIONS_MOST], pose[TENSIONS_MOST * FINGERFEM_POSE], arm[3], changes[TENSIONS_MOST][3] = {{0.0}};
    rod_motion motion;
    rod_weight_section(rod, k, chain->tensions, own, load->load + W, load->by_tensions, &motion, wrench, pose);
    /* arm = sum_k weight_k (x_k - p) */
    const double *origin = rubber ? rod->elements[k].place : clamp->place, *Q = rod->elements[rubber ? k : 0].rotation;
    const double weight = at[0] + at[1] + at[2] + at[3];
    rubber_point_of(at, rod->work + OUTLINE_KNOT * knot, arm);
    for (int i = 0; i < 3; i++) arm[i] -= weight * origin[i];
    /* dc by the tensions at fixed wrench, and by the wrench */
    double *corners = rod->work + OUTLINE_KNOT * segment->knots;
    for (int j = 0; j < segment->tensions && rubber; j++) {
        rubber_shape(rod, k, rod_monomials(rod, k) + segment->monomials * (1 + j), corners);
        rubber_point_of(at, corners + OUTLINE_KNOT * number, changes[own[j]]);
    }
    for (int c = 0; c < chain->tensions; c++) {
        double change[W], more[3] = {0.0};
        for (int i = 0; i < W && rubber; i++) change[i] = wrench[i][c];
        if (rubber) by_wrench(rod, k, number, at, change, more);
        for (int i = 0; i < 3; i++) {
            const int l = (i + 1) % 3, m = (i + 2) % 3;
            double turned = 0.0;
            for (int j = 0; j < 3; j++) turned += Q[3 * i + j] * (changes[c][j] + more[j]);
            found[i][c] += weight * motion.move[i][c] + motion.turn[l][c] * arm[m] - motion.turn[m][c] * arm[l] + turned;
        }
    }
}

void rubber_weight_pose(const chain_rods *map, int q, int element, double *found)
{
    const fingerfem_chain *chain = map->chain;
    chain_load *load = map->weight->bodies + q;
    double wrench[W][TENSIONS_MOST];
    rod_motion motion;
    rod_weight_section(map->rods + q, element, chain->tensions, chain->own + chain->tensions * q, load->load + W, load->by_tensions, &motion, wrench, found);
}

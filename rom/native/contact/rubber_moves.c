/* Motion of a point on the surface of the free finger by its tensions.
 *
 * Corners c of an element's knots, seen from its distal section, are at x = p + Q c in the plate's frame, where p and Q
 * are the section's. As tensions move the section by dp and turn it by b, dx = dp + b x (x - p) + Q dc. */
#include "rubber.h"
#include <math.h>
#include "rubber_weight.h"
#include "slices.h"

/* Add the motion by the tensions, (3, tensions), of the weighted sum of a knot's corners, of the free finger, in the
 * plate's frame: weight dp + b x arm + Q dc, see above. */
static void knot_moves(const rod_state *rod, const rod_end *clamp, int knot, const double *at,
                          double (*found)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    int number;
    const int k = rubber_element_of(segment, knot, &number), rubber = k < segment->elements;
    if (k < 0) return; /* the plate itself */
    /* motion dp, b of the section that the knot is seen from, by all tensions */
    const double *origin = rubber ? rod->elements[k].place : clamp->place, *Q = rod->elements[rubber ? k : 0].rotation;
    double *corners = rod->work + OUTLINE_KNOT * segment->knots, arm[3];
    rod_motion motion;
    rod_free_motion(rod, k, &motion);
    /* arm = sum_k weight_k (x_k - p) */
    rubber_point_of(at, rod->work + OUTLINE_KNOT * knot, arm);
    const double weight = at[0] + at[1] + at[2] + at[3];
    for (int i = 0; i < 3; i++) arm[i] -= weight * origin[i];
    for (int j = 0; j < segment->tensions; j++) {
        double change[3] = {0.0};
        /* dc: change of the weighted corners with tension j, seen from the section */
        if (rubber) {
            outline_free(rubber_outline(segment, k), rod_monomials(rod, k) + segment->monomials * (1 + j), corners);
            rubber_point_of(at, corners + OUTLINE_KNOT * number, change);
        }
        for (int i = 0; i < 3; i++) {
            /* component i of weight dp + b x arm + Q dc */
            const int l = (i + 1) % 3, m = (i + 2) % 3;
            const double own = Q[3 * i] * change[0] + Q[3 * i + 1] * change[1] + Q[3 * i + 2] * change[2];
            found[i][j] += weight * motion.move[i][j] + motion.turn[l][j] * arm[m] - motion.turn[m][j] * arm[l] + own;
        }
    }
}

/* Add the motion by the tensions of the weighted sum of a free slice's corners; weights (2, 4) for its two sections. */
static void section_moves(const chain_rods *map, const rod_end *clamp, const rubber_slice *slice, double (*corners)[EDGES],
                          double (*found)[TENSIONS_MOST])
{
    const int place = slices_place(map, slice->segment, slice->number);
    const rod_state *rod = map->rods + slice->segment;
    const fingerfem_segment *segment = rod->segment;
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < segment->near; k++) {
            /* the section's corners are those of knots, each times `between` */
            const double between = segment->between[segment->near * (place + side) + k];
            double weights[EDGES];
            for (int edge = 0; edge < EDGES; edge++) weights[edge] = between * corners[side][edge];
            const int knot = segment->first[place + side] + k;
            if (between == 0.0) continue;
            if (map->weight) rubber_weight_moves(map, slice->segment, clamp, knot, weights, found);
            else knot_moves(rod, clamp, knot, weights, found);
        }
}

void rubber_moves(const chain_rods *map, const chain_state *free, const rubber_slice *slice, const double *at, double *found)
{
    const fingerfem_chain *chain = map->chain;
    const int q = slice->segment, face = slices_outlined(slice) || fabs(at[1]) < 1.0 || fabs(at[2]) < 1.0;
    const chain_body *plate = free->bodies + q;
    double moves[3][TENSIONS_MOST] = {{0.0}}, twists[3][TENSIONS_MOST] = {{0.0}}, corners[2][EDGES], ends[2][EDGES], axes[2][3];
    /* weights of the corners (2, 4): trilinear shape functions at the point; and those of the twist of the faces */
    for (int side = 0; side < 2; side++) {
        const double share = 0.5 * (1.0 + (side ? 1.0 : -1.0) * at[0]);
        for (int edge = 0; edge < EDGES; edge++) {
            corners[side][edge] = 0.25 * share * (1.0 + (edge & 2 ? 1.0 : -1.0) * at[1]) * (1.0 + (edge & 1 ? 1.0 : -1.0) * at[2]);
            ends[side][edge] = share * slices_twist(edge);
        }
    }
    /* motion of the trilinear point, and of the twist, by all tensions (3, tensions) */
    rubber_points(map->rods + q, &plate->end, 1);
    section_moves(map, &plate->end, slice, corners, moves);
    if (face) section_moves(map, &plate->end, slice, ends, twists);
    /* y and z axes of the slice in the plate's frame */
    for (int j = 0; j < 2; j++) {
        const double axis[3] = {slice->rotation[1 + j], slice->rotation[4 + j], slice->rotation[7 + j]};
        objects_turned_back(plate->rotation, axis, axes[j]);
    }
    /* growth of the ridge over a tendon, as the free pose of the element changes with every tension */
    const rod_state *rod = map->rods + q;
    double ridges[TENSIONS_MOST];
    const int32_t *columns = chain->own + chain->tensions * q;
    const int count = map->weight ? chain->tensions : chain->segments[q]->tensions; /* with weight all tensions move the rubber */
    double weighed[TENSIONS_MOST * FINGERFEM_POSE];
    if (map->weight) rubber_weight_pose(map, q, slice->element, weighed);
    const double *by = map->weight ? weighed : rod_free_pose(rod, slice->element) + FINGERFEM_POSE;
    const int across = slices_ridge_changes(rod, slice, at, count, map->weight ? columns : NULL, by, ridges), other = 3 - across;
    /* by tension j: trilinear point + bulge + axis ridge (1 - zeta^2), zeta the coordinate along the face */
    for (int j = 0; j < count; j++) {
        double *own = found + 3 * (map->weight ? j : columns[j]), bulge[3];
        const double twist[3] = {twists[0][j], twists[1][j], twists[2][j]};
        slices_bulge(chain->segments[q], axes, twist, at, bulge);
        for (int i = 0; i < 3; i++)
            own[i] = moves[i][j] + bulge[i] + (across ? axes[across - 1][i] * ridges[j] * (1.0 - at[other] * at[other]) : 0.0);
    }
}

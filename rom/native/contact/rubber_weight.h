/* Motion of the rubber of a free finger that weighs, by the tensions. */
#ifndef FINGERFEM_RUBBER_WEIGHT_H
#define FINGERFEM_RUBBER_WEIGHT_H
#include "rubber.h"

/* Add the motion by all tensions, (3, TENSIONS_MOST), of the sum of a knot's corners, each with a weight, in the frame of the
 * plate of segment q, where the plates alone are bodies. */
void rubber_weight_moves(const chain_rods *map, int q, const rod_end *clamp, int knot, const double *at, double (*found)[TENSIONS_MOST]);

/* Derivatives of an element's pose by all tensions, (tensions, FINGERFEM_POSE). */
void rubber_weight_pose(const chain_rods *map, int q, int element, double *found);
#endif

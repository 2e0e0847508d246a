/* A chain that weighs, see chain_weight.c; and parts of chain.c that it takes. */
#ifndef FINGERFEM_CHAIN_WEIGHT_H
#define FINGERFEM_CHAIN_WEIGHT_H
#include "chain.h"

/* As the functions of chain.h with these names, where `weight` is not NULL; by tensions, or, with `variants`, by these. */
int chain_weight_under(const chain_rods *map, const double *wrench, chain_state *state);
int chain_weight_free(const chain_rods *map, chain_state *state);
void chain_weight_by_inputs(const chain_rods *map, int variants, chain_state *state);

/* The march from tip to base where the tip sees an acceleration, (3): bodies under their wrenches, and motions by these and by the
 * acceleration; and then motions by inputs while the tip sees the same one. */
void chain_loads_march(const chain_rods *map, const double *wrench, const double *pull, chain_state *state);
void chain_loads_by_inputs(const chain_rods *map, int variants, chain_state *state);

/* From the change of a body's load, (9), to that of the wrench that it passes on to the one before, in its own frame, (6), with the
 * change of the first moment of its part at fixed load, (3). */
void chain_weight_change(const chain_load *body, const double *load, const double *moment, double *change);

/* As `chain_under`, of a chain as if it did not weigh. */
void chain_without_weight(const chain_rods *map, const double *wrench, int motions, chain_state *state);

/* Pose of a body seen from the body before: arm a and rotation A. */
void chain_locate(const chain_rods *map, int b, chain_body *body);

/* Poses in space and motions by inputs first ... last - 1, from those relative to the body before. */
void chain_compose(const chain_rods *map, int first, int last, chain_state *state);
#endif

/* Shortenings of tendons in a segment, and in a chain. */
#ifndef FINGERFEM_SHORTENINGS_H
#define FINGERFEM_SHORTENINGS_H
#include "chain.h"

enum { SHORTENINGS_SIX = 6 /* tendons of a law */, SHORTENINGS_MOST_SIXES = 2, SHORTENINGS_ROW = SHORTENINGS_MOST_SIXES * FINGERFEM_POSE };

/* Shortenings of a segment's tendons [m], and the derivatives by its tensions, (tensions, ...), and by the wrench
 * on its plate, (6, ...), of a chain that weighs by its load, (9, ...). Tendon j is at `shortenings_at(j)` of a row. */
typedef struct {
    double values[SHORTENINGS_ROW], by_tensions[TENSIONS_MOST][SHORTENINGS_ROW], by_load[ROD_LOAD][SHORTENINGS_ROW];
} shortenings_segment;

static inline int shortenings_at(int tendon) { return FINGERFEM_POSE * (tendon / SHORTENINGS_SIX) + tendon % SHORTENINGS_SIX; }

/* Shortenings in all segments, as `chain_under`, or without a wrench `chain_free`, has placed them; returns 0 if the model has none. */
int shortenings_of(const chain_rods *map, int free, shortenings_segment *segments);

/* Those of the chain, (tensions) [m], from all segments, which it takes too; NAN, with all derivatives, (tensions, columns), without laws of
 * them: then it returns 0. */
int shortenings_known(const chain_rods *map, shortenings_segment *segments, int columns, double *shortenings, double *changes);

/* Those of the chain, (tensions) [m]. */
void shortenings_together(const chain_rods *map, const shortenings_segment *segments, double *found);

/* Changes of shortenings, (tensions), by those of tensions, (tensions), wrenches on the plates, (6 plates), and the plates' motions by
 * both, R^T dc, R^T dtheta, (6 plates). */
void shortenings_change(const chain_state *state, const chain_rods *map, const shortenings_segment *segments,
                        const double *tensions, const double *wrenches, const double *motion, double *found);
#endif

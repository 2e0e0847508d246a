/* Viscoelastic branches of the rubber in a step of time, see relaxation.c. */
#ifndef FINGERFEM_RELAXATION_H
#define FINGERFEM_RELAXATION_H
#include "../rod/chain.h"

/* Loads of a chain: wrenches through all elements, segment by segment, each from its plate to its clamp, then the tensions: one of every
 * tendon or, with guides, those of all elements. */
enum { RELAXATION_TENSIONS = MOST_BODIES * TENSIONS_MOST, RELAXATION_LOADS = CHAIN_WRENCH + RELAXATION_TENSIONS };

/* Numbers of the latter. */
int relaxation_tensions_of(const fingerfem_chain *chain);

/* A step: laws see factors x load - offsets of every load, with factors by component of a wrench, the last of tensions. */
typedef struct {
    const fingerfem_branches *branches;
    int elements, loads;
    double sum /* G */, factors[W + 1], offsets[RELAXATION_LOADS], kept[FINGERFEM_MOST_BRANCHES], grown[FINGERFEM_MOST_BRANCHES];
} relaxation_step;

/* A step of a length [s] from a relaxing state, (1 + branches, loads). */
void relaxation_begin(const fingerfem_chain *chain, const fingerfem_branches *branches, double length, const double *relaxing,
                      relaxation_step *step);

/* The tensions that laws see. */
void relaxation_tensions(const relaxation_step *step, const double *tensions, double *found);

/* Have the rods of a chain take the step. */
void relaxation_set(const relaxation_step *step, chain_rods *map);

/* The state at the step's end, in place, where elements carry their wrenches. */
void relaxation_end(const relaxation_step *step, const chain_rods *map, const double *tensions, double *relaxing);
#endif

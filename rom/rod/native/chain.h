/* Segments one after another: where all their plates are. Plates are rigid, so that one segment's plate clamps the next. */
#ifndef FINGERFEM_CHAIN_H
#define FINGERFEM_CHAIN_H
#include "rod_march.h"

enum {
    W = FINGERFEM_WRENCH,
    CHAIN_WRENCH = W * FINGERFEM_MOST_PLATES,
    CHAIN_INPUTS = CHAIN_WRENCH + TENSIONS_MOST /* wrenches, plate by plate, then tensions */
};
typedef double chain_matrix[CHAIN_WRENCH][CHAIN_WRENCH];

/* Segments at some tensions: how these bend every plate, and the rods; and memory to work in, of one segment at a time. */
typedef struct {
    const fingerfem_chain *chain;
    double corners[FINGERFEM_MOST_PLATES][FINGERFEM_CORNERS], *work;
    rod_state rods[FINGERFEM_MOST_PLATES];
} chain_rods;

/* A plate: what it bears, and where its segment alone has it, seen from that one's clamp; then where it is in space, and
 * its motion R^T dc, R^T dtheta by all inputs. */
typedef struct {
    double borne[W], arm[3], relative[9], by_tensions[W][TENSIONS_MOST];
    rod_end end;
    double centre[3], rotation[9], motion[W][CHAIN_INPUTS];
} chain_plate;
typedef struct {
    chain_plate plates[FINGERFEM_MOST_PLATES];
} chain_state;

/* All segments at tensions inside their box, in memory of fingerfem_chain_memory's size. For what bears wrenches they must
 * be contracted too. */
void chain_set_tensions(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found);
void chain_contract(const chain_rods *map);

/* The plates under wrenches, (6 plates), and their motions by these. */
void chain_under(const chain_rods *map, const double *wrench, chain_state *state);

/* The plates without a wrench: where they are, and their motions by the tensions. */
void chain_free(const chain_rods *map, chain_state *state);

/* The plates' motions by the variants of all elements, in the place of those by the tensions: under the wrenches that the plates
 * were placed under last, or, unless they are pressed, without. */
void chain_by_variants(const chain_rods *map, int pressed, chain_state *state);

/* The plates' motions by the tensions too, under the wrenches that they were placed under last. */
void chain_by_tensions(const chain_rods *map, chain_state *state);

/* All of it at tensions, which are clamped to their box as `held`, and wrenches; returns 1 if all inputs are inside. */
int chain_placed(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory, double *held,
                 chain_rods *map, chain_state *state);

/* How what a plate passes on to the one before changes, (6), in place, from how what it transmits does, as its motion relative
 * to that one changes, R^T dc and R^T dtheta, (6). */
void chain_pass_change(const chain_plate *plate, const double *motion, double *change);
#endif

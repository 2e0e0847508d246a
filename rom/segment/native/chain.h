/* Segments one after another: where all their plates are. Plates are rigid, so that one segment's plate clamps the next. */
#ifndef FINGERFEM_CHAIN_H
#define FINGERFEM_CHAIN_H
#include "map.h"

enum {
    W = FINGERFEM_WRENCH,
    CHAIN_WRENCH = W * FINGERFEM_MOST_PLATES,
    CHAIN_INPUTS = CHAIN_WRENCH + MAP_MOST_TENSIONS /* wrenches, plate by plate, then tensions */
};
typedef double chain_matrix[CHAIN_WRENCH][CHAIN_WRENCH];

/* Of every segment how some tensions bend its plate, their monomials, what was contracted for them, and memory for the
 * products of its wrench's polynomials; and memory to work in, of one segment at a time. */
typedef struct {
    const fingerfem_chain *chain;
    double corners[FINGERFEM_MOST_PLATES][FINGERFEM_CORNERS];
    const double *monomials[FINGERFEM_MOST_PLATES], *contracted[FINGERFEM_MOST_PLATES];
    double *products[FINGERFEM_MOST_PLATES], *work;
} chain_contracted;

/* A plate: what it bears, and where its segment alone has it, seen from that one's clamp; then where it is in space, and
 * its motion R^T dc, R^T dtheta by all inputs. */
typedef struct {
    double borne[W], pose[FINGERFEM_POSE], arm[3], relative[9];
    double by_wrench[W][W], by_tensions[W][MAP_MOST_TENSIONS];
    double centre[3], rotation[9], motion[W][CHAIN_INPUTS];
} chain_plate;
typedef struct {
    chain_plate plates[FINGERFEM_MOST_PLATES];
} chain_state;

/* The monomials of a segment's tensions, and how they bend its plate. */
void chain_bend(const fingerfem_chain *chain, int k, const double *tensions, double *monomials, chain_contracted *found);

/* Contract all segments at tensions inside their box, into memory of fingerfem_chain_memory's size. */
void chain_contract(const fingerfem_chain *chain, const double *tensions, double *memory, chain_contracted *found);

/* The plates under wrenches, (6 plates), and their motions by these. */
void chain_under(const chain_contracted *map, const double *wrench, chain_state *state);

/* The plates without a wrench: where they are, and their motions by the tensions. */
void chain_free(const chain_contracted *map, chain_state *state);

/* The plates' motions by the tensions too, under the wrenches that they were placed under last. */
void chain_by_tensions(const chain_contracted *map, chain_state *state);
#endif

/* Segments one after another: where their plates and loaded sections are. Plates are rigid, so that one segment's plate clamps
 * the next. */
#ifndef FINGERFEM_CHAIN_H
#define FINGERFEM_CHAIN_H
#include "rod_march.h"
#include "rod_weight.h"

enum {
    W = FINGERFEM_WRENCH,
    MOST_BODIES = FINGERFEM_MOST_BODIES,
    CHAIN_WRENCH = W * MOST_BODIES,
    CHAIN_PULL = TENSIONS_MOST, /* behind the wrenches: where the acceleration by weight begins, (3), seen from the tip */
    CHAIN_INPUTS = CHAIN_WRENCH + CHAIN_PULL + 3 /* wrenches, body by body, tensions, and that acceleration */
};
typedef double chain_matrix[CHAIN_WRENCH][CHAIN_WRENCH];

/* What may bear a wrench: a plate, the section where an element begins, or the ground, which is the clamp of the first
 * segment and does not move. */
enum { CHAIN_GROUND = -1 /* in place of a segment */ };
typedef struct {
    int segment;
    rod_part part; /* the elements between this body and the next one towards the clamp; a plate's begins with element 0 */
} chain_place;

/* A body where the chain weighs: its load; what weighs in its part; and how the load changes by the acceleration that the tip
 * sees, and by the tensions where that turns with the tip. */
typedef struct {
    double load[ROD_LOAD], by_pull[ROD_LOAD][3], by_tensions[ROD_LOAD][TENSIONS_MOST];
    rod_weight own;
} chain_load;

/* A chain that weighs: the acceleration that its tip sees, (3) [m/s^2]; how it changes with the tip's turn, (3, 3), where the inputs
 * change that too, and with the wrenches on `count` bodies, (3, 6 count), with the wrenches that it was found under; whether it
 * is found, and the chain rests there without contact. */
typedef struct {
    double pull[3], turning[9], by_wrench[3][CHAIN_INPUTS], wrench[CHAIN_WRENCH];
    int count, found, stable, unused; /* doubles follow */
    chain_load bodies[MOST_BODIES];
} chain_weight;

/* Segments at some tensions: how these bend every plate, and the rods; the bodies that bear wrenches, from clamp to tip,
 * all plates among them; and memory to work in, of one segment at a time. */
typedef struct {
    const fingerfem_chain *chain;
    double corners[FINGERFEM_MOST_PLATES][FINGERFEM_CORNERS], *work;
    rod_state rods[FINGERFEM_MOST_PLATES];
    chain_weight *weight; /* NULL if nothing weighs */
    int count;
    chain_place bodies[MOST_BODIES];
} chain_rods;

/* A body: what it transmits, and where its part of the rod alone has it, seen from where that ends; then where it is in
 * space, and its motion R^T dc, R^T dtheta by all inputs. */
typedef struct {
    double transmitted[W], arm[3], relative[9], by_tensions[W][TENSIONS_MOST];
    rod_end end;
    double centre[3], rotation[9], motion[W][CHAIN_INPUTS];
} chain_body;
typedef struct {
    chain_body bodies[MOST_BODIES];
} chain_state;

/* Tensions within the box that all segments have in common, (tensions); returns whether they all were. */
int chain_clamped(const fingerfem_chain *chain, const double *tensions, double *held);

/* All segments at tensions inside their box, in memory of fingerfem_chain_memory's size; plates alone bear wrenches. For what
 * carries wrenches they must be contracted too; `chain_free` does so itself if the chain weighs. */
void chain_set_tensions(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found);

/* The same without derivatives by the tensions, unless they differ by element. */
void chain_set_constant(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found);
void chain_contract(const chain_rods *map);

/* Plates alone as bodies. */
void chain_plates_alone(chain_rods *map);

/* The body of a segment's element, or of the ground; -1 if it is none. */
int chain_body_of(const chain_rods *map, int segment, int element);

/* Make the section where an element begins, or the ground, a body too; returns its number, or -1 if there is no room. The
 * numbers of those beyond it grow by one. */
int chain_add_body(chain_rods *map, int segment, int element);

/* Make every plate and section a body; returns 0 if there is no room. */
int chain_all_bodies(chain_rods *map);

/* The number of a plate, or of a body among the chain's loads: wrenches on the plates, then on the sections where the other
 * elements of each segment begin, from its plate to its clamp. */
int chain_plate_of(const chain_rods *map, int plate);
int chain_load_of(const chain_rods *map, int body);

/* Bodies that loads, (fingerfem_chain_loads), need, and their wrenches; returns 0 if there is no room for them. And back. */
int chain_take_loads(chain_rods *map, const double *loads, double *wrench);
void chain_leave_loads(const chain_rods *map, const double *wrench, double *loads);

/* Numbers of wrenches on all bodies. */
static inline int chain_size(const chain_rods *map) { return W * map->count; }

/* The bodies under wrenches, (6 bodies), and their motions by these; returns 0 if weight has no equilibrium there. */
int chain_under(const chain_rods *map, const double *wrench, chain_state *state);

/* The same where motions of an earlier pose do. */
int chain_again(const chain_rods *map, const double *wrench, chain_state *state);

/* The plates without a wrench: where they are, and their motions by the tensions; returns 0 if weight has no equilibrium, or
 * none that is stable. */
int chain_free(const chain_rods *map, chain_state *state);

/* The bodies' motions by the variants of all elements, in the place of those by the tensions: under the wrenches that the bodies
 * were placed under last, or, unless they are pressed, without. */
void chain_by_variants(const chain_rods *map, int pressed, chain_state *state);

/* The bodies' motions by the tensions too, under the wrenches that they were placed under last. */
void chain_by_tensions(const chain_rods *map, chain_state *state);

/* Where an element of a segment begins in space: place, (3) [m], and rotation, (3, 3). */
void chain_section(const chain_rods *map, const chain_state *state, int segment, int element, double *place, double *rotation);

/* All of it at tensions, which are clamped to their box as `held`, and loads; returns 1 if all inputs are inside. */
int chain_placed(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory, double *held,
                 chain_rods *map, chain_state *state);

/* How what a body passes on to the one before changes, (6), in place, from how what it transmits does, as its motion relative
 * to that one changes, R^T dc and R^T dtheta, (6). */
void chain_pass_change(const chain_body *body, const double *motion, double *change);
#endif

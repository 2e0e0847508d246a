/* Friction of rigid contacts in a MuJoCo model, see sticking.py and coulomb.py in control/mujoco/contact. */
#ifndef CONTROL_FRICTION_H
#define CONTROL_FRICTION_H
#include "engine.h"

/* Friction of a rigid contact: its geoms, where it is [m], and force along the surface and moment, along the world's axes [N, N m]. */
typedef struct {
    int32_t contact, geom[2], unused; /* doubles follow */
    double pos[3], force[2][3];
} control_stuck;

/* Begin a step about the last forces of the first `contacts` contacts with geoms that are `own`, (geoms): each about that of its
 * geoms' nearest one, among `count` of the step before. Returns the number of these contacts, which are put into `now`, (contacts). */
int control_stick_recall(const control_engine *engine, const uint8_t *own, int contacts, const control_stuck *before, int count,
                         control_stuck *now);

/* Note the forces of contacts, (count). */
void control_stick_note(const control_engine *engine, control_stuck *now, int count);

enum { CONTROL_SOLVES = 10 }; /* largest number of constraint solves in an iteration of Coulomb's law */

/* The correction of a contact's reference acceleration, from the original one, and its last change [m/s^2]. */
typedef struct {
    double wanted, correction, change;
} control_slip;

/* Correct reference accelerations of contacts with own geoms after a solve of the constraints, which have been `solved` times before.
 * `slips`, (contacts), and the share of a change that is applied are kept between. Returns 1 if no change exceeds `close` times
 * the reference. */
int control_slide(const control_engine *engine, const uint8_t *own, int solved, double close, control_slip *slips, double *share);
#endif

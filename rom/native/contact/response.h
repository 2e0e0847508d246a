/* Response of the bodies to forces at their contacts: C S, and what follows from it. */
#ifndef FINGERFEM_RESPONSE_H
#define FINGERFEM_RESPONSE_H
#include "../linear_algebra/small.h"
#include "contact.h"

/* G by the state's forces, and the factors of 1 - G C; returns 0 if that is singular. */
int response_find(const contact_problem *problem, contact_state *state);

/* S times wrenches on all bodies, and C S times them: the motion of all bodies. */
void response_soften(const contact_problem *problem, const contact_state *state, const double *wrench, double *out);
void response_move(const contact_problem *problem, const contact_state *state, const double *wrench, double *out);

/* Add what a force at contact k puts on all bodies. */
void response_press(const placed *at, int k, double force, double *wrench);

/* C S W_k: the motion of all bodies with a unit force at contact k, or the share of it that the balance sees; and those of SMALL_COLUMNS
 * contacts at most. */
void response_yields(const contact_problem *problem, const contact_state *state, int count, const int *rows, small_columns *motions);
static inline void response_yield(const contact_problem *problem, const contact_state *state, int k, double *out)
{
    double wrench[CHAIN_WRENCH] = {0.0};
    response_press(&state->at, k, problem->share * state->at.acting[k].slope, wrench);
    response_move(problem, state, wrench, out);
}

/* W_k . xi: how much the gap of contact k grows with a motion xi of all bodies. */
static inline double response_opening(const placed *at, int k, const double *motion)
{
    const contact_arms *arms = at->arms + k;
    double sum = 0.0;
    for (int a = 0; a < arms->count; a++)
        for (int i = 0; i < W; i++) sum += motion[W * arms->bodies[a] + i] * arms->wrenches[a][i];
    return sum;
}

/* Forces, (count), at some contacts, by which their gaps open as much as `wanted`, in place: solve
 * (W^T C S W + c) f = wanted, c the local compliances. Returns 0 if that is singular. */
int response_forces(const placed *at, int count, const int *rows, double (*columns)[CHAIN_WRENCH], double *wanted);

/* Linearise the indentation of all slices about a state's pose and forces, and find forces f >= 0, with gaps >= 0 and one of both zero at every
 * contact, by block principal pivoting, with Murty's least index (1974) where that does not end (Judice and Pires 1994): it
 * ends for every positive definite W^T C S W. Begins with those that press. Returns 0 if it found none. */
int response_balance(const contact_problem *problem, contact_state *state, double *forces);

/* By how much a unit force at another contact lowers contact k on rubber: the indentation there, and the deflection of its element between its
 * ends; at itself, without the indentation of its own slice [m/N]. */
double response_between(const placed *at, int k, int other);

/* The same of many pairs: what of a contact it depends on, once; a contact with itself is one address. */
typedef struct {
    const rubber_slice *slice; /* NULL of a plate, and nothing else has a meaning */
    int yields, number, element, face; /* face: name of a point on one, else -1 */
    double share, shear, held, softer, normal[2]; /* share: where in its element; shear, held: phi / 12 and 12 / (1 + phi), see slice_forces.c */
} response_local;
void response_see(const placed *at, int k, response_local *found);
double response_local_between(const response_local *k, const response_local *other);

/* The same with that, by the share of the slice that is pressed in: the local compliance [m/N]. */
static inline double response_compliance(const placed *at, int k, int other)
{
    return response_between(at, k, other) + (k == other ? at->contacts.compliance[k] / at->contacts.shares[k] : 0.0);
}

/* Linearise the indentation of all slices, which other forces lower by so much, (contacts) [m]: shares and lifts. */
void response_indent(objects_contacts *contacts, const double *others);

/* The indentation of contact k by all forces [m]. */
double response_indentation(const placed *at, const double *forces, int k);

/* How wrenches and bodies move with a tension, or with an object: drift is the motion at fixed wrenches, of the bodies, or
 * relative to the object `only`, which no others see; it is negative for all. Unless it is NULL, contacts' points of the plates
 * move by `bends`, (contacts, 3), besides. Contacts that press stay closed. What the wrenches of every object's contacts change
 * is (count, CHAIN_WRENCH). Returns 0 if nothing is known of it. */
int response_follow(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                    double *wrench_change, double (*by_object)[CHAIN_WRENCH]);

/* The wrenches of an object's contacts on all bodies. */
void response_wrenches(const contact_problem *problem, const contact_state *state, int object, double *wrench);

/* Whether the plates rest there: the stiffness K = 1/C - G is positive along all motions that keep the pressing contacts
 * closed. With A = W^T 1/K W over these, that is so where K and A have as many negative eigenvalues (Haynsworth 1968). */
int response_stable(const contact_problem *problem, const contact_state *state);
#endif

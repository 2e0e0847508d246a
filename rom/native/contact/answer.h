/* An answer at a solved state, see answer.c. */
#ifndef FINGERFEM_ANSWER_H
#define FINGERFEM_ANSWER_H
#include "reported.h"
#include "rubber.h"

/* The tip's displacement and every object's force, (3 + count), at a solved state. */
void answer_report(const contact_problem *problem, const contact_state *state, double *out);

/* How the tip and the force of every object change, (3 + count), and the plates and wrenches, `all`, with what moves the plates by
 * `drift` at fixed wrenches and bends them besides, or, without `bends`, moves them relative to the object `only`, see
 * response_follow. Returns 0 if nothing is known of it. */
int answer_change(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                  reported_change *all, double *found);

/* Derivatives of the tip and of all forces, by the tensions and by d of the objects with `d_moves`, and, unless
 * `by_object` is NULL, by the motion of every object, (6). Unless it is NULL, `changes`, (tensions + count), takes the
 * changes of all wrenches and poses by tensions and d. Returns 0 where the response is singular. */
int answer_derivatives(const contact_problem *problem, const contact_state *state, const double *d, const int *d_moves,
                       double *jacobian, double *by_object, reported_change *changes);

/* The point of the free plates that the object touches first: that of the contact with the least gap. */
void answer_touched(const contact_problem *problem, const placed *at, touched_point *first);

/* Touch distance of object j, and its derivatives by the tensions and by the object's motion, from the gap at the point
 * that is touched first: dg = n . dx - (n . e) dd = 0. */
void answer_touch(const contact_problem *problem, int j, const touched_point *first, double touch, double *out,
                  double *jacobian, double *by_object);
#endif

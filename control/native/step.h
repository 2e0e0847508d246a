/* What descent and null-space motion share: the step's linear problem, and moving on to the point ahead. */
#ifndef CONTROL_STEP_H
#define CONTROL_STEP_H
#include <stddef.h>
#include <string.h>
#include "least_squares.h"

static inline double control_clipped(double x, double lower, double upper)
{
    return x < lower ? lower : x > upper ? upper : x;
}

static inline void control_copy(const double *source, double *target, int n)
{
    memmove(target, source, (size_t)n * sizeof *source);
}

/* The largest change of a variable, over the bounds' width. */
double control_longest(const double *step, int n);

/* The square of the Jacobian's largest column. */
double control_largest_column(const control_workspace *w);

/* The step with the least |J s - right|^2 + damping |s|^2 over the free variables, by Householder reflections: normal
 * equations would square the condition. right has the first m entries and is used up. */
void control_solve_step(control_workspace *w, double damping);

/* The point ahead: a step on, no longer than `most`, within the bounds; and the step that this is. */
void control_look_ahead(control_workspace *w, double most);

/* Make the point ahead the one to go on from. */
void control_accept(control_workspace *w, double cost);

/* Null-space motion: of the points that solve a problem the one nearest to the reference point, by going on along
 * them. The motion there is projected on the directions that leave the residual as it is, and the residual corrected at
 * every step. */
void control_keep_nearest(control_workspace *w);
int control_null_space_step(control_workspace *w, const control_rules *rules);
int control_null_space_advance(control_workspace *w, const control_rules *rules, double cost);
#endif

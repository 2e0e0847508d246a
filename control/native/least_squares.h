/* Bounded Levenberg-Marquardt for a handful of unknowns: minimise |r(x)|^2 / 2 with lower <= x <= upper.
 *
 * The residual is asked for by returning: control_begin and control_advance leave a point in workspace.ahead; whoever
 * calls writes residual and Jacobian there and calls control_advance, which returns CONTROL_GOING until it is done. So
 * the same code serves the controllers and functions of Python (control.least_squares).
 */
#ifndef CONTROL_LEAST_SQUARES_H
#define CONTROL_LEAST_SQUARES_H
#include <stdint.h>

enum { CONTROL_GOING = 0, CONTROL_CONVERGED = 1, CONTROL_STATIONARY = 2, CONTROL_ITERATION_LIMIT = 3, CONTROL_OUTSIDE = 4 };

/* When to stop, see control.least_squares.Rules. */
typedef struct {
    double residual, longest, step, nearest;
    int32_t null_space_iterations, iterations;
} control_rules;

/* A problem of n variables and m residuals while it is solved. Steps are over the bounds' width; so are columns of the
 * Jacobian at x, but not of jacobian_ahead. */
typedef struct {
    int32_t n, m;
    double *x, *ahead;                   /* (n): the point so far, and where the residual is asked for */
    double *reference, *best;            /* (n): of many solutions the nearest to the reference point is wanted */
    double *lower, *upper, *width;       /* (n): bounds */
    double *r, *jacobian;                /* (m), (m, n): at x */
    double *r_ahead, *jacobian_ahead;    /* (m), (m, n): to be written by whoever calls */
    double *step, *last, *back;          /* (n): the step, the one before, the motion to the reference point */
    double *free;                        /* (n): 1 for variables that the step may change, else 0 */
    double *system, *right;              /* (m + n, n), (m + n): of the step's least-squares problem */
    double cost, damping, damping_growth;
    double away;                         /* squared distance of best from the reference point */
    double share;                        /* of the motion to the reference point that is tried at once */
    int32_t evaluations, solved_at;      /* so far; and how many until it was first solved, 0 if it is not */
} control_workspace;

/* Numbers of memory that a workspace needs. */
int control_workspace_size(int n, int m);

/* A workspace in memory of that size; its bounds are to be written next. */
void control_workspace_in(control_workspace *workspace, int n, int m, double *memory);

/* Ask for the residual at a start first. Start and reference point are moved into the bounds. */
void control_begin(control_workspace *workspace, const double *start, const double *reference);

/* Judge what was found at the point ahead, and look for the next: CONTROL_GOING, or why it is done and x the answer. */
int control_advance(control_workspace *workspace, const control_rules *rules);
#endif

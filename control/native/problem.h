/* A problem while it is solved: a finger, a workspace, and what the surrogate answered last. */
#ifndef CONTROL_PROBLEM_H
#define CONTROL_PROBLEM_H
#include <math.h>
#include "../../rom/native/evaluation.h"
#include "problems.h"
#include "step.h"

#define CONTROL_MOST_ROWS 6 /* of an answer: tip, contact force, touch distance, pad pressure */
#define CONTROL_MOST_COLUMNS 4 /* of error rates: tip, contact force, displacement, pad pressure */

typedef struct {
    const control_finger *finger;
    int tensions, parameters;
    double *point, *jacobian;      /* (parameters), (rows, parameters): asked for last */
    double out[CONTROL_MOST_ROWS];
    double *best, *other, *between; /* (tensions): the answer so far, and two more */
    control_workspace workspace;
} control_problem;

/* Numbers of memory that a problem with at most so many residuals needs. */
static inline int control_problem_size(const control_finger *finger, int residuals)
{
    const int p = finger->kernel->parameters, n = p - finger->kernel->has_obstacle;
    return p + CONTROL_MOST_ROWS * p + 3 * n + control_workspace_size(n, residuals);
}

/* A problem in memory of that size, within the finger's limits. */
static inline void control_problem_in(control_problem *problem, const control_finger *finger, int residuals,
                                      double *memory)
{
    const int p = finger->kernel->parameters, n = p - finger->kernel->has_obstacle;
    memset(memory, 0, (size_t)control_problem_size(finger, residuals) * sizeof *memory);
    problem->finger = finger;
    problem->tensions = n;
    problem->parameters = p;
    problem->point = memory;
    problem->jacobian = memory + p;
    problem->best = problem->jacobian + CONTROL_MOST_ROWS * p;
    problem->other = problem->best + n;
    problem->between = problem->other + n;
    control_workspace_in(&problem->workspace, n, residuals, problem->between + n);
    control_copy(finger->lower, problem->workspace.lower, n);
    control_copy(finger->upper, problem->workspace.upper, n);
}

/* Ask the surrogate for its answer and derivatives at tensions and a plane's distance. */
static inline void control_ask(control_problem *problem, const double *tensions, double distance)
{
    control_copy(tensions, problem->point, problem->tensions);
    if (problem->parameters > problem->tensions) problem->point[problem->tensions] = distance;
    fingerfem_answer(problem->finger->kernel, problem->point, problem->out, problem->jacobian);
}

/* Estimated error of the contact force [N] or pad pressure [Pa] that was asked for last, inside the box. */
static inline double control_force_error(const control_problem *problem)
{
    const control_finger *finger = problem->finger;
    double found[CONTROL_MOST_COLUMNS] = {0.0};
    fingerfem_contact_error(finger->kernel, finger->rates, finger->columns, finger->margin, problem->point,
                            problem->out[FINGERFEM_TOUCH], found);
    return found[finger->row == FINGERFEM_FORCE ? 1 : 3];
}

/* Tensions in problem->best that press with a force; the outcome has status, residual and evaluations. */
void control_hold_problem(control_problem *problem, const double *start, double target, double distance,
                          const control_rules *rules, control_outcome *outcome);
#endif

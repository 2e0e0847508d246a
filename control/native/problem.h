/* A problem while it is solved: a finger, a workspace, and what the surrogate answered last. */
#ifndef CONTROL_PROBLEM_H
#define CONTROL_PROBLEM_H
#include <math.h>
#include "../../rom/native/evaluation.h"
#include "../../rom/segment/native/segment.h"
#include "problems.h"
#include "step.h"

#define CONTROL_MOST_ROWS 6 /* of an answer: tip, contact force, touch distance, pad pressure */
#define CONTROL_MOST_COLUMNS 4 /* of error rates: tip, contact force, displacement, pad pressure */

typedef struct {
    const control_finger *finger;
    int tensions, parameters;
    double *point, *jacobian;      /* (parameters), (rows, parameters): asked for last, if `asked` */
    int asked;
    double out[CONTROL_MOST_ROWS];
    double wrench[FINGERFEM_WRENCH * FINGERFEM_MOST_PLATES]; /* on a touched chain's plates, where its next solve begins */
    int inside;                      /* whether that answer is known: within what was trained */
    double *best, *other, *between; /* (tensions): the answer so far, and two more */
    control_workspace workspace;
} control_problem;

/* Numbers of memory that a problem with at most so many residuals needs. */
static inline int control_problem_size(const control_finger *finger, int residuals)
{
    const int p = finger->parameters, n = p - finger->has_obstacle;
    return p + CONTROL_MOST_ROWS * p + 3 * n + control_workspace_size(n, residuals);
}

/* A problem in memory of that size, within the finger's limits. */
static inline void control_problem_in(control_problem *problem, const control_finger *finger, int residuals,
                                      double *memory)
{
    const int p = finger->parameters, n = p - finger->has_obstacle;
    memset(memory, 0, (size_t)control_problem_size(finger, residuals) * sizeof *memory);
    problem->finger = finger;
    problem->tensions = n;
    problem->parameters = p;
    memset(problem->wrench, 0, sizeof problem->wrench);
    problem->inside = 1;
    problem->asked = 0;
    problem->point = memory;
    problem->jacobian = memory + p;
    problem->best = problem->jacobian + CONTROL_MOST_ROWS * p;
    problem->other = problem->best + n;
    problem->between = problem->other + n;
    control_workspace_in(&problem->workspace, n, residuals, problem->between + n);
    control_copy(finger->lower, problem->workspace.lower, n);
    control_copy(finger->upper, problem->workspace.upper, n);
}

/* Ask the model for its answer and derivatives at tensions and an object's distance; asked the same again, they are kept. */
static inline void control_ask(control_problem *problem, const double *tensions, double distance)
{
    int known = problem->asked;
    for (int j = 0; j < problem->parameters; j++) {
        const double own = j < problem->tensions ? tensions[j] : distance;
        known &= problem->point[j] == own;
        problem->point[j] = own;
    }
    if (known) return;
    problem->asked = 1;
    const control_finger *finger = problem->finger;
    if (finger->touching) {
        int32_t inside;
        fingerfem_touch(finger->touching, problem->point, problem->wrench, problem->out, problem->jacobian, NULL,
                        &inside);
        problem->inside = inside;
    } else {
        fingerfem_answer(finger->kernel, problem->point, problem->out, problem->jacobian);
    }
}

/* Estimated error of the contact force [N] or pad pressure [Pa] that was asked for last, inside the box. */
static inline double control_force_error(const control_problem *problem)
{
    const control_finger *finger = problem->finger;
    double found[CONTROL_MOST_COLUMNS] = {0.0};
    if (finger->touching) return fingerfem_touch_error(finger->touching, problem->out, problem->jacobian);
    fingerfem_contact_error(finger->kernel, finger->rates, finger->columns, finger->margin, problem->point,
                            problem->out[FINGERFEM_TOUCH], found);
    return found[finger->row == FINGERFEM_FORCE ? 1 : 3];
}

/* Say of tensions in problem->best that were found at a distance where the model's answer is not known, that they are
 * outside. */
static inline void control_mark(control_problem *problem, double distance, control_outcome *outcome)
{
    if (!problem->finger->touching) return; /* a surrogate's box is within the limits of tensions and distance */
    control_ask(problem, problem->best, distance);
    const double gap = fingerfem_rubber_gap(problem->finger->touching, problem->point, problem->wrench);
    if (!problem->inside || gap < problem->finger->touching->chain->skin_error) outcome->status = CONTROL_OUTSIDE;
}

/* Tensions in problem->best that press with a force; the outcome has status, residual and evaluations. */
void control_hold_problem(control_problem *problem, const double *start, double target, double distance,
                          const control_rules *rules, control_outcome *outcome);
#endif

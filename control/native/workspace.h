/* A problem while it is solved: a finger, a workspace, and the model's last answer. */
#ifndef CONTROL_WORKSPACE_H
#define CONTROL_WORKSPACE_H
#include <math.h>
#include "../../rom/native/separated/evaluation.h"
#include "../../rom/native/segment.h"
#include "control.h"
#include "step.h"

#define CONTROL_MOST_ROWS 6 /* of an answer: tip, contact force, touch distance, pad pressure */
#define CONTROL_MOST_COLUMNS 4 /* of error rates: tip, contact force, displacement, pad pressure */

typedef struct {
    const control_finger *finger;
    int tensions, parameters;
    double *point, *jacobian;      /* (parameters), (rows, parameters): asked for last, if `asked` */
    int asked;
    double *memory;                     /* the model's */
    double out[CONTROL_MOST_ROWS];
    double loads[FINGERFEM_MOST_LOADS]; /* of a touched chain, where its next solve begins */
    int inside;                      /* whether that answer is within the trained domain */
    double *best, *other, *between; /* (tensions): the answer so far, and two more */
    control_workspace workspace;
} control_problem;

/* Numbers of memory that the models of a finger need. */
static inline int control_models_memory(const control_finger *finger)
{
    const int one = finger->touching ? fingerfem_chain_memory(finger->touching->chain) : 0;
    const int other = finger->kernel ? fingerfem_forms_memory(&finger->kernel->tables) : 0;
    return one > other ? one : other;
}

/* Numbers of memory that a problem with at most so many residuals needs. */
static inline int control_problem_size(const control_finger *finger, int residuals)
{
    const int p = finger->parameters, n = p - finger->has_obstacle;
    return p + CONTROL_MOST_ROWS * p + 3 * n + control_workspace_size(n, residuals) + control_models_memory(finger);
}

/* A problem in memory of that size, within the finger's limits. */
static inline void control_problem_in(control_problem *problem, const control_finger *finger, int residuals,
                                      double *memory)
{
    const int p = finger->parameters, n = p - finger->has_obstacle;
    const int own = control_problem_size(finger, residuals) - control_models_memory(finger);
    memset(memory, 0, (size_t)own * sizeof *memory);
    problem->memory = memory + own;
    problem->finger = finger;
    problem->tensions = n;
    problem->parameters = p;
    memset(problem->loads, 0, sizeof problem->loads);
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
    int same = problem->asked;
    for (int j = 0; j < problem->parameters; j++) {
        const double own = j < problem->tensions ? tensions[j] : distance;
        same &= problem->point[j] == own;
        problem->point[j] = own;
    }
    if (same) return;
    problem->asked = 1;
    const control_finger *finger = problem->finger;
    if (problem->finger->touching) {
        int32_t inside;
        fingerfem_touch(problem->finger->touching, problem->point, problem->memory, problem->loads, problem->out, problem->jacobian,
                        NULL, &inside);
        problem->inside = inside;
    } else {
        problem->inside = fingerfem_answer(finger->kernel, problem->point, problem->memory, problem->out, problem->jacobian);
    }
}

/* Estimated error of the contact force [N] or pad pressure [Pa] that was asked for last, inside the box. A touched segment is
 * solved once more, which takes some times as long as an answer: nothing that is iterated may ask for it. */
static inline double control_force_error(control_problem *problem)
{
    const control_finger *finger = problem->finger;
    double found[CONTROL_MOST_COLUMNS] = {0.0};
    if (problem->finger->touching) {
        double errors[3];
        fingerfem_touch_errors(problem->finger->touching, problem->point, problem->memory, problem->loads, errors);
        return errors[1];
    }
    fingerfem_contact_error(finger->kernel, finger->rates, finger->columns, finger->margin, problem->point,
                            problem->out[FINGERFEM_TOUCH], found);
    return found[finger->row == FINGERFEM_FORCE ? 1 : 3];
}

/* Whether tensions and a distance are within the trained domain. */
static inline int control_trained(control_problem *problem, const double *tensions, double distance)
{
    control_ask(problem, tensions, distance);
    return problem->inside;
}

/* Tensions in problem->best that press with a force; the outcome has status, residual and evaluations. If that is
 * outside the trained domain, the status is CONTROL_OUTSIDE. */
void control_hold_problem(control_problem *problem, const double *start, double target, double distance,
                          const control_rules *rules, control_outcome *outcome);

/* Distance of the plane from readings of contact forces; needs memory for a workspace of one unknown. */
void control_locate_problem(control_problem *problem, int readings, const double *tensions, const double *felt, double hint,
                            const control_rules *rules, double *memory, control_outcome *outcome);
#endif

/* The plane on which tensions press with forces that were felt: one variable, a residual for every reading. */
#include "problem.h"

/* Ask for one reading's force at a plane's distance; writes residual and slope. */
static void compare(control_problem *problem, const double *tensions, double felt, double distance, double *residual,
                    double *slope)
{
    control_ask(problem, tensions, distance);
    *residual = problem->out[FINGERFEM_FORCE] - felt;
    *slope = problem->jacobian[problem->parameters * FINGERFEM_FORCE + problem->tensions];
}

/* By whatever is asked at present. */
static void locate(control_problem *problem, int readings, const double *tensions, const double *felt, double hint,
                   const control_rules *rules, double *memory, control_outcome *outcome)
{
    const int n = problem->tensions;
    const double nearest = problem->finger->nearest, farthest = problem->finger->farthest;
    const double starts[] = {-1.0, 0.9, 0.5, 0.1}; /* of the path to where touch begins; first the hint */
    double touched = nearest, least = INFINITY, residual, slope;
    control_workspace w;
    control_workspace_in(&w, 1, readings, memory);
    for (int i = 0; i < readings; i++) {
        control_ask(problem, tensions + (ptrdiff_t)n * i, INFINITY);
        touched = fmax(touched, problem->out[FINGERFEM_TOUCH]);
    }
    w.lower[0] = nearest;
    w.upper[0] = fmin(touched, farthest);
    outcome->status = CONTROL_GOING;
    outcome->evaluations = 0;
    outcome->distance = nearest;
    for (int k = 0; k < 4 && outcome->status != CONTROL_CONVERGED; k++) {
        if (k == 0 && !isfinite(hint)) continue;
        const double start = k == 0 ? hint : nearest + starts[k] * (w.upper[0] - nearest);
        int status = CONTROL_GOING;
        double square = 0.0;
        control_begin(&w, &start, &start);
        while (status == CONTROL_GOING) {
            for (int i = 0; i < readings; i++)
                compare(problem, tensions + (ptrdiff_t)n * i, felt[i], w.ahead[0], w.r_ahead + i, w.jacobian_ahead + i);
            status = control_advance(&w, rules);
        }
        outcome->evaluations += readings * w.evaluations;
        for (int i = 0; i < readings; i++) square += w.r[i] * w.r[i];
        if (square < least) {
            least = square;
            outcome->status = status;
            outcome->distance = w.x[0];
        }
    }
    outcome->residual = sqrt(least / readings);
    for (int i = 0; i < readings; i++) {
        compare(problem, tensions + (ptrdiff_t)n * i, felt[i], outcome->distance, &residual, &slope);
        if (!control_trained(problem, tensions + (ptrdiff_t)n * i, outcome->distance)) outcome->status = CONTROL_OUTSIDE;
    }
}

/* What the errors of the forces make of the distance. */
static void weigh_errors(control_problem *problem, int readings, const double *tensions, const double *felt,
                         control_outcome *outcome)
{
    const int n = problem->tensions;
    double residual, slope;
    outcome->squared_slopes = outcome->weighted_error = 0.0;
    for (int i = 0; i < readings; i++) {
        compare(problem, tensions + (ptrdiff_t)n * i, felt[i], outcome->distance, &residual, &slope);
        outcome->squared_slopes += slope * slope;
        outcome->weighted_error += fabs(slope) * control_force_error(problem);
    }
}

void control_locate(const control_finger *finger, int readings, const double *tensions, const double *felt, double hint,
                    const control_rules *rules, double *memory, control_outcome *outcome)
{
    control_problem problem;
    control_problem_in(&problem, finger, 1, memory);
    locate(&problem, readings, tensions, felt, hint, rules, memory + control_problem_size(finger, 1), outcome);
    weigh_errors(&problem, readings, tensions, felt, outcome);
}

void control_grip(const control_finger *finger, const double *then, double felt, const double *present, double aim,
                  double distance, double gain, const control_rules *rules, double *memory, double *tensions,
                  control_outcome *outcome)
{
    double *own = memory + control_problem_size(finger, 1), expected = NAN;
    control_problem problem;
    control_problem_in(&problem, finger, 1, memory);
    if (isfinite(distance)) {
        control_ask(&problem, then, distance);
        expected = problem.out[FINGERFEM_FORCE];
    }
    if (felt > 0.0) {
        locate(&problem, 1, then, &felt, distance, rules, own, outcome);
        const double found = outcome->distance;
        distance = isfinite(distance) ? distance + gain * (found - distance) : found;
    }
    outcome->status = CONTROL_GOING;
    if (isfinite(distance)) {
        control_hold_problem(&problem, present, aim, distance, rules, outcome);
    }
    outcome->distance = distance;
    outcome->expected = expected;
    control_copy(problem.best, tensions, problem.tensions);
}

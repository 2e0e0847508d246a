/* Tensions that bring the tip to a point before a plane: four residuals.
 *
 * It begins where the finger is. If that does not lead there, it begins once more at the nearest node of the atlas.
 */
#include "problem.h"

#define PASSED 10.0 /* weight of passing the plane against missing the point, at first [-] */
#define HEAVIER 4.0 /* times that, where it was passed [-] */
#define NEARER 6 /* bisections back towards the plane */
#define SHIFTS 5 /* of the plane to stay before, as the weight gives a little */

/* How far the plane is passed [m]; NaN without an obstacle. */
static double passed(control_problem *problem, const double *tensions, double distance)
{
    control_ask(problem, tensions, INFINITY);
    return problem->out[FINGERFEM_TOUCH] - distance;
}

/* From problem->best on, before a plane that may be shifted. */
static int reach_from(control_problem *problem, const double *reference, const double *target, double plane, double weight,
                      const control_rules *rules)
{
    control_workspace *w = &problem->workspace;
    const int n = w->n, p = problem->parameters;
    int status = CONTROL_GOING;
    control_begin(w, problem->best, reference);
    while (status == CONTROL_GOING) {
        const double beyond = passed(problem, w->ahead, plane);
        for (int i = 0; i < 3; i++) w->r_ahead[i] = problem->out[FINGERFEM_TIP + i] - target[i];
        for (int i = 0; i < 3; i++) control_copy(problem->jacobian + p * i, w->jacobian_ahead + n * i, n);
        w->r_ahead[3] = beyond > 0.0 ? weight * beyond : 0.0;
        for (int j = 0; j < n; j++)
            w->jacobian_ahead[3 * n + j] = beyond > 0.0 ? weight * problem->jacobian[p * FINGERFEM_TOUCH + j] : 0.0;
        status = control_advance(w, rules);
    }
    control_copy(w->x, problem->best, n);
    return status;
}

/* Move problem->best, which leaves the plane, as near as may be to problem->between, which passes it. */
static int move_nearer(control_problem *problem, double distance)
{
    double *middle = problem->workspace.ahead;
    for (int k = 0; k < NEARER; k++) {
        for (int j = 0; j < problem->tensions; j++) middle[j] = 0.5 * (problem->best[j] + problem->between[j]);
        control_copy(middle, passed(problem, middle, distance) > 0.0 ? problem->between : problem->best,
                     problem->tensions);
    }
    passed(problem, problem->best, distance);
    return NEARER + 1;
}

/* How far the tip is from a target, as was asked for last [m]. */
static double missed(const control_problem *problem, const double *target)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double off = problem->out[FINGERFEM_TIP + i] - target[i];
        square += off * off;
    }
    return sqrt(square);
}

/* From a start; tensions in problem->best, status and residual in the outcome, to whose evaluations it adds. */
static void reach_before(control_problem *problem, const double *start, const double *reference, const double *target,
                         double distance, const control_rules *rules, control_outcome *outcome)
{
    int status = CONTROL_GOING;
    double plane = distance, beyond = 0.0, weight = 1.5, passing = PASSED;
    control_copy(start, problem->best, problem->tensions);
    for (int k = 0; k < SHIFTS; k++, weight *= 2.0, passing *= HEAVIER) {
        status = reach_from(problem, reference, target, plane, passing, rules);
        outcome->evaluations += problem->workspace.evaluations;
        beyond = passed(problem, problem->best, distance);
        if (!(beyond > 0.0)) {
            if (k > 0) outcome->evaluations += move_nearer(problem, distance);
            break;
        }
        control_copy(problem->best, problem->between, problem->tensions);
        plane -= weight * beyond + 0.05 * rules->residual;
    }
    outcome->residual = missed(problem, target);
    outcome->status = status;
    if (beyond > 0.0 && status == CONTROL_CONVERGED) outcome->status = CONTROL_STATIONARY;
    /* Shifted planes were missed, this one is not. */
    if (!(beyond > 0.0) && outcome->residual <= rules->residual) outcome->status = CONTROL_CONVERGED;
}

/* Node of the atlas nearest to the target before the plane; at rest if all pass it. */
static int reaching_node(const control_finger *finger, const double *target, double distance)
{
    int found = 0;
    double least = INFINITY;
    for (int k = 0; k < finger->atlas_nodes; k++) {
        if (finger->touch_distances[k] > distance) continue;
        double away = 0.0;
        for (int i = 0; i < 3; i++) {
            const double off = finger->tips[3 * k + i] - target[i];
            away += off * off;
        }
        if (away < least) {
            found = k;
            least = away;
        }
    }
    return found;
}

/* Where the plane is passed still: from tensions that leave it, as near to problem->best as may be. */
static void stay_before(control_problem *problem, const double *start, int anywhere, const double *target, double distance,
                        control_outcome *outcome)
{
    const control_finger *finger = problem->finger;
    const int n = problem->tensions;
    if (!(passed(problem, problem->best, distance) > 0.0)) return;
    const int node = reaching_node(finger, target, distance);
    const double *clear = anywhere ? finger->tensions + (ptrdiff_t)n * node : start;
    control_copy(problem->best, problem->between, n);
    for (int j = 0; j < n; j++) problem->best[j] = control_clipped(clear[j], problem->workspace.lower[j], problem->workspace.upper[j]);
    if (passed(problem, problem->best, distance) > 0.0) { /* all pass it */
        control_copy(problem->between, problem->best, n);
        return;
    }
    outcome->evaluations += move_nearer(problem, distance) + 1;
    outcome->residual = missed(problem, target);
    outcome->status = CONTROL_STATIONARY;
}

void control_reach(const control_finger *finger, const double *start, double change, const double *target,
                   double distance, const control_rules *rules, double *memory, double *tensions, control_outcome *outcome)
{
    control_problem problem;
    control_problem_in(&problem, finger, 4, memory);
    const int n = problem.tensions, anywhere = !isfinite(change);
    for (int j = 0; j < n && !anywhere; j++) {
        problem.workspace.lower[j] = fmax(start[j] - change, finger->lower[j]);
        problem.workspace.upper[j] = fmin(start[j] + change, finger->upper[j]);
    }
    outcome->evaluations = 0;
    reach_before(&problem, start, start, target, distance, rules, outcome);
    if (outcome->status != CONTROL_CONVERGED && anywhere) {
        const int node = reaching_node(finger, target, distance);
        const control_outcome first = *outcome;
        control_copy(problem.best, problem.other, n);
        const int passing = passed(&problem, problem.best, distance) > 0.0;
        reach_before(&problem, finger->tensions + (ptrdiff_t)n * node, start, target, distance, rules, outcome);
        const int better = outcome->residual <= first.residual && !(passed(&problem, problem.best, distance) > 0.0);
        if (outcome->status != CONTROL_CONVERGED && !passing && !better) {
            control_copy(problem.other, problem.best, n);
            outcome->status = first.status;
            outcome->residual = first.residual;
        }
    }
    stay_before(&problem, start, anywhere, target, distance, outcome);
    control_copy(problem.best, tensions, n);
}

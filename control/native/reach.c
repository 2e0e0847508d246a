/* Tensions that bring the tip to a point before a plane: four residuals, tip minus target and the weighted depth past
 * the plane.
 *
 * It starts at the present tensions. If that does not reach the target, it starts once more at the nearest node of
 * the atlas.
 */
#include "workspace.h"

#define PASSED 10.0 /* first weight of the depth past the plane [-] */
#define HEAVIER 4.0 /* factor of that weight after every try that passes the plane [-] */
#define NEARER 6 /* bisections back towards the plane */
#define SHIFTS 5 /* most tries: a finite weight gives way, so the plane is shifted towards the finger */

/* Depth by which the free finger passes the plane, touch distance minus distance [m]; NaN without an obstacle. */
static double passed(control_problem *problem, const double *tensions, double distance)
{
    control_ask(problem, tensions, INFINITY);
    return problem->out[FINGERFEM_TOUCH] - distance;
}

/* Least squares before a shifted plane, from problem->best, where the answer is left. Returns the status. */
static int reach_from(control_problem *problem, const double *reference, const double *target, double plane, double weight,
                      const control_rules *rules)
{
    control_workspace *w = &problem->workspace;
    const int n = w->n, p = problem->parameters;
    int status = CONTROL_GOING;
    control_begin(w, problem->best, reference);
    while (status == CONTROL_GOING) {
        const double beyond = passed(problem, w->ahead, plane);
        /* residuals 0 to 2: tip minus target [m], and their rows of the Jacobian */
        for (int i = 0; i < 3; i++) w->r_ahead[i] = problem->out[FINGERFEM_TIP + i] - target[i];
        for (int i = 0; i < 3; i++) control_copy(problem->jacobian + p * i, w->jacobian_ahead + n * i, n);
        /* residual 3: the weighted depth past the plane, 0 before it */
        w->r_ahead[3] = beyond > 0.0 ? weight * beyond : 0.0;
        for (int j = 0; j < n; j++)
            w->jacobian_ahead[3 * n + j] = beyond > 0.0 ? weight * problem->jacobian[p * FINGERFEM_TOUCH + j] : 0.0;
        status = control_advance(w, rules);
    }
    control_copy(w->x, problem->best, n);
    return status;
}

/* Bisection from problem->best, which stays before the plane, towards problem->between, which passes it: the last
 * point before the plane is left in problem->best. Returns the number of evaluations. */
static int move_nearer(control_problem *problem, double distance)
{
    double *middle = problem->workspace.ahead;
    for (int k = 0; k < NEARER; k++) {
        /* the middle replaces the end on its side of the plane */
        for (int j = 0; j < problem->tensions; j++) middle[j] = 0.5 * (problem->best[j] + problem->between[j]);
        control_copy(middle, passed(problem, middle, distance) > 0.0 ? problem->between : problem->best,
                     problem->tensions);
    }
    /* the model's answer at the final point */
    passed(problem, problem->best, distance);
    return NEARER + 1;
}

/* Distance of the tip from a target, in the model's last answer [m]. */
static double missed(const control_problem *problem, const double *target)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double off = problem->out[FINGERFEM_TIP + i] - target[i];
        square += off * off;
    }
    return sqrt(square);
}

/* Solve from a start, and shift the plane until the answer stays before the true one. The tensions are left in
 * problem->best, status and residual in the outcome; evaluations are added. */
static void reach_before(control_problem *problem, const double *start, const double *reference, const double *target,
                         double distance, const control_rules *rules, control_outcome *outcome)
{
    int status = CONTROL_GOING;
    double plane = distance, beyond = 0.0, weight = 1.5, passing = PASSED;
    control_copy(start, problem->best, problem->tensions);
    for (int k = 0; k < SHIFTS; k++, weight *= 2.0, passing *= HEAVIER) {
        /* solve before the shifted plane */
        status = reach_from(problem, reference, target, plane, passing, rules);
        outcome->evaluations += problem->workspace.evaluations;
        beyond = passed(problem, problem->best, distance);
        /* stop: before the true plane; if it was shifted, move back towards it */
        if (!(beyond > 0.0)) {
            if (k > 0) outcome->evaluations += move_nearer(problem, distance);
            break;
        }
        /* passed: shift the plane towards the finger by more than the depth */
        control_copy(problem->best, problem->between, problem->tensions);
        plane -= weight * beyond + 0.05 * rules->residual;
    }
    outcome->residual = missed(problem, target);
    outcome->status = status;
    /* past the plane nothing is converged */
    if (beyond > 0.0 && status == CONTROL_CONVERGED) outcome->status = CONTROL_STATIONARY;
    /* before the plane: only the tip's distance from the target counts */
    if (!(beyond > 0.0) && outcome->residual <= rules->residual) outcome->status = CONTROL_CONVERGED;
}

/* Node of the atlas with the tip nearest to the target, among those before the plane; the first one if all pass it. */
static int reaching_node(const control_finger *finger, const double *target, double distance)
{
    int found = 0;
    double least = INFINITY;
    for (int k = 0; k < finger->atlas_nodes; k++) {
        if (finger->touch_distances[k] > distance) continue;
        /* squared distance of the node's tip from the target [m^2] */
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

/* If problem->best still passes the plane: go from tensions before the plane towards it as far as possible. */
static void stay_before(control_problem *problem, const double *start, int anywhere, const double *target, double distance,
                        control_outcome *outcome)
{
    const control_finger *finger = problem->finger;
    const int n = problem->tensions;
    if (!(passed(problem, problem->best, distance) > 0.0)) return;
    /* tensions before the plane: the nearest node, or the start if changes are limited */
    const int node = reaching_node(finger, target, distance);
    const double *clear = anywhere ? finger->tensions + (ptrdiff_t)n * node : start;
    control_copy(problem->best, problem->between, n);
    for (int j = 0; j < n; j++) problem->best[j] = control_clipped(clear[j], problem->workspace.lower[j], problem->workspace.upper[j]);
    if (passed(problem, problem->best, distance) > 0.0) { /* all pass it */
        control_copy(problem->between, problem->best, n);
        return;
    }
    /* as near to the plane as possible, which need not be near the target */
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
    /* limited changes: bounds around the start */
    for (int j = 0; j < n && !anywhere; j++) {
        problem.workspace.lower[j] = fmax(start[j] - change, finger->lower[j]);
        problem.workspace.upper[j] = fmin(start[j] + change, finger->upper[j]);
    }
    outcome->evaluations = 0;
    reach_before(&problem, start, start, target, distance, rules, outcome);
    if (outcome->status != CONTROL_CONVERGED && anywhere) {
        /* not reached: once more from the nearest node of the atlas */
        const int node = reaching_node(finger, target, distance);
        const control_outcome first = *outcome;
        control_copy(problem.best, problem.other, n);
        const int passing = passed(&problem, problem.best, distance) > 0.0;
        reach_before(&problem, finger->tensions + (ptrdiff_t)n * node, start, target, distance, rules, outcome);
        /* the first answer again, if it stays before the plane and the second is no better */
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

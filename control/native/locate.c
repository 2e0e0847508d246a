/* The distance of the plane on which tensions press with measured forces: one unknown, a residual for every reading. */
#include "workspace.h"

/* One reading at a plane's distance: residual, the model's minus the measured force [N], and its slope [N/m]. */
static void compare(control_problem *problem, const double *tensions, double felt, double distance, double *residual,
                    double *slope)
{
    control_ask(problem, tensions, distance);
    *residual = problem->out[FINGERFEM_FORCE] - felt;
    *slope = problem->jacobian[problem->parameters * FINGERFEM_FORCE + problem->tensions];
}

/* Least squares over all readings from up to four starts; the answer of least residual counts. */
void control_locate_problem(control_problem *problem, int readings, const double *tensions, const double *felt, double hint,
                            const control_rules *rules, double *memory, control_outcome *outcome)
{
    const int n = problem->tensions;
    const double nearest = problem->finger->nearest, farthest = problem->finger->farthest;
    const double starts[] = {-1.0, 0.9, 0.5, 0.1}; /* shares of the way from nearest to touch; the first is the hint */
    double touched = nearest, least = INFINITY, residual, slope;
    control_workspace w;
    control_workspace_in(&w, 1, readings, memory);
    /* the farthest plane that any reading touches [m] */
    for (int i = 0; i < readings; i++) {
        control_ask(problem, tensions + (ptrdiff_t)n * i, INFINITY);
        touched = fmax(touched, problem->out[FINGERFEM_TOUCH]);
    }
    /* bounds of the distance */
    w.lower[0] = nearest;
    w.upper[0] = fmin(touched, farthest);
    outcome->status = CONTROL_GOING;
    outcome->evaluations = 0;
    outcome->distance = nearest;
    for (int k = 0; k < 4 && outcome->status != CONTROL_CONVERGED; k++) {
        /* the start: the hint, if there is one, or a share of the way to touch */
        if (k == 0 && !isfinite(hint)) continue;
        const double start = k == 0 ? hint : nearest + starts[k] * (w.upper[0] - nearest);
        int status = CONTROL_GOING;
        double square = 0.0;
        control_begin(&w, &start, &start);
        /* residuals and slopes of all readings, step by step */
        while (status == CONTROL_GOING) {
            for (int i = 0; i < readings; i++)
                compare(problem, tensions + (ptrdiff_t)n * i, felt[i], w.ahead[0], w.r_ahead + i, w.jacobian_ahead + i);
            status = control_advance(&w, rules);
        }
        outcome->evaluations += readings * w.evaluations;
        /* keep the answer with the least sum of squares */
        for (int i = 0; i < readings; i++) square += w.r[i] * w.r[i];
        if (square < least) {
            least = square;
            outcome->status = status;
            outcome->distance = w.x[0];
        }
    }
    /* root mean square of the residuals [N]; outside if any reading is */
    outcome->residual = sqrt(least / readings);
    for (int i = 0; i < readings; i++) {
        compare(problem, tensions + (ptrdiff_t)n * i, felt[i], outcome->distance, &residual, &slope);
        if (!control_trained(problem, tensions + (ptrdiff_t)n * i, outcome->distance)) outcome->status = CONTROL_OUTSIDE;
    }
}

/* Sums for the distance's error: of squared slopes, and of |slope| times the force's estimated error. */
static void weigh_errors(control_problem *problem, int readings, const double *tensions, const double *felt,
                         control_outcome *outcome)
{
    const int n = problem->tensions;
    double residual, slope;
    outcome->squared_slopes = outcome->weighted_error = 0.0;
    /* reading by reading, at the distance found */
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
    control_locate_problem(&problem, readings, tensions, felt, hint, rules, memory + control_problem_size(finger, 1), outcome);
    weigh_errors(&problem, readings, tensions, felt, outcome);
}

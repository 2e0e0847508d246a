/* Bounded Levenberg-Marquardt, see least_squares.h.
 *
 * Damping by the gain ratio (Nielsen, IMM-REP-1999-05, DTU 1999); bounds by projection, with the variables that the
 * gradient pushes against their bound left out of the step.
 */
#include <math.h>
#include "step.h"

int control_workspace_size(int n, int m)
{
    return 11 * n + 3 * m + 2 * m * n + (m + n) * n + n;
}

void control_workspace_in(control_workspace *w, int n, int m, double *memory)
{
    double **vectors[] = {&w->x, &w->ahead, &w->reference, &w->best, &w->lower, &w->upper, &w->width,
                          &w->step, &w->last, &w->back, &w->free};
    memset(memory, 0, (size_t)control_workspace_size(n, m) * sizeof *memory);
    w->n = n;
    w->m = m;
    /* vectors of n numbers */
    for (int k = 0; k < 11; k++) *vectors[k] = memory + k * n;
    memory += 11 * n;
    /* vectors of m numbers, then matrices */
    w->r = memory;
    w->r_ahead = memory + m;
    w->right = memory + 2 * m; /* m + n */
    w->jacobian = w->right + m + n;
    w->jacobian_ahead = w->jacobian + m * n;
    w->system = w->jacobian_ahead + m * n;
}

void control_begin(control_workspace *w, const double *start, const double *reference)
{
    const int n = w->n, m = w->m;
    /* widths of the bounds; start and reference point within them */
    for (int j = 0; j < n; j++) {
        w->width[j] = w->upper[j] > w->lower[j] ? w->upper[j] - w->lower[j] : 1.0;
        w->ahead[j] = control_clipped(start[j], w->lower[j], w->upper[j]);
        w->reference[j] = control_clipped(reference[j], w->lower[j], w->upper[j]);
    }
    /* no residual yet; the first step sets the damping */
    for (int i = 0; i < m; i++) w->r_ahead[i] = 0.0;
    for (int i = 0; i < m * n; i++) w->jacobian_ahead[i] = 0.0;
    w->cost = w->away = INFINITY;
    w->damping = -1.0;
    w->damping_growth = 2.0;
    w->share = 0.0;
    w->evaluations = w->solved_at = 0;
}

/* The cost that the linear model predicts ahead: |r + J s|^2 / 2. */
static double expected_cost(const control_workspace *w)
{
    double found = 0.0;
    /* row i of r + J s */
    for (int i = 0; i < w->m; i++) {
        double row = w->r[i];
        for (int j = 0; j < w->n; j++) row += w->jacobian[w->n * i + j] * w->step[j];
        found += 0.5 * row * row;
    }
    return found;
}

/* The next step and the point ahead; returns 0 if the gradient over the free variables vanishes. */
static int step_on(control_workspace *w, const control_rules *rules)
{
    double steepest = 0.0;
    /* gradient J^T r; variables that descent would push out of their bounds are held */
    for (int j = 0; j < w->n; j++) {
        double slope = 0.0;
        for (int i = 0; i < w->m; i++) slope += w->jacobian[w->n * i + j] * w->r[i];
        const int held = (w->x[j] <= w->lower[j] && slope >= 0.0) || (w->x[j] >= w->upper[j] && slope <= 0.0);
        w->free[j] = !held;
        if (!held && fabs(slope) > steepest) steepest = fabs(slope);
    }
    /* stop: |gradient| is 0 to rounding, relative to |r| */
    if (steepest <= 1e-14 * fmax(sqrt(2.0 * w->cost), 1e-300)) return 0;
    /* first damping: 1e-4 times the largest diagonal entry of J^T J */
    if (w->damping < 0.0) w->damping = 1e-4 * control_largest_column(w);
    /* step of least |J s + r|^2 + damping |s|^2, then shortened and clipped */
    for (int i = 0; i < w->m; i++) w->right[i] = -w->r[i];
    control_solve_step(w, w->damping);
    control_look_ahead(w, rules->longest);
    return 1;
}

/* Accept or refuse the point ahead, adapt the damping, and look for the next point. */
static int descend(control_workspace *w, const control_rules *rules, double cost)
{
    const int first = w->evaluations == 1;
    int settled = !first && control_longest(w->step, w->n) <= rules->step;
    if (first || cost < w->cost) { /* NaN is not below */
        settled = settled && w->cost - cost <= rules->step * w->cost;
        /* gain = actual / predicted decrease; damping *= max(0.1, 1 - (2 gain - 1)^3) */
        if (!first) {
            const double expected = w->cost - expected_cost(w);
            const double gain = expected > 0.0 ? (w->cost - cost) / expected : 0.0, off = 2.0 * gain - 1.0;
            w->damping *= fmax(0.1, 1.0 - off * off * off);
            w->damping_growth = 2.0;
        }
        control_accept(w, cost);
    } else {
        /* refused: damping grows by 2, 4, 8, ... */
        w->damping *= w->damping_growth;
        w->damping_growth *= 2.0;
    }
    /* stop: solved, no more progress, or too many evaluations */
    if (sqrt(2.0 * w->cost) <= rules->residual) return CONTROL_CONVERGED;
    if (settled) return CONTROL_STATIONARY;
    if (w->evaluations >= rules->iterations) return CONTROL_ITERATION_LIMIT;
    return step_on(w, rules) ? CONTROL_GOING : CONTROL_STATIONARY;
}

int control_advance(control_workspace *w, const control_rules *rules)
{
    double cost = 0.0;
    w->evaluations++;
    /* cost |r|^2 / 2 at the point ahead */
    for (int i = 0; i < w->m; i++) cost += 0.5 * w->r_ahead[i] * w->r_ahead[i];
    /* solved before: go on along the solutions */
    if (w->solved_at > 0) return control_null_space_advance(w, rules, cost);
    const int status = descend(w, rules, cost);
    if (status != CONTROL_CONVERGED) return status;
    /* solved for the first time: begin the null-space motion with the whole way to the reference */
    w->solved_at = w->evaluations;
    w->share = 1.0;
    for (int j = 0; j < w->n; j++) w->step[j] = 0.0;
    control_keep_nearest(w);
    return control_null_space_step(w, rules);
}

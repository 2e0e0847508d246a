/* Null-space motion towards the reference point, see step.h. */
#include <math.h>
#include "step.h"

#define LEAST_SHARE 0.0625 /* of the motion to the reference point that is tried at once [-] */
#define RANK 1e-10 /* share of the largest singular value, squared, below which a direction does not count [-] */

void control_keep_nearest(control_workspace *w)
{
    double away = 0.0;
    for (int j = 0; j < w->n; j++) {
        const double own = (w->x[j] - w->reference[j]) / w->width[j];
        away += own * own;
    }
    if (away < w->away) {
        w->away = away;
        control_copy(w->x, w->best, w->n);
    }
}

static int settle(control_workspace *w)
{
    control_copy(w->best, w->x, w->n);
    return CONTROL_CONVERGED;
}

int control_null_space_advance(control_workspace *w, const control_rules *rules, double cost)
{
    if (!isfinite(cost)) return settle(w);
    control_accept(w, cost);
    if (sqrt(2.0 * cost) <= rules->residual) control_keep_nearest(w);
    return control_null_space_step(w, rules);
}

/* The step towards the reference point over the free variables; the largest change that the whole motion asks for. */
static double projected_step(control_workspace *w, double damping)
{
    const int n = w->n, m = w->m;
    double longest = 0.0;
    for (int j = 0; j < n; j++) {
        const double change = w->free[j] != 0.0 ? (w->reference[j] - w->x[j]) / w->width[j] : 0.0;
        w->back[j] = w->share * change;
        if (fabs(change) > longest) longest = fabs(change);
    }
    for (int i = 0; i < m; i++) {
        w->right[i] = -w->r[i];
        for (int j = 0; j < n; j++) w->right[i] -= w->jacobian[n * i + j] * w->back[j];
    }
    control_solve_step(w, damping);
    for (int j = 0; j < n; j++) w->step[j] += w->back[j];
    return longest;
}

/* Hold variables that would leave their bounds; whether there were any. */
static int hold_at_bounds(control_workspace *w)
{
    int released = 0;
    for (int j = 0; j < w->n; j++) {
        const int down = w->x[j] <= w->lower[j] && w->step[j] < 0.0, up = w->x[j] >= w->upper[j] && w->step[j] > 0.0;
        if (w->free[j] != 0.0 && (down || up)) {
            w->free[j] = 0.0;
            released = 1;
        }
    }
    return released;
}

int control_null_space_step(control_workspace *w, const control_rules *rules)
{
    const int n = w->n;
    if (rules->nearest >= 1.0 || w->evaluations >= rules->iterations ||
        w->evaluations - w->solved_at >= rules->null_space_iterations)
        return settle(w);
    for (int j = 0; j < n; j++) w->free[j] = w->upper[j] > w->lower[j];
    const double damping = RANK * fmax(control_largest_column(w), 1e-300);
    control_copy(w->step, w->last, n);
    double away = 0.0;
    for (int round = 0; round < n; round++) {
        away = fmax(away, projected_step(w, damping));
        if (!hold_at_bounds(w)) break;
    }
    if (control_longest(w->step, n) <= rules->nearest * w->share * away) return settle(w);
    double turned = 0.0;
    for (int j = 0; j < n; j++) turned += w->step[j] * w->last[j];
    /* On a strongly curved surface the whole motion would swing from side to side. */
    if (turned < 0.0) w->share = fmax(0.5 * w->share, LEAST_SHARE);
    control_look_ahead(w, rules->longest);
    return CONTROL_GOING;
}

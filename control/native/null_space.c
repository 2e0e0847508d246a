/* Null-space motion towards the reference point, see step.h. */
#include <math.h>
#include "step.h"

#define LEAST_SHARE 0.0625 /* least share of the motion to the reference point in one step [-] */
#define RANK 1e-10 /* share of the largest singular value, squared, below which a direction does not count [-] */

void control_keep_nearest(control_workspace *w)
{
    /* squared distance from the reference point, over the bounds' width */
    double away = 0.0;
    for (int j = 0; j < w->n; j++) {
        const double own = (w->x[j] - w->reference[j]) / w->width[j];
        away += own * own;
    }
    /* the nearest solution so far */
    if (away < w->away) {
        w->away = away;
        control_copy(w->x, w->best, w->n);
    }
}

/* End at the nearest solution. */
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

/* Step over the free variables: a share of the motion to the reference point, projected on the null space of J, and the
 * correction of the residual. Returns the largest change by the whole motion, over the bounds' width. */
static double projected_step(control_workspace *w, double damping)
{
    const int n = w->n, m = w->m;
    double longest = 0.0;
    /* wanted motion: share (reference - x) / width of the free variables */
    for (int j = 0; j < n; j++) {
        const double change = w->free[j] != 0.0 ? (w->reference[j] - w->x[j]) / w->width[j] : 0.0;
        w->back[j] = w->share * change;
        if (fabs(change) > longest) longest = fabs(change);
    }
    /* right = -(r + J back): removes the residual, and what the motion would add to it */
    for (int i = 0; i < m; i++) {
        w->right[i] = -w->r[i];
        for (int j = 0; j < n; j++) w->right[i] -= w->jacobian[n * i + j] * w->back[j];
    }
    /* s of least |J s - right|; the step is back + s */
    control_solve_step(w, damping);
    for (int j = 0; j < n; j++) w->step[j] += w->back[j];
    return longest;
}

/* Hold variables at a bound that the step would take beyond it; returns whether there were any. */
static int hold_at_bounds(control_workspace *w)
{
    int released = 0;
    /* at the lower bound and downwards, or at the upper one and upwards */
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
    /* stop: any solution will do, or the evaluations are used up */
    if (rules->nearest >= 1.0 || w->evaluations >= rules->iterations ||
        w->evaluations - w->solved_at >= rules->null_space_iterations)
        return settle(w);
    /* all variables with a range are free; slight damping leaves out directions in which J is nearly singular */
    for (int j = 0; j < n; j++) w->free[j] = w->upper[j] > w->lower[j];
    const double damping = RANK * fmax(control_largest_column(w), 1e-300);
    control_copy(w->step, w->last, n);
    /* project again until no variable leaves its bound */
    double away = 0.0;
    for (int round = 0; round < n; round++) {
        away = fmax(away, projected_step(w, damping));
        if (!hold_at_bounds(w)) break;
    }
    /* stop: hardly any of the motion to the reference lies along the solutions */
    if (control_longest(w->step, n) <= rules->nearest * w->share * away) return settle(w);
    /* step . last step, negative after a reversal */
    double turned = 0.0;
    for (int j = 0; j < n; j++) turned += w->step[j] * w->last[j];
    /* smaller steps after a reversal: on a strongly curved set of solutions the whole motion would oscillate */
    if (turned < 0.0) w->share = fmax(0.5 * w->share, LEAST_SHARE);
    control_look_ahead(w, rules->longest);
    return CONTROL_GOING;
}

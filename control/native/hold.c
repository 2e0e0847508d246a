/* Tensions that press on a plane with a contact force: one residual.
 *
 * It begins where the finger is. If that does not lead to an answer, it begins again at points of the atlas: so a target
 * is called unreachable only after the whole box was looked at.
 */
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include "problem.h"

#define EVALUATIONS 12 /* from one start: an answer is near, or the start is no good */
#define CROSSING 12 /* bisections */
#define PASSING 1.0 /* gap of an object that the free finger passes by [m] */
#define NEARLY 0.8 /* of a target's force in the atlas, above which more than one of its nodes is tried [-] */
#define ATTEMPTS 5 /* from other nodes of the atlas */

/* Contact force [N]; before touch minus the stiffness of contact times the gap. There the force is zero whatever the
 * tensions, so that it has no gradient. The gap has one. */
static double signed_force(control_problem *problem, const double *tensions, double distance)
{
    control_ask(problem, tensions, distance);
    const control_finger *finger = problem->finger;
    double gap = distance - problem->out[FINGERFEM_TOUCH];
    if (!isfinite(gap)) gap = PASSING; /* no gradient: the atlas has the next start */
    return gap < 0.0 ? problem->out[finger->row] / finger->unit : -finger->stiffness * gap;
}

/* From one start to problem->best; returns the status, adds evaluations, and writes how much the target is missed by. */
static int hold_from(control_problem *problem, const double *start, const double *reference, double target,
                     double distance, const control_rules *rules, control_outcome *outcome)
{
    control_workspace *w = &problem->workspace;
    const control_finger *finger = problem->finger;
    control_rules own = *rules;
    int status = CONTROL_GOING;
    if (own.iterations > EVALUATIONS) own.iterations = EVALUATIONS;
    control_begin(w, start, reference);
    while (status == CONTROL_GOING) {
        w->r_ahead[0] = signed_force(problem, w->ahead, distance) - target;
        const int touches = distance < problem->out[FINGERFEM_TOUCH];
        const int row = touches ? finger->row : FINGERFEM_TOUCH;
        const double weight = touches ? 1.0 / finger->unit : finger->stiffness;
        for (int j = 0; j < w->n; j++) w->jacobian_ahead[j] = weight * problem->jacobian[problem->parameters * row + j];
        status = control_advance(w, &own);
    }
    control_copy(w->x, problem->best, w->n);
    control_ask(problem, w->x, distance);
    outcome->residual = fabs(problem->out[finger->row] / finger->unit - target);
    outcome->evaluations += w->evaluations;
    return outcome->residual <= rules->residual ? CONTROL_CONVERGED : status; /* as of a kink that it ended at */
}

/* Try from elsewhere, and keep what was best. */
static void hold_again(control_problem *problem, const double *start, const double *reference, double target,
                       double distance, const control_rules *rules, control_outcome *outcome)
{
    const double before = outcome->residual;
    control_copy(problem->best, problem->other, problem->tensions);
    outcome->status = hold_from(problem, start, reference, target, distance, rules, outcome);
    if (outcome->status == CONTROL_CONVERGED || outcome->residual <= before) return;
    control_copy(problem->other, problem->best, problem->tensions);
    outcome->status = CONTROL_STATIONARY;
    outcome->residual = before;
}

/* Write where the target is crossed between the gentlest tensions and some that press harder into problem->between: by
 * bisection, which finds it in a force that is neither monotone nor smooth. */
static void cross(control_problem *problem, const double *hard, double target, double distance)
{
    const double *lower = problem->finger->lower;
    double low = 0.0, high = 1.0;
    for (int k = 0; k < CROSSING; k++) {
        const double middle = 0.5 * (low + high);
        for (int j = 0; j < problem->tensions; j++) problem->between[j] = lower[j] + middle * (hard[j] - lower[j]);
        if (signed_force(problem, problem->between, distance) < target)
            low = middle;
        else
            high = middle;
    }
}

/* Nodes of the atlas to begin from: one of about the target's force and not far from the reference, of the least cost
 * above the last one's; and the hardest, of the most force below the last one's. */
typedef struct {
    int near, hard;
    double cost, force; /* of these two */
    double most;        /* force of all */
} candidates;

static candidates holding_nodes(const control_problem *problem, const double *reference, double target, double distance,
                                double cost, double force)
{
    const control_finger *finger = problem->finger;
    const double *width = problem->workspace.width;
    const int n = problem->tensions, last = finger->atlas_distances - 1;
    int below = 0;
    while (below < last - 1 && finger->distances[below + 1] <= distance) below++;
    const int above = below + 1 < last ? below + 1 : last;
    const double gap = finger->distances[above] - finger->distances[below];
    const double share = gap > 0.0 ? (distance - finger->distances[below]) / gap : 0.0;
    const double *low = finger->contact_forces + (ptrdiff_t)below * finger->atlas_nodes;
    const double *high = finger->contact_forces + (ptrdiff_t)above * finger->atlas_nodes;
    candidates found = {0, 0, INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < finger->atlas_nodes; k++) {
        double here = (1.0 - share) * low[k] + share * high[k];
        if (!(here > 0.0)) here = fmin((finger->touch_distances[k] - distance) * finger->stiffness, 0.0);
        if (here > found.most) found.most = here;
        if (here > found.force && here < force) {
            found.hard = k;
            found.force = here;
        }
        const double off = here / target - 1.0;
        double own = off * off;
        for (int j = 0; j < n; j++) {
            const double away = (finger->tensions[(ptrdiff_t)n * k + j] - reference[j]) / width[j];
            own += away * away;
        }
        if (own > cost && own < found.cost) {
            found.near = k;
            found.cost = own;
        }
    }
    return found;
}

/* By whatever is asked at present. */
static void hold(control_problem *problem, const double *start, double target, double distance,
                 const control_rules *rules, control_outcome *outcome)
{
    outcome->evaluations = 0;
    outcome->status = hold_from(problem, start, start, target, distance, rules, outcome);
    if (outcome->status == CONTROL_CONVERGED) return;
    double cost = -INFINITY, force = INFINITY, most = INFINITY;
    for (int attempt = 0; attempt < ATTEMPTS && outcome->status != CONTROL_CONVERGED; attempt++) {
        const candidates found = holding_nodes(problem, start, target, distance, cost, force);
        int node = found.hard;
        most = found.most;
        if (most < target && attempt > 0 && found.force < NEARLY * target) break;
        if (attempt % 2 == 0 && most >= target) { /* and the hardest ones in turns: a force may have several hills */
            node = found.near;
            cost = found.cost;
        } else {
            force = found.force;
        }
        const double *begun = problem->finger->tensions + (ptrdiff_t)problem->tensions * node;
        hold_again(problem, begun, start, target, distance, rules, outcome);
        if (outcome->status != CONTROL_CONVERGED && signed_force(problem, begun, distance) >= target) {
            cross(problem, begun, target, distance);
            outcome->evaluations += CROSSING;
            hold_again(problem, problem->between, start, target, distance, rules, outcome);
        }
    }
    /* Still creeping towards the hardest there is. */
    if (outcome->status == CONTROL_ITERATION_LIMIT && most < target) outcome->status = CONTROL_STATIONARY;
}

void control_hold_problem(control_problem *problem, const double *start, double target, double distance,
                          const control_rules *rules, control_outcome *outcome)
{
    hold(problem, start, target, distance, rules, outcome);
    int trained = control_trained(problem, problem->best, distance);
    if (!trained && outcome->status == CONTROL_CONVERGED) { /* nothing is trained near the start: the least tensions are the likeliest */
        const int evaluations = outcome->evaluations;
        hold(problem, problem->finger->lower, target, distance, rules, outcome);
        outcome->evaluations += evaluations;
        trained = control_trained(problem, problem->best, distance);
    }
    if (!trained) outcome->status = CONTROL_OUTSIDE;
}

int32_t control_memory(const control_finger *finger, int readings)
{
    enum { RESIDUALS = 4 }; /* most that a problem has */
    return control_problem_size(finger, RESIDUALS) + control_workspace_size(1, readings);
}

void control_hold(const control_finger *finger, const double *start, double target, double distance,
                  const control_rules *rules, double *memory, double *tensions, control_outcome *outcome)
{
    control_problem problem;
    control_problem_in(&problem, finger, 1, memory);
    control_hold_problem(&problem, start, target, distance, rules, outcome);
    control_ask(&problem, problem.best, distance);
    outcome->error = control_force_error(&problem);
    control_copy(problem.best, tensions, problem.tensions);
}

static int64_t now(void)
{
    struct timespec stamp;
    clock_gettime(CLOCK_MONOTONIC, &stamp);
    return (int64_t)1000000000 * stamp.tv_sec + stamp.tv_nsec;
}

void control_hold_many(const control_finger *finger, int count, const double *starts, double target,
                       const double *distances, const control_rules *rules, double *memory, double *tensions,
                       control_outcome *outcomes, int64_t *nanoseconds)
{
    control_problem problem;
    control_problem_in(&problem, finger, 1, memory);
    for (int i = 0; i < count; i++) {
        const ptrdiff_t row = (ptrdiff_t)problem.tensions * i;
        const int64_t before = now();
        control_hold_problem(&problem, starts + row, target, distances[i], rules, outcomes + i);
        nanoseconds[i] = now() - before;
        control_copy(problem.best, tensions + row, problem.tensions);
    }
}

/* Tensions that press on a plane with a contact force: one residual.
 *
 * It starts at the present tensions. If that finds no answer, it starts again at nodes of the atlas, which cover the
 * whole box: only then is a target unreachable.
 */
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include "workspace.h"

#define EVALUATIONS 12 /* most from one start: an answer is near, or the start is a bad one */
#define CROSSING 12 /* bisections of a line of tensions */
#define PASSING 1.0 /* gap in place of an infinite one, of an object beside the free finger's path [m] */
#define NEARLY 0.8 /* share of the target's force that further nodes must have, if none has all of it [-] */
#define ATTEMPTS 5 /* most starts at nodes of the atlas */

/* Contact force, or pad pressure over its unit [N]. Before touch it is 0 for all tensions and has no gradient: there
 * this is minus the stiffness of contact times the gap, which has one. */
static double signed_force(control_problem *problem, const double *tensions, double distance)
{
    control_ask(problem, tensions, distance);
    const control_finger *finger = problem->finger;
    double gap = distance - problem->out[FINGERFEM_TOUCH];
    if (!isfinite(gap)) gap = PASSING; /* no gradient: the atlas has the next start */
    return gap < 0.0 ? problem->out[finger->row] / finger->unit : -finger->stiffness * gap;
}

/* Least squares from one start. The answer is left in problem->best, and |force - target| is the outcome's residual
 * [N]; evaluations are added. Returns the status. */
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
        /* residual: signed force minus target [N] */
        w->r_ahead[0] = signed_force(problem, w->ahead, distance) - target;
        /* gradient: of force over unit in contact, else of stiffness times touch distance */
        const int touches = distance < problem->out[FINGERFEM_TOUCH];
        const int row = touches ? finger->row : FINGERFEM_TOUCH;
        const double weight = touches ? 1.0 / finger->unit : finger->stiffness;
        for (int j = 0; j < w->n; j++) w->jacobian_ahead[j] = weight * problem->jacobian[problem->parameters * row + j];
        status = control_advance(w, &own);
    }
    /* the answer, and how far its force is from the target */
    control_copy(w->x, problem->best, w->n);
    control_ask(problem, w->x, distance);
    outcome->residual = fabs(problem->out[finger->row] / finger->unit - target);
    outcome->evaluations += w->evaluations;
    return outcome->residual <= rules->residual ? CONTROL_CONVERGED : status; /* also where it ended at a kink */
}

/* Solve from another start, and keep the better answer of both. */
static void hold_again(control_problem *problem, const double *start, const double *reference, double target,
                       double distance, const control_rules *rules, control_outcome *outcome)
{
    const double before = outcome->residual;
    control_copy(problem->best, problem->other, problem->tensions);
    outcome->status = hold_from(problem, start, reference, target, distance, rules, outcome);
    /* the new answer is no worse */
    if (outcome->status == CONTROL_CONVERGED || outcome->residual <= before) return;
    /* else the old one again */
    control_copy(problem->other, problem->best, problem->tensions);
    outcome->status = CONTROL_STATIONARY;
    outcome->residual = before;
}

/* Bisection for the target on the line from the lowest tensions to some that press harder; the force need be neither
 * monotone nor smooth. The last point is left in problem->between. */
static void cross(control_problem *problem, const double *hard, double target, double distance)
{
    const double *lower = problem->finger->lower;
    double low = 0.0, high = 1.0;
    for (int k = 0; k < CROSSING; k++) {
        /* halve the interval of the line that crosses the target */
        const double middle = 0.5 * (low + high);
        for (int j = 0; j < problem->tensions; j++) problem->between[j] = lower[j] + middle * (hard[j] - lower[j]);
        if (signed_force(problem, problem->between, distance) < target)
            low = middle;
        else
            high = middle;
    }
}

/* Nodes of the atlas to start from. `near` has about the target's force and is not far from the reference: the least
 * cost above a given one, that of the last such node. `hard` has the most force below a given one, likewise. */
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
    /* the distances of the atlas around the present one, and the share of the farther */
    int below = 0;
    while (below < last - 1 && finger->distances[below + 1] <= distance) below++;
    const int above = below + 1 < last ? below + 1 : last;
    const double gap = finger->distances[above] - finger->distances[below];
    const double share = gap > 0.0 ? (distance - finger->distances[below]) / gap : 0.0;
    /* contact forces of all nodes at both distances [N] */
    const double *low = finger->contact_forces + (ptrdiff_t)below * finger->atlas_nodes;
    const double *high = finger->contact_forces + (ptrdiff_t)above * finger->atlas_nodes;
    candidates found = {0, 0, INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < finger->atlas_nodes; k++) {
        /* interpolated force of the node; before touch minus stiffness times gap */
        double here = (1.0 - share) * low[k] + share * high[k];
        if (!(here > 0.0)) here = fmin((finger->touch_distances[k] - distance) * finger->stiffness, 0.0);
        /* the hardest of all nodes, and the hardest below the given force */
        if (here > found.most) found.most = here;
        if (here > found.force && here < force) {
            found.hard = k;
            found.force = here;
        }
        /* cost: (force / target - 1)^2 + squared distance from the reference, over the bounds' width */
        const double off = here / target - 1.0;
        double own = off * off;
        for (int j = 0; j < n; j++) {
            const double away = (finger->tensions[(ptrdiff_t)n * k + j] - reference[j]) / width[j];
            own += away * away;
        }
        /* the node of least cost above the given one */
        if (own > cost && own < found.cost) {
            found.near = k;
            found.cost = own;
        }
    }
    return found;
}

/* Solve from the start, then from nodes of the atlas until one leads to the target. */
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
        /* stop: no node has the target's force, and no further one comes near it */
        if (most < target && attempt > 0 && found.force < NEARLY * target) break;
        if (attempt % 2 == 0 && most >= target) { /* in turns with hard nodes: the force may have several maxima */
            node = found.near;
            cost = found.cost;
        } else {
            force = found.force;
        }
        /* from the node; if it presses harder than the target, then from the crossing before it */
        const double *begun = problem->finger->tensions + (ptrdiff_t)problem->tensions * node;
        hold_again(problem, begun, start, target, distance, rules, outcome);
        if (outcome->status != CONTROL_CONVERGED && signed_force(problem, begun, distance) >= target) {
            cross(problem, begun, target, distance);
            outcome->evaluations += CROSSING;
            hold_again(problem, problem->between, start, target, distance, rules, outcome);
        }
    }
    /* no node has the target's force: the search was still on its way to the largest one */
    if (outcome->status == CONTROL_ITERATION_LIMIT && most < target) outcome->status = CONTROL_STATIONARY;
}

void control_hold_problem(control_problem *problem, const double *start, double target, double distance,
                          const control_rules *rules, control_outcome *outcome)
{
    hold(problem, start, target, distance, rules, outcome);
    int trained = control_trained(problem, problem->best, distance);
    if (!trained && outcome->status == CONTROL_CONVERGED) { /* outside: the least tensions are most likely trained */
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
    /* estimated error of the force at the answer */
    control_ask(&problem, problem.best, distance);
    outcome->error = control_force_error(&problem);
    control_copy(problem.best, tensions, problem.tensions);
}

/* Monotonic time [ns]. */
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
    /* one problem after another, timed */
    for (int i = 0; i < count; i++) {
        const ptrdiff_t row = (ptrdiff_t)problem.tensions * i;
        const int64_t before = now();
        control_hold_problem(&problem, starts + row, target, distances[i], rules, outcomes + i);
        nanoseconds[i] = now() - before;
        control_copy(problem.best, tensions + row, problem.tensions);
    }
}

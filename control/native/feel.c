/* Contact felt through tendons: errors-in-variables least squares. The tensions F are variables too, besides the unknowns q, so
 * that tensions and shortenings count alike, whichever of them the motors set:
 *
 *     min  sum ((s(F, q) - s_m) / sigma_s)^2 + sum ((F - F_m) / sigma_F)^2 + sum ((q - q_e) / sigma_q)^2.
 */
#include "feel.h"
#include <math.h>
#include <string.h>
#include "../../rom/native/linear_algebra/small.h"

enum {
    TENDONS = FINGERFEM_MOST_TENSIONS,
    OBJECTS = FINGERFEM_MOST_OBJECTS,
    VARIABLES = TENDONS + OBJECTS,
    REPORTED = FINGERFEM_QUATERNION + TENDONS
};

#define NEARLY 8.0 /* range of a tension around the measured one, in standard deviations [-] */
#define DAMPING 1.0 /* first damping: less than the information in what was expected, 12 over a range [-] */
#define APART 0.02 /* share of its range by which an unknown differs in another minimum [-] */

static const double SHARES[] = {0.8, 0.4, 0.1}; /* starts: shares of the ranges */
enum { STARTS = sizeof SHARES / sizeof *SHARES };

/* A problem while it is solved: the model's answer at the variables that it was asked for last. */
typedef struct {
    const control_felt *felt;
    const control_measured *measured;
    int tendons, unknowns, variables, residuals, inside, asked;
    double *memory, *loads;                   /* the model's; of the objects, where its next solve begins */
    double at[VARIABLES], shortenings[TENDONS], changes[TENDONS * VARIABLES];
    double forces[OBJECTS], by_variables[OBJECTS * VARIABLES];
    control_workspace workspace;
} feel_problem;

int32_t control_feel_memory(const control_felt *felt)
{
    const int n = felt->chain->tensions + felt->unknowns, m = felt->chain->tensions + n;
    return control_workspace_size(n, m) + fingerfem_chain_loads(felt->chain) + fingerfem_chain_memory(felt->chain);
}

/* A problem in memory of that size. */
static void problem_in(feel_problem *problem, const control_felt *felt, const control_measured *measured, double *memory)
{
    const int t = felt->chain->tensions, n = t + felt->unknowns;
    problem->felt = felt;
    problem->measured = measured;
    problem->tendons = t;
    problem->unknowns = felt->unknowns;
    problem->variables = n;
    problem->residuals = t + n;
    problem->asked = 0;
    control_workspace_in(&problem->workspace, n, t + n, memory);
    memcpy(problem->workspace.lower, felt->lower, (size_t)n * sizeof *felt->lower);
    memcpy(problem->workspace.upper, felt->upper, (size_t)n * sizeof *felt->upper);
    /* tensions stay near the measured ones, so that all variables have about the same scale in standard deviations */
    for (int i = 0; i < t; i++) {
        const double near = NEARLY * measured->tension_deviations[i];
        problem->workspace.lower[i] = fmax(felt->lower[i], measured->tensions[i] - near);
        problem->workspace.upper[i] = fmin(felt->upper[i], measured->tensions[i] + near);
    }
    problem->loads = memory + control_workspace_size(n, t + n);
    problem->memory = problem->loads + fingerfem_chain_loads(felt->chain);
}

/* The finger before objects: shortenings, forces, and their derivatives by tensions and every d. */
static void ask_objects(feel_problem *problem)
{
    const fingerfem_touching *touching = problem->felt->touching;
    const int t = problem->tendons, m = touching->count, n = problem->variables;
    double out[FINGERFEM_MOST_ROWS_TOUCHED], jacobian[FINGERFEM_MOST_ROWS_TOUCHED * VARIABLES];
    double rows[REPORTED], changes[REPORTED * VARIABLES], errors[FINGERFEM_REPORT_ERRORS];
    const fingerfem_report report = {rows, changes, errors};
    int32_t inside;
    const int found = fingerfem_evaluate(touching, problem->at, problem->memory, problem->loads, out, jacobian, NULL, &inside, &report);
    problem->inside = inside;
    /* no equilibrium: the next solve begins without contact */
    if (found <= 0) memset(problem->loads, 0, (size_t)fingerfem_chain_loads(touching->chain) * sizeof *problem->loads);
    memcpy(problem->shortenings, rows + FINGERFEM_QUATERNION, (size_t)t * sizeof *rows);
    memcpy(problem->changes, changes + n * FINGERFEM_QUATERNION, (size_t)(t * n) * sizeof *changes);
    memcpy(problem->forces, out + 3, (size_t)m * sizeof *out);
    memcpy(problem->by_variables, jacobian + 3 * n, (size_t)(m * n) * sizeof *jacobian);
    for (int i = 0; i < t && found <= 0; i++) problem->shortenings[i] = NAN;
}

/* The model's answer at some variables; asked the same again, it is kept. */
static void ask(feel_problem *problem, const double *variables)
{
    const control_felt *felt = problem->felt;
    const size_t size = (size_t)problem->variables * sizeof *variables;
    const double *unknowns = problem->at + problem->tendons;
    if (problem->asked && !memcmp(problem->at, variables, size)) return;
    problem->asked = 1;
    memcpy(problem->at, variables, size);
    if (felt->touching) ask_objects(problem);
    else
        problem->inside = fingerfem_chain_point_force(felt->chain, problem->at, unknowns[0], unknowns + 1, problem->memory,
                                                      problem->shortenings, problem->changes);
}

/* Residuals over their standard deviations, and their Jacobian, at the point ahead. */
static void compare(feel_problem *problem)
{
    control_workspace *w = &problem->workspace;
    const control_measured *measured = problem->measured;
    const int t = problem->tendons, n = problem->variables;
    ask(problem, w->ahead);
    memset(w->jacobian_ahead, 0, (size_t)(n * w->m) * sizeof(double));
    for (int i = 0; i < t; i++) {
        /* (s - s_m) / sigma_s */
        w->r_ahead[i] = (problem->shortenings[i] - measured->shortenings[i]) / measured->shortening_deviations[i];
        for (int j = 0; j < n; j++) w->jacobian_ahead[n * i + j] = problem->changes[n * i + j] / measured->shortening_deviations[i];
        /* (F - F_m) / sigma_F */
        w->r_ahead[t + i] = (w->ahead[i] - measured->tensions[i]) / measured->tension_deviations[i];
        w->jacobian_ahead[n * (t + i) + i] = 1.0 / measured->tension_deviations[i];
    }
    /* (q - q_e) / sigma_q */
    for (int k = 0; k < problem->unknowns; k++) {
        w->r_ahead[2 * t + k] = (w->ahead[t + k] - measured->expected[k]) / measured->deviations[k];
        w->jacobian_ahead[n * (2 * t + k) + t + k] = 1.0 / measured->deviations[k];
    }
}

/* Ranges of the objects' distances end where each touches the finger at the measured tensions: beyond, nothing is felt. */
static void end_at_touch(feel_problem *problem)
{
    control_workspace *w = &problem->workspace;
    const fingerfem_touching *touching = problem->felt->touching;
    const int t = problem->tendons, m = touching->count;
    double point[VARIABLES], out[FINGERFEM_MOST_ROWS_TOUCHED], jacobian[FINGERFEM_MOST_ROWS_TOUCHED * VARIABLES];
    int32_t inside;
    /* free finger: no object is there */
    memcpy(point, problem->measured->tensions, (size_t)t * sizeof *point);
    for (int j = 0; j < m; j++) point[t + j] = INFINITY;
    fingerfem_touch(touching, point, problem->memory, problem->loads, out, jacobian, NULL, &inside);
    for (int j = 0; j < m; j++) w->upper[t + j] = fmax(w->lower[t + j], fmin(w->upper[t + j], out[3 + m + j]));
}

/* Whether an unknown differs between two states by more than a share of its range. */
static int differ(const feel_problem *problem, const double *one, const double *other)
{
    int found = 0;
    for (int i = problem->tendons; i < problem->variables; i++)
        found |= fabs(one[i] - other[i]) > APART * problem->workspace.width[i];
    return found;
}

/* Solve from a start, (variables), and keep the two different answers of least sums of squares of what is measured. */
static void solve_from(feel_problem *problem, const double *start, const control_rules *rules, control_feeling *feeling)
{
    control_workspace *w = &problem->workspace;
    const size_t size = (size_t)problem->variables * sizeof *start;
    int status = CONTROL_GOING;
    double square = 0.0;
    memset(problem->loads, 0, (size_t)fingerfem_chain_loads(problem->felt->chain) * sizeof *problem->loads);
    control_begin(w, start, start);
    w->damping = DAMPING;
    while (status == CONTROL_GOING) {
        compare(problem);
        status = control_advance(w, rules);
    }
    feeling->evaluations += w->evaluations;
    for (int i = 0; i < 2 * problem->tendons; i++) square += w->r[i] * w->r[i];
    const int differs = !isfinite(feeling->chi_square) || differ(problem, w->x, feeling->variables);
    if (square < feeling->chi_square) {
        /* the least so far: what was it before is another one, if it differs */
        if (differs) {
            feeling->other_chi_square = feeling->chi_square;
            memcpy(feeling->other, feeling->variables, size);
        }
        feeling->chi_square = square;
        feeling->status = status;
        memcpy(feeling->variables, w->x, size);
    } else if (differs && square < feeling->other_chi_square) {
        feeling->other_chi_square = square;
        memcpy(feeling->other, w->x, size);
    }
}

/* Whether a variable is known: its range has no width. */
static int known(const feel_problem *problem, int i) { return !(problem->workspace.upper[i] > problem->workspace.lower[i]); }

/* The information matrix J^T J of the first rows of the Jacobian ahead, (n, n), in units of standard deviations: of the measured
 * tensions, and of what was expected of the unknowns. Zero for known ones. */
static void information(const feel_problem *problem, int rows, double *found)
{
    const control_workspace *w = &problem->workspace;
    const int n = problem->variables, t = problem->tendons;
    double unit[VARIABLES];
    for (int i = 0; i < n; i++) unit[i] = i < t ? problem->measured->tension_deviations[i] : problem->measured->deviations[i - t];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0.0;
            for (int k = 0; k < rows; k++) sum += w->jacobian_ahead[n * k + i] * w->jacobian_ahead[n * k + j];
            found[n * i + j] = known(problem, i) || known(problem, j) ? 0.0 : sum * unit[i] * unit[j];
        }
}

/* Axes of the unknowns by the measurements alone: eigenvectors of A_qq - A_qF A_FF^-1 A_Fq, which is left of their information
 * A where the tensions are not exact; and roots of its eigenvalues. */
static void find_axes(const feel_problem *problem, control_feeling *feeling)
{
    const int t = problem->tendons, k = problem->unknowns, n = problem->variables;
    double all[VARIABLES * VARIABLES], tensions[TENDONS * TENDONS], right[TENDONS * OBJECTS], own[OBJECTS * OBJECTS],
        vectors[OBJECTS * OBJECTS], trace = 1.0;
    information(problem, 2 * t, all);
    /* A_FF^-1 A_Fq */
    for (int i = 0; i < t; i++) {
        for (int j = 0; j < t; j++) tensions[t * i + j] = all[n * i + j];
        for (int j = 0; j < k; j++) right[k * i + j] = all[n * i + t + j];
    }
    small_solve(t, tensions, k, right);
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < k; j++) {
            own[k * i + j] = all[n * (t + i) + t + j];
            for (int l = 0; l < t; l++) own[k * i + j] -= all[n * (t + i) + l] * right[k * l + j];
        }
        trace += own[k * i + i];
    }
    /* what is known needs no measurement: it counts as seen */
    for (int i = 0; i < k; i++)
        if (known(problem, t + i)) own[k * i + i] = trace;
    small_eigen(k, own, vectors);
    for (int i = 0; i < k; i++) {
        feeling->visible[i] = sqrt(fmax(own[k * i + i], 0.0));
        for (int j = 0; j < k; j++) feeling->axes[k * i + j] = vectors[k * j + i];
    }
}

/* The covariance C of all variables, the inverse of the information of all rows; and that of the forces, G C G^T, with their
 * derivatives G. */
static void find_covariances(const feel_problem *problem, control_feeling *feeling)
{
    const int t = problem->tendons, n = problem->variables, m = problem->felt->touching ? problem->felt->touching->count : 0;
    const control_measured *measured = problem->measured;
    double all[VARIABLES * VARIABLES], *found = feeling->covariance;
    information(problem, problem->workspace.m, all);
    for (int i = 0; i < n; i++) {
        if (known(problem, i)) all[n * i + i] = 1.0; /* and has no variance */
        for (int j = 0; j < n; j++) found[n * i + j] = i == j && !known(problem, i);
    }
    small_solve(n, all, n, found);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            found[n * i + j] *= (i < t ? measured->tension_deviations[i] : measured->deviations[i - t]) *
                                (j < t ? measured->tension_deviations[j] : measured->deviations[j - t]);
    /* of the forces */
    for (int a = 0; a < m; a++)
        for (int b = 0; b < m; b++) {
            double sum = 0.0;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) sum += problem->by_variables[n * a + i] * found[n * i + j] * problem->by_variables[n * b + j];
            feeling->force_covariance[m * a + b] = sum;
        }
}

void control_feel(const control_felt *felt, const control_measured *measured, const double *hint, double limit,
                  const control_rules *rules, double *memory, control_feeling *feeling)
{
    feel_problem problem;
    control_workspace *w = &problem.workspace;
    double start[VARIABLES];
    problem_in(&problem, felt, measured, memory);
    const int t = problem.tendons, n = problem.variables;
    feeling->chi_square = feeling->other_chi_square = INFINITY;
    feeling->status = CONTROL_ITERATION_LIMIT;
    feeling->evaluations = 0;
    memset(feeling->variables, 0, (size_t)n * sizeof(double));
    if (felt->touching) end_at_touch(&problem);
    /* from the hint; then from shares of the ranges; with the measured tensions */
    memcpy(start, measured->tensions, (size_t)t * sizeof *start);
    if (hint) {
        memcpy(start + t, hint, (size_t)felt->unknowns * sizeof *start);
        solve_from(&problem, start, rules, feeling);
    }
    for (int k = 0; k < STARTS && !(hint && feeling->chi_square <= limit); k++) {
        for (int i = t; i < n; i++) start[i] = w->lower[i] + SHARES[k] * (w->upper[i] - w->lower[i]);
        solve_from(&problem, start, rules, feeling);
    }
    /* the model's answer at the estimate, and what is known of it */
    memcpy(w->ahead, feeling->variables, (size_t)n * sizeof *start);
    compare(&problem);
    feeling->inside = problem.inside;
    memcpy(feeling->forces, problem.forces, (felt->touching ? (size_t)felt->touching->count : 0) * sizeof *start);
    find_axes(&problem, feeling);
    find_covariances(&problem, feeling);
}

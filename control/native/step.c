/* The step of a damped least-squares problem, see step.h. */
#include <math.h>
#include "step.h"

double control_longest(const double *step, int n)
{
    double found = 0.0;
    for (int j = 0; j < n; j++)
        if (fabs(step[j]) > found) found = fabs(step[j]);
    return found;
}

double control_largest_column(const control_workspace *w)
{
    /* max_j sum_i J_ij^2 */
    double found = 0.0;
    for (int j = 0; j < w->n; j++) {
        double square = 0.0;
        for (int i = 0; i < w->m; i++) square += w->jacobian[w->n * i + j] * w->jacobian[w->n * i + j];
        if (square > found) found = square;
    }
    return found;
}

/* Householder reflection of column j onto its diagonal entry, applied to later columns and the right-hand side. */
static void reflect(double *system, double *right, int rows, int n, int j)
{
    /* alpha = -sign(diagonal) |column|, which avoids cancellation in the vector v */
    double norm = 0.0;
    for (int i = j; i < rows; i++) norm += system[n * i + j] * system[n * i + j];
    norm = sqrt(norm);
    const double alpha = system[n * j + j] > 0.0 ? -norm : norm;
    const double head = system[n * j + j] - alpha; /* the reflection's vector is the column less alpha in row j */
    /* |v|^2; below the diagonal the column is v */
    double square = head * head;
    for (int i = j + 1; i < rows; i++) square += system[n * i + j] * system[n * i + j];
    system[n * j + j] = alpha;
    if (square <= 0.0) return;
    for (int k = j + 1; k <= n; k++) { /* k = n is the right-hand side */
        double *column = k < n ? system + k : right;
        const int stride = k < n ? n : 1;
        /* column -= v 2 (v . column) / |v|^2 */
        double along = head * column[stride * j];
        for (int i = j + 1; i < rows; i++) along += system[n * i + j] * column[stride * i];
        along *= 2.0 / square;
        column[stride * j] -= along * head;
        for (int i = j + 1; i < rows; i++) column[stride * i] -= along * system[n * i + j];
    }
}

void control_solve_step(control_workspace *w, double damping)
{
    const int n = w->n, m = w->m;
    const double weight = fmax(sqrt(damping), 1e-150);
    double *system = w->system, *right = w->right;
    /* rows of J, with columns of 0 for variables that are not free */
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++) system[n * i + j] = w->free[j] != 0.0 ? w->jacobian[n * i + j] : 0.0;
    /* rows of sqrt(damping) I, and 1 for variables that are not free */
    for (int i = 0; i < n; i++) {
        right[m + i] = 0.0;
        for (int j = 0; j < n; j++) system[n * (m + i) + j] = 0.0;
        system[n * (m + i) + i] = w->free[i] != 0.0 ? weight : 1.0;
    }
    /* QR factorisation: system becomes upper triangular, right becomes Q^T right */
    for (int j = 0; j < n; j++) reflect(system, right, m + n, n, j);
    /* back substitution: solve U s = right, with the triangle U */
    for (int j = n - 1; j >= 0; j--) {
        double found = right[j];
        for (int k = j + 1; k < n; k++) found -= system[n * j + k] * w->step[k];
        w->step[j] = w->free[j] != 0.0 ? found / system[n * j + j] : 0.0;
    }
}

void control_look_ahead(control_workspace *w, double most)
{
    const double shrink = fmin(1.0, most / fmax(control_longest(w->step, w->n), 1e-300));
    /* the shortened step, clipped to the bounds; the step is what remains of it */
    for (int j = 0; j < w->n; j++) {
        w->ahead[j] = control_clipped(w->x[j] + shrink * w->step[j] * w->width[j], w->lower[j], w->upper[j]);
        w->step[j] = (w->ahead[j] - w->x[j]) / w->width[j];
    }
}

void control_accept(control_workspace *w, double cost)
{
    w->cost = cost;
    control_copy(w->ahead, w->x, w->n);
    control_copy(w->r_ahead, w->r, w->m);
    /* columns of the Jacobian times the bounds' width */
    for (int i = 0; i < w->m; i++)
        for (int j = 0; j < w->n; j++) w->jacobian[w->n * i + j] = w->jacobian_ahead[w->n * i + j] * w->width[j];
}

/* Rows of a report, the tip's orientation and the tendons' shortenings, and their derivatives. */
#include "reported.h"
#include <math.h>
#include "../rod/shortenings.h"

enum { QUATERNION = FINGERFEM_QUATERNION };

/* A rotation, (3, 3), as unit quaternion w, x, y, z with w >= 0, from its largest component (Shepperd 1978,
 * doi:10.2514/3.55767b): 4 q_i q_j are sums and differences of the matrix's numbers. */
static void quaternion_of(const double *r, double *q)
{
    /* row i of the matrix 4 q q^T from the numbers of the rotation */
    const double squares[QUATERNION] = {1.0 + r[0] + r[4] + r[8], 1.0 + r[0] - r[4] - r[8], 1.0 - r[0] + r[4] - r[8],
                                        1.0 - r[0] - r[4] + r[8]}; /* 4 q_i^2 */
    const double wx = r[7] - r[5], wy = r[2] - r[6], wz = r[3] - r[1], xy = r[1] + r[3], xz = r[2] + r[6], yz = r[5] + r[7];
    const double products[QUATERNION][QUATERNION] = {
        {squares[0], wx, wy, wz}, {wx, squares[1], xy, xz}, {wy, xy, squares[2], yz}, {wz, xz, yz, squares[3]}};
    /* row of the largest q_i^2, and its length */
    int largest = 0;
    double square = 0.0;
    for (int i = 1; i < QUATERNION; i++)
        if (squares[i] > squares[largest]) largest = i;
    for (int i = 0; i < QUATERNION; i++) square += products[largest][i] * products[largest][i];
    /* q = row / |row|, with the sign of w >= 0 */
    const double scale = (products[largest][0] < 0.0 ? -1.0 : 1.0) / sqrt(square);
    for (int i = 0; i < QUATERNION; i++) q[i] = scale * products[largest][i];
}

/* Change of a quaternion with a turn in its own frame, R^T dtheta: dq = q (0, R^T dtheta) / 2. */
static void quaternion_change(const double *q, const double *turn, double *change)
{
    const double w = q[0], *v = q + 1;
    /* dw = -v . t / 2, dv = (w t + v x t) / 2 */
    change[0] = -0.5 * (v[0] * turn[0] + v[1] * turn[1] + v[2] * turn[2]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        change[1 + i] = 0.5 * (w * turn[i] + v[j] * turn[l] - v[l] * turn[j]);
    }
}

void reported_rows(const contact_problem *problem, const contact_state *state, int free, const reported_change *changes,
                   const fingerfem_report *report)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const int t = chain->tensions, p = t + problem->touching->count, tip = contact_size(problem) - W;
    double *shortenings = report->rows + QUATERNION;
    shortenings_segment segments[MOST_BODIES];
    const int known = shortenings_of(problem->map, free, segments);
    /* values: orientation of the tip's plate; shortenings, NaN without laws of these */
    quaternion_of(state->at.chain.bodies[problem->map->count - 1].rotation, report->rows);
    if (known) shortenings_together(problem->map, segments, shortenings);
    for (int j = 0; j < t && !known; j++) shortenings[j] = NAN;
    /* column c of the Jacobian, by a tension or by an object's d */
    for (int c = 0; c < p; c++) {
        double by_tensions[TENSIONS_MOST + FINGERFEM_MOST_OBJECTS] = {0.0}, column[QUATERNION + TENSIONS_MOST];
        by_tensions[c] = 1.0; /* the last ones are of objects, and of no tension */
        quaternion_change(report->rows, changes[c].motion + tip + 3, column);
        for (int j = 0; j < t; j++) column[QUATERNION + j] = NAN;
        if (known)
            shortenings_change(&state->at.chain, problem->map, segments, by_tensions, changes[c].wrench, changes[c].motion,
                               column + QUATERNION);
        for (int i = 0; i < QUATERNION + t; i++) report->jacobian[p * i + c] = column[i];
    }
}

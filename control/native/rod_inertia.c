/* The coupling of both ends of a rod with cubic shapes, see control/mujoco/rod.py. */
#include "rod_inertia.h"

/* Kinetic energy m p . C (q - p): velocities of begin and end, p as points of the clamp, q as points of the plate. */
static const double C[2][2] = {{10.0 / 420.0, 31.0 / 420.0}, {3.0 / 420.0, 10.0 / 420.0}};

/* out = linear + angular x arm */
static void at_point(const double *angular, const double *linear, const double *arm, double *out)
{
    out[0] = linear[0] + angular[1] * arm[2] - angular[2] * arm[1];
    out[1] = linear[1] + angular[2] * arm[0] - angular[0] * arm[2];
    out[2] = linear[2] + angular[0] * arm[1] - angular[1] * arm[0];
}

/* A point on a body's x axis: its arm from the centre that MuJoCo's spatial vectors refer to [m], and its
 * acceleration by the first `count` velocities of the path, at joint accelerations 0 [m/s^2]. */
static void point_on(const control_rod *rod, int body, double x, int count, double *arm, double *acceleration)
{
    const double *velocity = rod->cvel + 6 * body;
    double change[6] = {0.0}, moving[3], turning[3];
    /* arm from the tree's centre of mass */
    for (int i = 0; i < 3; i++)
        arm[i] = rod->xpos[3 * body + i] + x * rod->xmat[9 * body + 3 * i] - rod->subtree_com[3 * rod->root + i];
    /* angular and linear acceleration sum_k cdof_dot_k qvel_k */
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 6; i++) change[i] += rod->cdof_dot[6 * rod->path[k] + i] * rod->qvel[rod->path[k]];
    /* velocity v of the point; its acceleration is linear + angular x arm + omega x v */
    at_point(velocity, velocity + 3, arm, moving);
    at_point(change, change + 3, arm, turning);
    at_point(velocity, turning, moving, acceleration);
}

void control_couple(const control_rod *rod, const double *gravity)
{
    const int n = rod->n, base = n - rod->own;
    const double x[2] = {rod->begin, rod->end - rod->length};
    double *clamp = rod->memory, *relative = clamp + 6 * n; /* (n, 6): velocities p and q - p by those of the path */
    double arms[2][6], accelerations[2][6], load[6], back[6];
    for (int e = 0; e < 2; e++) { /* begin and end */
        /* arms and accelerations of the end's points on both bodies */
        point_on(rod, rod->clamp, x[0] + e * rod->length, base, arms[0] + 3 * e, accelerations[0] + 3 * e);
        point_on(rod, rod->plate, x[1] + e * rod->length, n, arms[1] + 3 * e, accelerations[1] + 3 * e);
        /* velocities p and q - p of the end by every velocity; the plate's own do not move p */
        for (int k = 0; k < n; k++) {
            const double *dof = rod->cdof + 6 * rod->path[k];
            double *p = clamp + 6 * k + 3 * e, *q = relative + 6 * k + 3 * e;
            p[0] = p[1] = p[2] = 0.0;
            if (k < base) at_point(dof, dof + 3, arms[0] + 3 * e, p);
            at_point(dof, dof + 3, arms[1] + 3 * e, q);
            for (int i = 0; i < 3; i++) q[i] -= p[i];
        }
    }

    /* loads of begin and end [N]: m C^T (dp/dt - gravity) on q - p, m C (dq/dt - dp/dt) on p */
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++) {
            load[3 * e + i] = back[3 * e + i] = 0.0;
            for (int f = 0; f < 2; f++) {
                const double *p = accelerations[0] + 3 * f, *q = accelerations[1] + 3 * f;
                load[3 * e + i] += rod->mass * C[f][e] * (p[i] - gravity[i]);
                back[3 * e + i] += rod->mass * C[e][f] * (q[i] - p[i]);
            }
        }
    /* qfrc_bias_k += (q - p)_k . load + p_k . back, for every velocity k */
    for (int k = 0; k < n; k++)
        for (int i = 0; i < 6; i++)
            rod->qfrc_bias[rod->path[k]] += relative[6 * k + i] * load[i] + clamp[6 * k + i] * back[i];

    /* M += m p C (q - p) and its transpose; a row of M begins with the path up to its velocity */
    for (int k = 0; k < n; k++)
        for (int j = 0; j <= k && j < base; j++) {
            const double *pk = clamp + 6 * k, *pj = clamp + 6 * j, *qk = relative + 6 * k, *qj = relative + 6 * j;
            double sum = 0.0;
            for (int e = 0; e < 2; e++)
                for (int f = 0; f < 2; f++)
                    for (int i = 0; i < 3; i++)
                        sum += C[e][f] * (pj[3 * e + i] * qk[3 * f + i] + pk[3 * e + i] * qj[3 * f + i]);
            rod->M[rod->rows[k] + j] += rod->mass * sum;
        }
}

/* A body of mass m, with the first moment s = m c and the moments J about its centre p, all in its frame, loads the finger by
 *
 *     F = -(m A + al x s + om x (om x s)),    M = -(J al + om x J om + s x A),
 *
 * with the acceleration A = R^T p'' of its centre, its angular velocity om and acceleration al, in its frame. They follow from
 * its pose at the end of the step by the generalised-alpha method on the Lie group R^3 x SO(3) (Bruels and Cardona, J. Comput.
 * Nonlinear Dyn. 5, 2010). With D = (p - p_0) / h, or log(R_0^T R) / h of the turn,
 *
 *     a = (D - v_0 - (1/2 - beta) h a_0) / (beta h),             v = v_0 + h ((1 - gamma) a_0 + gamma a),
 *     v' = ((1 - mean_mass) a + mean_mass a_0 - mean_force v'_0) / (1 - mean_force).
 *
 * The method remembers a, and would push a body that an object leaves. So the wrench r of contact is no part of a and v', but
 * acts in each step alone (as in Kane, Repetto, Ortiz and Marsden, Comput. Methods Appl. Mech. Eng. 180, 1999):
 *
 *     p = p_a + h^2 / 2 r / M,    v = v_a + h r / M,
 *
 * where p_a and v_a are by a alone. Its work is r (p - p_0) <= 0, as gaps close in a step or stay closed. With the whole way in D
 * above, what elements balance is -M v' + contact r, with contact = (1 - mean_mass) / (2 beta (1 - mean_force)). Then pressing
 * contacts keep no velocity along their normals n, as in an impact without a rebound: v -= W (W^T W / M)^-1 W^T v / M.
 */
#include "inertia.h"
#include "../linear_algebra/small.h"

enum { PLACE = 0, TURN = 3, VELOCITY = 12, CHANGE = 18, MEAN = 24 }; /* of a body's FINGERFEM_MOVING numbers: p, R, v, v', a */

#define LITTLE 1e-8 /* sine of an angle below which its axis is not divided by it [-] */

void inertia_method(double radius, contact_step *step)
{
    step->mean_mass = (2.0 * radius - 1.0) / (radius + 1.0);
    step->mean_force = radius / (radius + 1.0);
    step->gamma = 0.5 + step->mean_force - step->mean_mass;
    step->beta = 0.25 * (step->gamma + 0.5) * (step->gamma + 0.5);
    step->contact = 0.5 * (1.0 - step->mean_mass) / ((1.0 - step->mean_force) * step->beta);
}

/* The rotation vector of R_0^T R, (3) [rad]: less than half a turn. */
static void turn_between(const double *from, const double *to, double *found)
{
    double rotation[9], sine = 0.0, trace = -1.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = from[i] * to[j] + from[3 + i] * to[3 + j] + from[6 + i] * to[6 + j];
    /* 2 sin(phi) along the axis, 2 cos(phi) = trace - 1 */
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        found[i] = 0.5 * (rotation[3 * k + j] - rotation[3 * j + k]);
        sine += found[i] * found[i];
        trace += rotation[4 * i];
    }
    sine = sqrt(sine);
    const double factor = sine > LITTLE ? atan2(sine, 0.5 * trace) / sine : 1.0;
    for (int i = 0; i < 3; i++) found[i] *= factor;
}

void inertia_moving(const contact_step *step, const double *begun, const chain_body *body, double *moving)
{
    const double h = step->length, share = 1.0 - step->mean_force;
    double way[W];
    for (int i = 0; i < 3; i++) way[i] = body->centre[i] - begun[PLACE + i];
    turn_between(begun + TURN, body->rotation, way + 3);
    memcpy(moving + PLACE, body->centre, sizeof body->centre);
    memcpy(moving + TURN, body->rotation, sizeof body->rotation);
    for (int i = 0; i < W; i++) {
        const double v = begun[VELOCITY + i], before = begun[MEAN + i];
        const double a = (way[i] / h - v - (0.5 - step->beta) * h * before) / (step->beta * h);
        moving[VELOCITY + i] = v + h * ((1.0 - step->gamma) * before + step->gamma * a);
        moving[CHANGE + i] = ((1.0 - step->mean_mass) * a + step->mean_mass * before - step->mean_force * begun[CHANGE + i]) / share;
        moving[MEAN + i] = a;
    }
}

int inertia_accelerate(const fingerfem_inertia *inertia, int load, double *wrench)
{
    const double m = inertia->masses[load], *s = inertia->moments + 3 * load, *J = inertia->inertias + 9 * load;
    double mass[W * W] = {0.0};
    /* M = (m, -s x; s x, J) */
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        mass[W * i + i] = m;
        mass[W * i + 3 + j] = s[k];
        mass[W * i + 3 + k] = -s[j];
        mass[W * (3 + i) + j] = -s[k];
        mass[W * (3 + i) + k] = s[j];
        for (int l = 0; l < 3; l++) mass[W * (3 + i) + 3 + l] = J[3 * i + l];
    }
    return small_solve(W, mass, 1, wrench);
}

void inertia_leave_contact(const contact_step *step, const double *change, double *moving)
{
    const double share = (1.0 - step->mean_mass) / (1.0 - step->mean_force), h = step->length, *R = moving + TURN;
    /* with change = r / M: a -= change / (2 beta), v' likewise, v += h change - gamma h change / (2 beta); those of the centre in space */
    for (int i = 0; i < W; i++) {
        const double own = i < 3 ? objects_dot(R + 3 * i, change) : change[i], taken = 0.5 * own / step->beta;
        moving[MEAN + i] -= taken;
        moving[CHANGE + i] -= share * taken;
        moving[VELOCITY + i] += h * (own - step->gamma * taken);
    }
}

void inertia_add_velocity(const double *change, double *moving)
{
    for (int i = 0; i < W; i++) moving[VELOCITY + i] += i < 3 ? objects_dot(moving + TURN + 3 * i, change) : change[i];
}

double inertia_velocity_along(const double *wrench, const double *moving)
{
    const double *R = moving + TURN, *v = moving + VELOCITY;
    double sum = objects_dot(wrench + 3, v + 3);
    for (int i = 0; i < 3; i++) sum += wrench[i] * (R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2]);
    return sum;
}

static const double *begun_of(const contact_problem *problem, int body)
{
    return problem->step->begun + FINGERFEM_MOVING * chain_load_of(problem->map, body);
}

/* The inertial wrench of a body that moves so, (6), with an angular velocity `spin`. */
static void wrench_of(const fingerfem_inertia *inertia, int load, const double *moving, const double *spin, double *found)
{
    const double *s = inertia->moments + 3 * load, *J = inertia->inertias + 9 * load, *R = moving + TURN;
    const double *change = moving + CHANGE + 3;
    double A[3], turned[3], inner[3], outer[3], spun[3], by_spun[3], by_moment[3];
    for (int i = 0; i < 3; i++) {
        /* R^T p''; J om */
        A[i] = R[i] * moving[CHANGE] + R[3 + i] * moving[CHANGE + 1] + R[6 + i] * moving[CHANGE + 2];
        spun[i] = objects_dot(J + 3 * i, spin);
    }
    objects_cross(change, s, turned);
    objects_cross(spin, s, inner);
    objects_cross(spin, inner, outer);
    objects_cross(spin, spun, by_spun);
    objects_cross(s, A, by_moment);
    for (int i = 0; i < 3; i++) {
        found[i] = -(inertia->masses[load] * A[i] + turned[i] + outer[i]);
        found[3 + i] = -(objects_dot(J + 3 * i, change) + by_spun[i] + by_moment[i]);
    }
}

/* The inertial wrench of a body, (6). That of its turn takes om = 2 D - om_0, which has what contact does, as v above has not. */
static void wrench_on(const contact_problem *problem, const chain_state *state, int b, double *found)
{
    const double *begun = begun_of(problem, b);
    double moving[FINGERFEM_MOVING], spin[3];
    turn_between(begun + TURN, state->bodies[b].rotation, spin);
    for (int i = 0; i < 3; i++) spin[i] = 2.0 * spin[i] / problem->step->length - begun[VELOCITY + 3 + i];
    inertia_moving(problem->step, begun, state->bodies + b, moving);
    wrench_of(problem->step->inertia, chain_load_of(problem->map, b), moving, spin, found);
}

void inertia_wrenches(const contact_problem *problem, const chain_state *state, double *found)
{
    for (int b = 0; b < problem->map->count; b++) {
        memset(found + W * b, 0, W * sizeof *found);
        if (problem->map->bodies[b].segment != CHAIN_GROUND) wrench_on(problem, state, b, found + W * b);
    }
}

void inertia_follow(const contact_problem *problem, const chain_state *state, chain_matrix following)
{
    const contact_step *step = problem->step;
    const double stiff = (1.0 - step->mean_mass) / ((1.0 - step->mean_force) * step->beta * step->length * step->length);
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const int load = chain_load_of(problem->map, b);
        const double m = step->inertia->masses[load], *s = step->inertia->moments + 3 * load, *J = step->inertia->inertias + 9 * load;
        double wrench[W];
        wrench_on(problem, state, b, wrench);
        /* dF = -stiff (m xi - s x theta), dM = -stiff (J theta + s x xi), as accelerations grow by stiff (xi, theta); terms of the
         * velocities, smaller by the turn in a step, and of A, by that of the whole way, are left out */
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            double (*rows)[CHAIN_WRENCH] = following + W * b;
            rows[i][W * b + i] -= stiff * m;
            rows[i][W * b + 3 + j] -= stiff * s[k];
            rows[i][W * b + 3 + k] += stiff * s[j];
            rows[3 + i][W * b + j] += stiff * s[k];
            rows[3 + i][W * b + k] -= stiff * s[j];
            for (int l = 0; l < 3; l++) rows[3 + i][W * b + 3 + l] -= stiff * J[3 * i + l];
            /* d(R^T p'') as the frame turns: -m A x theta */
            rows[i][W * b + 3 + j] -= wrench[k];
            rows[i][W * b + 3 + k] += wrench[j];
        }
    }
}

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
 * With the mass of elements between their sections accelerations of bodies next to each other come in too: F, M above are -M V' and
 * the terms of om, with the mass matrix M of all bodies, see rom/rod/motion/mass.py.
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
void inertia_turn_between(const double *from, const double *to, double *found)
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
    const double h = step->length;
    double way[W];
    for (int i = 0; i < 3; i++) way[i] = body->centre[i] - begun[PLACE + i];
    inertia_turn_between(begun + TURN, body->rotation, way + 3);
    memcpy(moving + PLACE, body->centre, sizeof body->centre);
    memcpy(moving + TURN, body->rotation, sizeof body->rotation);
    for (int i = 0; i < W; i++) {
        const double v = begun[VELOCITY + i], before = begun[MEAN + i];
        const double a = (way[i] / h - v - (0.5 - step->beta) * h * before) / (step->beta * h);
        moving[VELOCITY + i] = v + h * ((1.0 - step->gamma) * before + step->gamma * a);
        moving[MEAN + i] = a;
        /* the mean of accelerations, of which inertia_rates makes wrenches */
        moving[CHANGE + i] = ((1.0 - step->mean_mass) * a + step->mean_mass * before) / (1.0 - step->mean_force);
    }
}

void inertia_at_rest(const chain_body *body, double *moving)
{
    memset(moving, 0, FINGERFEM_MOVING * sizeof *moving);
    memcpy(moving + PLACE, body->centre, sizeof body->centre);
    memcpy(moving + TURN, body->rotation, sizeof body->rotation);
}

void inertia_subtract_contact(const contact_step *step, const double *change, double *moving)
{
    const double h = step->length, *R = moving + TURN;
    /* with change = r / M: a -= change / (2 beta), v' likewise, v += h change - gamma h change / (2 beta); those of the centre in space */
    for (int i = 0; i < W; i++) {
        const double own = i < 3 ? objects_dot(R + 3 * i, change) : change[i], taken = 0.5 * own / step->beta;
        moving[MEAN + i] -= taken;
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

/* The rotation matrix of a rotation vector, (3) [rad]: 1 + sin(phi) / phi [v]x + (1 - cos(phi)) / phi^2 [v]x^2. */
static void rotation_of(const double *v, double *found)
{
    const double angle = sqrt(objects_dot(v, v));
    const double one = angle > LITTLE ? sin(angle) / angle : 1.0, two = angle > LITTLE ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) found[3 * i + j] = two * v[i] * v[j] + (i == j ? 1.0 - two * angle * angle : 0.0);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        found[3 * i + j] -= one * v[k];
        found[3 * j + i] += one * v[k];
    }
}

void inertia_turn(const double *turn, double *rotation)
{
    double change[9], before[9];
    memcpy(before, rotation, sizeof before);
    rotation_of(turn, change);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rotation[3 * i + j] = before[3 * i] * change[j] + before[3 * i + 1] * change[3 + j] + before[3 * i + 2] * change[6 + j];
}

/* Add Q^T K P of a block K of an element's mass, one of (12, 12), to the block of bodies a, b: Q and P turn their frames into that
 * between both. */
static void add_block(const double *K, int first, int second, const double *Q, const double *P, int a, int b, chain_matrix mass)
{
    for (int r = 0; r < W; r += 3)
        for (int c = 0; c < W; c += 3) {
            double half[9];
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    half[3 * i + j] = 0.0;
                    for (int l = 0; l < 3; l++) half[3 * i + j] += K[2 * W * (first + r + i) + second + c + l] * P[3 * l + j];
                }
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    for (int l = 0; l < 3; l++) mass[W * a + r + i][W * b + c + j] += Q[3 * l + i] * half[3 * l + j];
        }
}

/* From the frame of a body to that between it and the one before, which is the clamp if NULL: by half the turn, (3, 3). */
static void middle_of(const chain_body *before, const chain_body *body, double *found)
{
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double turn[3];
    inertia_turn_between(before ? before->rotation : upright, body->rotation, turn);
    for (int i = 0; i < 3; i++) turn[i] *= 0.5;
    rotation_of(turn, found);
}

void inertia_mass(const contact_problem *problem, const chain_state *state, chain_matrix mass)
{
    const fingerfem_inertia *inertia = problem->step->inertia;
    const int size = contact_size(problem);
    for (int i = 0; i < size; i++) memset(mass[i], 0, (size_t)size * sizeof **mass);
    for (int b = 0; b < problem->map->count; b++) {
        double (*rows)[CHAIN_WRENCH] = mass + W * b;
        /* the ground does not move */
        for (int i = 0; i < W && problem->map->bodies[b].segment == CHAIN_GROUND; i++) rows[i][W * b + i] = 1.0;
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        /* lumps: (m, -s x; s x, J) */
        const int load = chain_load_of(problem->map, b), before = b && problem->map->bodies[b - 1].segment != CHAIN_GROUND;
        const double *s = inertia->moments + 3 * load, *J = inertia->inertias + 9 * load, *K = inertia->elements + 4 * W * W * load;
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            rows[i][W * b + i] += inertia->masses[load];
            rows[i][W * b + 3 + j] += s[k];
            rows[i][W * b + 3 + k] -= s[j];
            rows[3 + i][W * b + j] -= s[k];
            rows[3 + i][W * b + k] += s[j];
            for (int l = 0; l < 3; l++) rows[3 + i][W * b + 3 + l] += J[3 * i + l];
        }
        /* the element towards the clamp, in the frame between both its sections */
        double to_middle[9], from_middle[9];
        middle_of(b ? state->bodies + b - 1 : NULL, state->bodies + b, to_middle);
        for (int i = 0; i < 9; i++) from_middle[i] = to_middle[3 * (i % 3) + i / 3];
        add_block(K, 0, 0, to_middle, to_middle, b, b, mass);
        if (!before) continue;
        add_block(K, 0, W, to_middle, from_middle, b, b - 1, mass);
        add_block(K, W, 0, from_middle, to_middle, b - 1, b, mass);
        add_block(K, W, W, from_middle, from_middle, b - 1, b - 1, mass);
    }
}

/* Numbers of all bodies in their frames, (6 bodies), from those of `moving` behind `first`, of which the first three are in space. */
static void seen(const double *moving, int first, int b, double *found)
{
    const double *R = moving + TURN, *v = moving + first;
    for (int i = 0; i < 3; i++) {
        found[W * b + i] = R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2];
        found[W * b + 3 + i] = v[3 + i];
    }
}

double inertia_energy(const contact_problem *problem, const double *moving, const chain_matrix mass)
{
    const int size = contact_size(problem);
    double v[CHAIN_WRENCH] = {0.0}, found = 0.0;
    for (int b = 0; b < problem->map->count; b++)
        if (problem->map->bodies[b].segment != CHAIN_GROUND)
            seen(moving + FINGERFEM_MOVING * chain_load_of(problem->map, b), VELOCITY, b, v);
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) found += 0.5 * v[i] * mass[i][j] * v[j];
    return found;
}

/* On a base that turns by w and has its acceleration at the clamp in the weight (see motion.c), a body at p with the velocity v and the
 * angular velocity om, as seen from there, has besides
 *
 *     A += R^T (w' x p + w x (w x p) + 2 w x v),    al += R^T w' + (R^T w) x om,    om += R^T w;
 *
 * v = 2 D - v_0 as om above. */
static void add_base(const contact_step *step, const double *begun, const chain_body *body, double *spin, double *acceleration)
{
    const double *w = step->turning, *rate = step->turning + 3, *p = body->centre, *R = body->rotation;
    double velocity[3], by_rate[3], around[3], outer[3], coriolis[3], own[3], own_rate[3], turned[3];
    for (int i = 0; i < 3; i++) velocity[i] = 2.0 * (p[i] - begun[PLACE + i]) / step->length - begun[VELOCITY + i];
    objects_cross(rate, p, by_rate);
    objects_cross(w, p, around);
    objects_cross(w, around, outer);
    objects_cross(w, velocity, coriolis);
    for (int i = 0; i < 3; i++) by_rate[i] += outer[i] + 2.0 * coriolis[i];
    for (int i = 0; i < 3; i++) {
        acceleration[i] += R[i] * by_rate[0] + R[3 + i] * by_rate[1] + R[6 + i] * by_rate[2];
        own[i] = R[i] * w[0] + R[3 + i] * w[1] + R[6 + i] * w[2];
        own_rate[i] = R[i] * rate[0] + R[3 + i] * rate[1] + R[6 + i] * rate[2];
    }
    objects_cross(own, spin, turned);
    for (int i = 0; i < 3; i++) {
        acceleration[3 + i] += own_rate[i] + turned[i];
        spin[i] += own[i];
    }
}

/* Force of the mass of the element at the clamp, which turns by w' with the base, on the body beyond it: -Q^T K P (0, w'), see `add_block`. */
static void subtract_clamp(const contact_problem *problem, const chain_state *state, double *found)
{
    const int b = problem->map->bodies[0].segment == CHAIN_GROUND;
    const double *K = problem->step->inertia->elements + 4 * W * W * chain_load_of(problem->map, b), *rate = problem->step->turning + 3;
    double to_middle[9], turn[3], middle[W];
    middle_of(NULL, state->bodies + b, to_middle);
    /* P w', with P = Q^T */
    for (int i = 0; i < 3; i++) turn[i] = to_middle[i] * rate[0] + to_middle[3 + i] * rate[1] + to_middle[6 + i] * rate[2];
    for (int i = 0; i < W; i++) middle[i] = objects_dot(K + 2 * W * i + W + 3, turn);
    for (int i = 0; i < W; i++)
        for (int j = 0; j < 3; j++) found[W * b + i] -= to_middle[3 * j + i % 3] * middle[i / 3 * 3 + j];
}

/* M v', (6 bodies), from means of accelerations, each in its body's frame: M times these, less what elements put on the bodies as the
 * step began. */
static void rates(const contact_problem *problem, const chain_state *state, const chain_matrix mass, const double *accelerations, double *found)
{
    const double share = problem->step->mean_force / (1.0 - problem->step->mean_force);
    const int size = contact_size(problem);
    for (int b = 0; b < problem->map->count; b++) {
        double *own = found + W * b;
        memset(own, 0, W * sizeof *own);
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const double *before = begun_of(problem, b) + CHANGE;
        objects_turned_back(state->bodies[b].rotation, before, own);
        memcpy(own + 3, before + 3, 3 * sizeof *own);
        for (int i = 0; i < W; i++) own[i] *= -share;
    }
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) found[i] += mass[i][j] * accelerations[j];
}

void inertia_wrenches(const contact_problem *problem, const chain_state *state, const chain_matrix mass, double *found)
{
    const fingerfem_inertia *inertia = problem->step->inertia;
    double accelerations[CHAIN_WRENCH] = {0.0}, spins[CHAIN_WRENCH] = {0.0};
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const int load = chain_load_of(problem->map, b);
        const double *begun = begun_of(problem, b), *s = inertia->moments + 3 * load, *J = inertia->inertias + 9 * load;
        double moving[FINGERFEM_MOVING], spin[3], spun[3], inner[3], outer[3], by_spun[3];
        inertia_moving(problem->step, begun, state->bodies + b, moving);
        seen(moving, CHANGE, b, accelerations);
        /* om x (om x s) and om x J om, with om = 2 D - om_0, which has what contact does, as v above has not */
        inertia_turn_between(begun + TURN, state->bodies[b].rotation, spin);
        for (int i = 0; i < 3; i++) spin[i] = 2.0 * spin[i] / problem->step->length - begun[VELOCITY + 3 + i];
        if (problem->step->turning) add_base(problem->step, begun, state->bodies + b, spin, accelerations + W * b);
        for (int i = 0; i < 3; i++) spun[i] = objects_dot(J + 3 * i, spin);
        objects_cross(spin, s, inner);
        objects_cross(spin, inner, outer);
        objects_cross(spin, spun, by_spun);
        memcpy(spins + W * b, outer, sizeof outer);
        memcpy(spins + W * b + 3, by_spun, sizeof by_spun);
    }
    rates(problem, state, mass, accelerations, found);
    for (int i = 0; i < contact_size(problem); i++) found[i] = -found[i] - spins[i];
    if (problem->step->turning) subtract_clamp(problem, state, found);
}

void inertia_forces(const contact_problem *problem, const chain_state *state, const chain_matrix mass, const double *contact, double *moving)
{
    double accelerations[CHAIN_WRENCH] = {0.0}, found[CHAIN_WRENCH];
    for (int b = 0; b < problem->map->count; b++)
        if (problem->map->bodies[b].segment != CHAIN_GROUND)
            seen(moving + FINGERFEM_MOVING * chain_load_of(problem->map, b), CHANGE, b, accelerations);
    rates(problem, state, mass, accelerations, found);
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        double *own = moving + FINGERFEM_MOVING * chain_load_of(problem->map, b), *R = own + TURN, f[W];
        for (int i = 0; i < W; i++) f[i] = found[W * b + i] - problem->step->contact * contact[W * b + i];
        for (int i = 0; i < 3; i++) {
            own[CHANGE + i] = objects_dot(R + 3 * i, f);
            own[CHANGE + 3 + i] = f[3 + i];
        }
    }
}

void inertia_follow(const contact_problem *problem, const chain_state *state, const chain_matrix mass, chain_matrix following)
{
    const contact_step *step = problem->step;
    const double stiff = (1.0 - step->mean_mass) / ((1.0 - step->mean_force) * step->beta * step->length * step->length);
    const int size = contact_size(problem);
    double wrench[CHAIN_WRENCH];
    inertia_wrenches(problem, state, mass, wrench);
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        double (*rows)[CHAIN_WRENCH] = following + W * b;
        /* dw = -stiff M xi, as accelerations grow by stiff xi; terms of the velocities, smaller by the turn in a step, and of what
         * turns the frames between bodies, are left out */
        for (int i = 0; i < W; i++)
            for (int j = 0; j < size; j++) rows[i][j] -= stiff * mass[W * b + i][j];
        /* d(R^T p'') as the frame turns: F x theta */
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            rows[i][W * b + 3 + j] -= wrench[W * b + k];
            rows[i][W * b + 3 + k] += wrench[W * b + j];
        }
    }
}

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
 * the terms of om, with the mass matrix M of all bodies, see inertia_mass.c.
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

enum { PLACE = 0, TURN = 3, VELOCITY = 12, CHANGE = 18, MEAN = 24 }; /* of a body's FINGERFEM_MOVING numbers: p, R, v, v', a */

void inertia_method(double radius, contact_step *step)
{
    step->mean_mass = (2.0 * radius - 1.0) / (radius + 1.0);
    step->mean_force = radius / (radius + 1.0);
    step->gamma = 0.5 + step->mean_force - step->mean_mass;
    step->beta = 0.25 * (step->gamma + 0.5) * (step->gamma + 0.5);
    step->contact = 0.5 * (1.0 - step->mean_mass) / ((1.0 - step->mean_force) * step->beta);
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

void inertia_at_rest(const chain_body *body, const double *wrench, const double *acceleration, double *moving)
{
    memset(moving, 0, FINGERFEM_MOVING * sizeof *moving);
    memcpy(moving + PLACE, body->centre, sizeof body->centre);
    memcpy(moving + TURN, body->rotation, sizeof body->rotation);
    for (int i = 0; i < W; i++) {
        moving[CHANGE + i] = i < 3 ? objects_dot(body->rotation + 3 * i, wrench) : wrench[i];
        moving[MEAN + i] = i < 3 ? objects_dot(body->rotation + 3 * i, acceleration) : acceleration[i];
    }
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
    inertia_middle(NULL, state->bodies + b, to_middle);
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

void inertia_follow(const contact_problem *problem, const chain_matrix mass, const double *wrench, chain_matrix following)
{
    const contact_step *step = problem->step;
    const double stiff = (1.0 - step->mean_mass) / ((1.0 - step->mean_force) * step->beta * step->length * step->length);
    const int size = contact_size(problem);
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

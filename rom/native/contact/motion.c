/* A step of time: the balance of contact_solve.c at the step's end, with inertia. On a base that moves, weight is R^T g - a, with
 * the base's rotation R and the acceleration a of the clamp; and inertia.c has its turning. */
#include "inertia.h"
#include "relaxation.h"
#include "reported.h"
#include "response.h"
#include "../linear_algebra/small.h"

#define SHARED 1e-9 /* added to the diagonal, over it, so that contacts of one normal share a force [-] */

/* N_j = -sum_q e . f_q over all bodies q: force of object j against its direction e [N], (count). */
static void forces_along(const contact_problem *problem, const contact_state *state, double *forces)
{
    for (int j = 0; j < problem->touching->count; j++) {
        double wrench[CHAIN_WRENCH], e[3];
        response_wrenches(problem, state, j, wrench);
        forces[j] = 0.0;
        for (int q = 0; q < problem->map->count; q++) {
            placed_leaving(problem, j, state->at.chain.bodies + q, e);
            forces[j] -= objects_dot(e, wrench + W * q);
        }
    }
}

/* The contacts that press, `rows`, their number; and changes of the acceleration of all bodies, (1 + number, CHAIN_WRENCH): r / M with
 * the wrenches r of contact, then W_k / M of each. Returns -1 if the mass matrix is singular. */
static int accelerated(const contact_problem *problem, const contact_state *state, int *rows, double (*found)[CHAIN_WRENCH])
{
    const int size = contact_size(problem);
    double factors[CHAIN_WRENCH * CHAIN_WRENCH];
    int count = 0, exchanged[CHAIN_WRENCH];
    memset(found[0], 0, sizeof found[0]);
    for (int k = 0; k < state->at.contacts.count; k++)
        if (state->forces[k] > 0.0) rows[count++] = k;
    for (int i = 0; i < size && count; i++) memcpy(factors + size * i, state->mass[i], (size_t)size * sizeof *factors);
    if (count && !small_factorise(size, size, factors, exchanged)) return -1;
    for (int k = 0; k < count; k++) {
        double *own = found[1 + k];
        /* W_k, but for the ground, which does not move; then r / M = sum f_k W_k / M */
        memset(own, 0, sizeof found[0]);
        response_press(&state->at, rows[k], 1.0, own);
        memset(own, 0, problem->map->bodies[0].segment == CHAIN_GROUND ? W * sizeof *own : 0);
        small_substitute(size, size, factors, exchanged, own);
        for (int i = 0; i < size; i++) found[0][i] += state->forces[rows[k]] * own[i];
    }
    return count;
}

/* v -= W (W^T W / M)^-1 W^T v / M over the contacts that press, with a small diagonal term, so that contacts of one normal share a force. */
static void stop(const contact_problem *problem, const contact_state *state, int count, const int *rows, double (*changes)[CHAIN_WRENCH], double *moving)
{
    double matrix[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], velocity[FINGERFEM_MOST_CONTACTS];
    /* W^T W / M and W^T v */
    for (int i = 0; i < count; i++) {
        const contact_arms *own = state->at.arms + rows[i];
        velocity[i] = 0.0;
        for (int j = 0; j < count; j++) matrix[count * i + j] = 0.0;
        for (int a = 0; a < own->count; a++) {
            const int body = own->bodies[a];
            if (problem->map->bodies[body].segment == CHAIN_GROUND) continue;
            velocity[i] += inertia_velocity_along(own->wrenches[a], moving + FINGERFEM_MOVING * chain_load_of(problem->map, body));
            for (int j = 0; j < count; j++)
                for (int l = 0; l < W; l++) matrix[count * i + j] += own->wrenches[a][l] * changes[1 + j][W * body + l];
        }
        matrix[count * i + i] *= 1.0 + SHARED;
    }
    if (!count || !small_solve(count, matrix, 1, velocity)) return;
    for (int b = 0; b < problem->map->count; b++) {
        double change[W] = {0.0};
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        for (int l = 0; l < W; l++)
            for (int k = 0; k < count; k++) change[l] -= velocity[k] * changes[1 + k][W * b + l];
        inertia_add_velocity(change, moving + FINGERFEM_MOVING * chain_load_of(problem->map, b));
    }
}

/* Motions of all bodies at the step's end, in place of where it began, and the kinetic energy; returns 0 if the mass matrix is singular. */
static int move(const contact_problem *problem, const contact_state *state, double *moving, double *energy)
{
    int rows[FINGERFEM_MOST_CONTACTS];
    double changes[1 + FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH];
    /* accelerations by contact */
    const int count = accelerated(problem, state, rows, changes);
    if (count < 0) return 0;
    for (int b = 0; b < problem->map->count; b++) {
        double *own = moving + FINGERFEM_MOVING * chain_load_of(problem->map, b), begun[FINGERFEM_MOVING];
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        memcpy(begun, own, sizeof begun);
        inertia_moving(problem->step, begun, state->at.chain.bodies + b, own);
        inertia_subtract_contact(problem->step, changes[0] + W * b, own);
    }
    stop(problem, state, count, rows, changes, moving);
    *energy = inertia_energy(problem, moving, state->mass);
    return 1;
}

int fingerfem_step(const fingerfem_touching *touching, const fingerfem_inertia *inertia, const double *point, const double *base,
                   double length, double *memory, double *moving, double *relaxing, double *loads, double *forces, double *energy,
                   int32_t *inside, fingerfem_pressing *pressing)
{
    const fingerfem_branches *branches = inertia->branches;
    fingerfem_chain chain = *touching->chain;
    const fingerfem_touching touched = {&chain, touching->count, touching->objects};
    const int t = chain.tensions;
    contact_step step = {.inertia = inertia, .begun = moving, .length = length, .rubber = inside[1] == FINGERFEM_RUBBER_PRESSES};
    double held[TENSIONS_MOST], seen[TENSIONS_MOST];
    relaxation_step relaxation;
    chain_rods map;
    contact_state state;
    /* where contact lasts, its wrench and those of elements are both of the step's end: as a mean with those before it they make energy */
    inertia_method(inside[1] == FINGERFEM_NOTHING_PRESSES ? inertia->radius : 0.0, &step);
    contact_problem problem = {&touched, &map, {0.0}, inertia->masses ? &step : NULL, inertia->masses ? step.contact : 1.0};
    /* the weight on a base that moves, and its turning */
    if (base) memcpy(chain.gravity, base, sizeof chain.gravity);
    for (int i = 3; i < FINGERFEM_BASE && base; i++)
        if (base[i] != 0.0) step.turning = base + 3;
    const double d = contact_lead(&problem, point + t);
    /* bodies, and the wrenches of the last step */
    memcpy(seen, point, (size_t)t * sizeof *seen);
    if (branches) relaxation_begin(&chain, branches, length, relaxing, &relaxation);
    if (branches) relaxation_tensions(&relaxation, point, seen);
    *inside = chain_clamped(&chain, seen, held);
    chain_set_tensions(&chain, held, memory, &map);
    if (branches) relaxation_set(&relaxation, &map);
    chain_contract(&map);
    memset(state.forces, 0, sizeof state.forces);
    state.at.contacts.count = 0;
    if (!chain_all_bodies(&map) || !chain_take_loads(&map, loads, state.wrench)) return -1;
    const int evaluations = contact_solve_from(&problem, d, &state);
    if (evaluations <= 0) return evaluations;
    inside[1] = FINGERFEM_NOTHING_PRESSES;
    for (int k = 0; k < state.at.contacts.count; k++) {
        const int pressed = placed_slice_of(&state.at, k) ? FINGERFEM_RUBBER_PRESSES : FINGERFEM_PLATES_PRESS;
        if (state.forces[k] > 0.0 && inside[1] < pressed) inside[1] = pressed;
    }
    /* where the step ends, and how bodies move there */
    *energy = 0.0;
    for (int b = 0; b < map.count; b++) *inside &= state.at.chain.bodies[b].end.inside;
    if (problem.step && !move(&problem, &state, moving, energy)) return -evaluations;
    for (int b = 0; b < map.count && !problem.step; b++)
        if (map.bodies[b].segment != CHAIN_GROUND)
            inertia_at_rest(state.at.chain.bodies + b, moving + FINGERFEM_MOVING * chain_load_of(&map, b));
    if (branches) relaxation_end(&relaxation, &map, point, relaxing);
    chain_leave_loads(&map, state.wrench, loads);
    forces_along(&problem, &state, forces);
    *inside &= !placed_crowded(&state.at.contacts);
    if (pressing) report_pressing(&state.at, state.forces, pressing);
    return evaluations;
}

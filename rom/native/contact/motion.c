/* A step of time: the balance of contact_solve.c at the step's end, with inertia. On a base that moves, weight is R^T g - a, with
 * the base's rotation R and the acceleration a of the clamp; and inertia.c has its turning. */
#include "acting.h"
#include "inertia.h"
#include "relaxation.h"
#include "response.h"
#include "../rod/guides.h"
#include "../linear_algebra/small.h"

#define SHARED 1e-9 /* added to the diagonal, over it, so that contacts of one normal share a force [-] */

/* N_j = -sum_q e . f_q over all bodies q: force of object j against its direction e [N], (count), with the contacts' mean forces over a step
 * and the forces that stopped them along their normals, (contacts). */
static void forces_along(const contact_problem *problem, const contact_state *state, const double *stopped, double *forces)
{
    memset(forces, 0, (size_t)problem->touching->count * sizeof *forces);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        const int j = state->at.contacts.objects[k];
        double e[3];
        if (!(state->forces[k] > 0.0)) continue;
        for (int a = 0; a < arms->count; a++) {
            placed_leaving(problem, j, state->at.chain.bodies + arms->bodies[a], e);
            forces[j] -= acting_force(state, k) * objects_dot(e, state->at.acting[k].wrenches[a]);
            forces[j] -= stopped[k] * objects_dot(e, arms->wrenches[a]);
        }
    }
}

/* Plates' contacts that press. */
typedef struct {
    int count, rows[FINGERFEM_MOST_CONTACTS];
    double changes[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH]; /* W_k / M */
} stopped_contacts;

/* Factors of the mass matrix, (6 bodies, 6 bodies), and the rows that they exchange; returns 0 if it is singular. */
static int factorised(int size, const contact_state *state, double *factors, int *exchanged)
{
    for (int i = 0; i < size; i++) memcpy(factors + size * i, state->mass[i], (size_t)size * sizeof *factors);
    return small_factorise(size, size, factors, exchanged);
}

/* These; the wrenches r of all contacts and r / M, both (6 bodies). Returns 0 if the mass matrix is singular. */
static int accelerated(const contact_problem *problem, const contact_state *state, double *wrench, double *change, stopped_contacts *found)
{
    const int size = contact_size(problem), ground = problem->map->bodies[0].segment == CHAIN_GROUND ? W : 0;
    double factors[CHAIN_WRENCH * CHAIN_WRENCH];
    int exchanged[CHAIN_WRENCH], any = 0;
    found->count = 0;
    memset(wrench, 0, (size_t)size * sizeof *wrench);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        double *own = found->changes[found->count];
        if (!(state->forces[k] > 0.0)) continue;
        any = 1;
        response_press(&state->at, k, acting_force(state, k), wrench);
        if (placed_slice_of(&state->at, k)) continue;
        memset(own, 0, (size_t)size * sizeof *own);
        memcpy(own + W * arms->bodies[0], arms->wrenches[0], W * sizeof *own);
        found->rows[found->count++] = k;
    }
    memcpy(change, wrench, (size_t)size * sizeof *wrench);
    if (!any) return 1;
    if (!factorised(size, state, factors, exchanged)) return 0;
    /* but for the ground, which does not move */
    memset(change, 0, (size_t)ground * sizeof *change);
    small_substitute(size, size, factors, exchanged, change);
    for (int k = 0; k < found->count; k++) small_substitute(size, size, factors, exchanged, found->changes[k]);
    return 1;
}

/* v -= W (W^T W / M)^-1 W^T v / M over the plates' contacts that press, with a small diagonal term, so that contacts of one normal share a
 * force. Adds the mean forces over the step that do so, (contacts) [N], of objects on which contact begins: contacts at about one point have
 * large forces of opposite signs, and only their sum counts. */
static void stop(const contact_problem *problem, const contact_state *state, const stopped_contacts *those, double *moving, double *forces)
{
    const int count = those->count;
    double matrix[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], velocity[FINGERFEM_MOST_CONTACTS];
    int begins[FINGERFEM_MOST_OBJECTS] = {0};
    /* W^T W / M and W^T v */
    for (int i = 0; i < count; i++) {
        const contact_arms *own = state->at.arms + those->rows[i];
        const int body = own->bodies[0];
        velocity[i] = inertia_velocity_along(own->wrenches[0], moving + FINGERFEM_MOVING * chain_load_of(problem->map, body));
        for (int j = 0; j < count; j++) {
            matrix[count * i + j] = 0.0;
            for (int l = 0; l < W; l++) matrix[count * i + j] += own->wrenches[0][l] * those->changes[j][W * body + l];
        }
        matrix[count * i + i] *= 1.0 + SHARED;
    }
    if (!count || !small_solve(count, matrix, 1, velocity)) return;
    for (int i = 0; i < count; i++)
        if (acting_pressed(problem->step->pressed, &state->at.contacts, those->rows[i]) == 0.0)
            begins[state->at.contacts.objects[those->rows[i]]] = 1;
    for (int k = 0; k < count; k++)
        if (begins[state->at.contacts.objects[those->rows[k]]]) forces[those->rows[k]] -= velocity[k] / problem->step->length;
    for (int b = 0; b < problem->map->count; b++) {
        double change[W] = {0.0};
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        for (int l = 0; l < W; l++)
            for (int k = 0; k < count; k++) change[l] -= velocity[k] * those->changes[k][W * b + l];
        inertia_add_velocity(change, moving + FINGERFEM_MOVING * chain_load_of(problem->map, b));
    }
}

/* Motions of all bodies at the step's end, in place of where it began, the kinetic energy, and the forces that stop contacts; returns 0 if the
 * mass matrix is singular. */
static int move(const contact_problem *problem, const contact_state *state, double *moving, double *energy, double *stopped)
{
    stopped_contacts those;
    double change[CHAIN_WRENCH], wrench[CHAIN_WRENCH];
    /* accelerations by contact */
    if (!accelerated(problem, state, wrench, change, &those)) return 0;
    for (int b = 0; b < problem->map->count; b++) {
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        const int load = chain_load_of(problem->map, b);
        double *own = moving + FINGERFEM_MOVING * load;
        inertia_moving(problem->step, problem->step->begun + FINGERFEM_MOVING * load, state->at.chain.bodies + b, own);
        inertia_subtract_contact(problem->step, change + W * b, own);
    }
    inertia_forces(problem, &state->at.chain, state->mass, wrench, moving);
    stop(problem, state, &those, moving, stopped);
    *energy = inertia_energy(problem, moving, state->mass);
    return 1;
}

/* Motions of all bodies at rest: elements put the opposite of contact's wrenches w on them, and alone would accelerate them by -w / M. Returns 0
 * if the mass matrix is singular. */
static int rest(const contact_problem *problem, contact_state *state, double *moving)
{
    const int size = contact_size(problem), ground = problem->map->bodies[0].segment == CHAIN_GROUND ? W : 0;
    double factors[CHAIN_WRENCH * CHAIN_WRENCH], wrench[CHAIN_WRENCH], change[CHAIN_WRENCH];
    int exchanged[CHAIN_WRENCH];
    inertia_mass(problem, &state->at.chain, state->mass);
    if (!factorised(size, state, factors, exchanged)) return 0;
    for (int i = 0; i < size; i++) wrench[i] = change[i] = i < ground ? 0.0 : -state->wrench[i];
    small_substitute(size, size, factors, exchanged, change);
    for (int b = 0; b < problem->map->count; b++)
        if (problem->map->bodies[b].segment != CHAIN_GROUND)
            inertia_at_rest(state->at.chain.bodies + b, wrench + W * b, change + W * b,
                            moving + FINGERFEM_MOVING * chain_load_of(problem->map, b));
    return 1;
}

int fingerfem_step(const fingerfem_touching *touching, const fingerfem_inertia *inertia, const double *point, const double *base,
                   double length, double *memory, double *moving, double *relaxing, double *loads, double *forces, double *energy,
                   int32_t *inside, fingerfem_pressed *pressed)
{
    const fingerfem_branches *branches = inertia->branches;
    fingerfem_chain chain = *touching->chain;
    const fingerfem_touching touched = {&chain, touching->count, touching->objects};
    const int t = chain.tensions;
    double begun[FINGERFEM_MOST_BODIES * FINGERFEM_MOVING], stopped[FINGERFEM_MOST_CONTACTS] = {0.0};
    acting_begin begin;
    contact_step step = {.inertia = inertia, .begun = begun, .length = length, .pressed = pressed, .begin = &begin};
    const double *tensions = chain.guides ? chain.guides->tensions : point;
    double held[TENSIONS_MOST], seen[RELAXATION_TENSIONS];
    fingerfem_guides guides;
    relaxation_step relaxation;
    chain_rods map;
    contact_state state;
    inertia_method(inertia->radius, &step);
    contact_problem problem = {&touched, &map, {0.0}, inertia->rests ? NULL : &step, inertia->rests ? 1.0 : step.contact};
    /* the weight on a base that moves, and its turning */
    if (base) memcpy(chain.gravity, base, sizeof chain.gravity);
    for (int i = 3; i < FINGERFEM_BASE && base; i++)
        if (base[i] != 0.0) step.turning = base + 3;
    const double d = contact_lead(&problem, point + t);
    /* bodies, and the wrenches of the last step */
    const int seen_tensions = relaxation_tensions_of(&chain);
    memcpy(seen, tensions, (size_t)seen_tensions * sizeof *seen);
    if (branches) relaxation_begin(&chain, branches, length, relaxing, &relaxation);
    if (branches) relaxation_tensions(&relaxation, tensions, seen);
    *inside = 1;
    for (int k = 0; k < seen_tensions; k += t) *inside &= chain_clamped(&chain, seen + k, held);
    if (chain.guides) {
        guides = *chain.guides;
        guides.tensions = seen;
        chain.guides = &guides;
    }
    chain_set_constant(&chain, held, memory, &map);
    if (branches) relaxation_set(&relaxation, &map);
    chain_contract(&map);
    memset(state.forces, 0, sizeof state.forces);
    state.at.contacts.count = 0;
    if (!chain_all_bodies(&map) || !chain_take_loads(&map, loads, state.wrench)) return -1;
    memcpy(begun, moving, (size_t)(fingerfem_chain_loads(&chain) / W * FINGERFEM_MOVING) * sizeof *begun);
    const int evaluations = contact_solve_from(&problem, d, &state);
    if (evaluations <= 0) return evaluations;
    /* where the step ends, how bodies move there, and what presses */
    *energy = 0.0;
    for (int b = 0; b < map.count; b++) *inside &= state.at.chain.bodies[b].end.inside;
    problem.step = &step;
    if (!(inertia->rests ? rest(&problem, &state, moving) : move(&problem, &state, moving, energy, stopped))) return -evaluations;
    if (branches) relaxation_end(&relaxation, &map, tensions, relaxing);
    if (chain.guides) guides_leave(&map, memory);
    chain_leave_loads(&map, state.wrench, loads);
    forces_along(&problem, &state, stopped, forces);
    acting_leave(&state, pressed);
    *inside &= !placed_crowded(&state.at.contacts);
    return evaluations;
}

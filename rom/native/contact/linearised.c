/* A finger with all bodies at rest: where a motion begins, and small vibrations about it.
 *
 * With wrenches w on all bodies these move by xi = C S w, see contact_solve.c. Contacts that press stay closed: forces f with
 * (W^T C S W + c) f = -W^T C S w press besides. So
 *
 *     xi = D w,    D = C S - C S W (W^T C S W + c)^-1 W^T C S,
 *
 * and natural frequencies follow from w = omega^2 M xi. Contacts without a force stay open. */
#include "inertia.h"
#include "relaxation.h"
#include "response.h"

/* Column of D by a unit wrench, `component` of all bodies' numbers: the motion of all bodies. Returns 0 if the contact is singular. */
static int yield(const contact_problem *problem, const contact_state *state, int component, int count, const int *rows,
                 double (*columns)[CHAIN_WRENCH], double *motion)
{
    double unit[CHAIN_WRENCH] = {0.0}, forces[FINGERFEM_MOST_CONTACTS];
    unit[component] = 1.0;
    response_move(problem, state, unit, motion);
    for (int k = 0; k < count; k++) forces[k] = -response_opening(&state->at, rows[k], motion);
    if (!response_forces(&state->at, count, rows, columns, forces)) return 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < contact_size(problem); i++) motion[i] += forces[k] * columns[rows[k]][i];
    return 1;
}

int fingerfem_linearise(const fingerfem_touching *touching, const fingerfem_inertia *inertia, const double *point, const double *loads,
                        double *memory, double *mass, double *compliance)
{
    const fingerfem_chain *chain = touching->chain;
    const contact_step step = {.inertia = inertia};
    double held[TENSIONS_MOST], columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], motion[CHAIN_WRENCH];
    int rows[FINGERFEM_MOST_CONTACTS], count = 0;
    chain_rods map;
    contact_state state;
    contact_problem problem = {touching, &map, {0.0}, NULL, 1.0}, moving = {touching, &map, {0.0}, &step, 1.0};
    const double d = contact_lead(&problem, point + chain->tensions);
    chain_clamped(chain, point, held);
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    memset(state.forces, 0, sizeof state.forces);
    state.at.contacts.count = 0;
    /* the equilibrium with all bodies, from its loads, and its response */
    if (!chain_all_bodies(&map) || !chain_take_loads(&map, loads, state.wrench)) return 0;
    if (contact_solve_from(&problem, d, &state) <= 0 || !response_find(&problem, &state)) return 0;
    for (int k = 0; k < state.at.contacts.count; k++)
        if (state.forces[k] > 0.0) {
            response_yield(&problem, &state, k, columns[k]);
            rows[count++] = k;
        }
    /* M and D, without the ground, which does not move */
    inertia_mass(&moving, &state.at.chain, state.mass);
    const int ground = map.bodies[0].segment == CHAIN_GROUND ? W : 0, size = contact_size(&problem) - ground;
    for (int j = 0; j < size; j++) {
        if (!yield(&problem, &state, ground + j, count, rows, columns, motion)) return 0;
        for (int i = 0; i < size; i++) {
            compliance[size * i + j] = motion[ground + i];
            mass[size * i + j] = state.mass[ground + i][ground + j];
        }
    }
    return 1;
}

int fingerfem_at_rest(const fingerfem_chain *chain, const double *tensions, const double *loads, int branches, double *memory,
                      double *moving, double *relaxing)
{
    double held[TENSIONS_MOST], wrench[CHAIN_WRENCH];
    chain_rods map;
    chain_state state;
    chain_clamped(chain, tensions, held);
    chain_set_tensions(chain, held, memory, &map);
    chain_contract(&map);
    if (!chain_all_bodies(&map) || !chain_take_loads(&map, loads, wrench) || !chain_under(&map, wrench, &state)) return 0;
    for (int b = 0; b < map.count; b++) inertia_at_rest(state.bodies + b, moving + FINGERFEM_MOVING * chain_load_of(&map, b));
    if (branches) relaxation_at_rest(&map, branches, chain->guides ? chain->guides->tensions : tensions, relaxing);
    return 1;
}

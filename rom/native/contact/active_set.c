/* The active set: which contacts press, and with which forces, by block principal pivoting. */
#include "response.h"
#include "../linear_algebra/small.h"

#define PIVOTS 128
#define BLOCKS 3 /* pivots on all wrong contacts without fewer of them, before single ones follow */
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] of a gap below zero that is rounding */

int response_forces(const contact_problem *problem, const placed *at, int count, const int *rows,
                      double (*columns)[CHAIN_WRENCH], double *wanted)
{
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = response_opening(at, rows[i], columns[rows[j]]) + response_compliance(problem, at, rows[i], rows[j]);
    return small_solve(count, a, 1, wanted);
}

int response_balance(const contact_problem *problem, const contact_state *state, double *forces)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = contact_size(problem), all = contacts->count;
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], still[CHAIN_WRENCH], motion[CHAIN_WRENCH];
    int active[FINGERFEM_MOST_CONTACTS], known[FINGERFEM_MOST_CONTACTS] = {0}, fewest = all + 1, tries = 0;
    /* still = C S w: minus the motion of all bodies without contact forces, where w is without inertia's wrenches */
    response_move(problem, state, state->pressed, still);
    for (int k = 0; k < all; k++) active[k] = forces[k] > 0.0;
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int rows[FINGERFEM_MOST_CONTACTS], wrong[FINGERFEM_MOST_CONTACTS], count = 0, wrongs = 0;
        double found[FINGERFEM_MOST_CONTACTS];
        /* active contacts: columns C S W_k, and wanted openings W_k . C S w - g_k, the dome in g_k included */
        for (int k = 0; k < all; k++) {
            if (!active[k]) continue;
            if (!known[k]) response_yield(problem, state, k, columns[k]);
            known[k] = 1;
            found[count] = response_opening(&state->at, k, still) - objects_gap(contacts, k);
            rows[count++] = k;
        }
        /* forces of the active contacts, and motion sum_k f_k C S W_k - C S w of all bodies */
        if (!response_forces(problem, &state->at, count, rows, columns, found)) return 0;
        memset(forces, 0, (size_t)all * sizeof *forces);
        for (int i = 0; i < w; i++) motion[i] = -still[i];
        for (int k = 0; k < count; k++) {
            forces[rows[k]] = found[k];
            for (int i = 0; i < w; i++) motion[i] += found[k] * columns[rows[k]][i];
        }
        /* wrong contacts: active ones that pull, others whose gap g_k + W_k . xi + sum_j c_kj f_j is negative */
        for (int k = 0; k < all; k++)
            if (active[k] ? forces[k] < -PULL
                          : objects_gap(contacts, k) + response_opening(&state->at, k, motion) + response_indentation(problem, &state->at, forces, k) < -INSIDE)
                wrong[wrongs++] = k;
        /* stop: no contact is wrong */
        if (!wrongs) return 1;
        /* exchange the state of all wrong contacts, or only of the first if their number stays for BLOCKS pivots */
        tries = wrongs < fewest ? 0 : tries + 1;
        fewest = wrongs < fewest ? wrongs : fewest;
        if (tries > BLOCKS) wrongs = 1;
        for (int k = 0; k < wrongs; k++) active[wrong[k]] = !active[wrong[k]];
    }
    return 0;
}

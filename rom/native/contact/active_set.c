/* The active set: which contacts press, and with which forces, by block principal pivoting. */
#include "response.h"
#include "../linear_algebra/small.h"

#define PIVOTS 128
#define BLOCKS 3 /* pivots on all wrong contacts without fewer of them, before single ones follow */
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] of a gap below zero that is rounding */

int response_forces(const placed *at, int count, const int *rows, double (*columns)[CHAIN_WRENCH], double *wanted)
{
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = response_opening(at, rows[i], columns[rows[j]]) + response_compliance(at, rows[i], rows[j]);
    return small_solve(count, a, 1, wanted);
}

int response_balance(const contact_problem *problem, const contact_state *state, double *forces)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int all = contacts->count;
    double opened[FINGERFEM_MOST_CONTACTS][FINGERFEM_MOST_CONTACTS], gaps[FINGERFEM_MOST_CONTACTS], motion[CHAIN_WRENCH];
    int active[FINGERFEM_MOST_CONTACTS], known[FINGERFEM_MOST_CONTACTS] = {0}, fewest = all + 1, tries = 0;
    /* gaps without contact forces, g_k - W_k . C S w, the dome in g_k included, where w is without inertia's wrenches */
    response_move(problem, state, state->pressed, motion);
    for (int k = 0; k < all; k++) {
        gaps[k] = objects_gap(contacts, k) - response_opening(&state->at, k, motion);
        active[k] = forces[k] > 0.0;
    }
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int rows[FINGERFEM_MOST_CONTACTS], wrong[FINGERFEM_MOST_CONTACTS], count = 0, wrongs = 0;
        double matrix[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], found[FINGERFEM_MOST_CONTACTS], after[FINGERFEM_MOST_CONTACTS];
        /* by how much unit forces at the active contacts open all of them, W_k . C S W_j + c_kj */
        for (int j = 0; j < all; j++) {
            if (!active[j]) continue;
            rows[count++] = j;
            if (known[j]) continue;
            response_yield(problem, state, j, motion);
            for (int k = 0; k < all; k++) opened[j][k] = response_opening(&state->at, k, motion) + response_compliance(&state->at, k, j);
            known[j] = 1;
        }
        /* forces of the active contacts, which close their gaps */
        for (int i = 0; i < count; i++) {
            found[i] = -gaps[rows[i]];
            for (int j = 0; j < count; j++) matrix[count * i + j] = opened[rows[j]][rows[i]];
        }
        if (!small_solve(count, matrix, 1, found)) return 0;
        /* gaps with them */
        memset(forces, 0, (size_t)all * sizeof *forces);
        memcpy(after, gaps, (size_t)all * sizeof *after);
        for (int j = 0; j < count; j++) {
            forces[rows[j]] = found[j];
            for (int k = 0; k < all; k++) after[k] += found[j] * opened[rows[j]][k];
        }
        /* wrong contacts: active ones that pull, others whose gap is negative */
        for (int k = 0; k < all; k++)
            if (active[k] ? forces[k] < -PULL : after[k] < -INSIDE) wrong[wrongs++] = k;
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

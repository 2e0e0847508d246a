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

/* Columns of the matrix W^T C S W + c, of contacts in the order in which they were active first: `local` ones have c without the indentation of
 * a contact's own slice, of these the first `whole` ones all of it. */
typedef struct {
    int local, whole, rows[FINGERFEM_MOST_CONTACTS], places[FINGERFEM_MOST_CONTACTS]; /* contacts by columns, and back, or -1 */
    response_local points[FINGERFEM_MOST_CONTACTS];
    double matrix[FINGERFEM_MOST_CONTACTS][FINGERFEM_MOST_CONTACTS]; /* column by column */
} opened_columns;

/* Add columns of active contacts that have none. */
static void add_local(const placed *at, const int *active, opened_columns *found)
{
    for (int j = 0; j < at->contacts.count; j++) {
        if (!active[j] || found->places[j] >= 0) continue;
        for (int k = 0; k < at->contacts.count; k++)
            found->matrix[found->local][k] = response_local_between(found->points + k, found->points + j);
        found->rows[found->local] = j;
        found->places[j] = found->local++;
    }
}

/* Complete these. */
static void add_openings(const contact_problem *problem, const contact_state *state, opened_columns *found)
{
    const objects_contacts *contacts = &state->at.contacts;
    small_columns motions[CHAIN_WRENCH];
    while (found->whole < found->local) {
        const int first = found->whole, count = found->local - first < SMALL_COLUMNS ? found->local - first : SMALL_COLUMNS;
        response_yields(problem, state, count, found->rows + first, motions);
        for (int k = 0; k < contacts->count; k++) {
            const contact_arms *arms = state->at.arms + k;
            small_columns sum = {0.0};
            for (int a = 0; a < arms->count; a++)
                for (int i = 0; i < W; i++)
                    for (int c = 0; c < SMALL_COLUMNS; c++) sum[c] += arms->wrenches[a][i] * motions[W * arms->bodies[a] + i][c];
            for (int c = 0; c < count; c++) found->matrix[first + c][k] += sum[c];
        }
        for (; found->whole < first + count; found->whole++) {
            const int k = found->rows[found->whole];
            found->matrix[found->whole][k] += contacts->compliance[k] / contacts->shares[k];
        }
    }
}

/* Numbers of all contacts plus the matrix times those of its columns. */
static void add_product(const opened_columns *columns, const double *by, int all, double *found)
{
    for (int c = 0; c < columns->local; c++)
        for (int k = 0; k < all && by[c] != 0.0; k++) found[k] += columns->matrix[c][k] * by[c];
}

int response_balance(const contact_problem *problem, contact_state *state, double *forces)
{
    objects_contacts *contacts = &state->at.contacts;
    const int all = contacts->count;
    opened_columns columns; /* zeros in all of it would take longer than the rest */
    double gaps[FINGERFEM_MOST_CONTACTS], pressing[FINGERFEM_MOST_CONTACTS], after[FINGERFEM_MOST_CONTACTS] = {0.0}, motion[CHAIN_WRENCH];
    int active[FINGERFEM_MOST_CONTACTS], fewest = all + 1, tries = 0;
    columns.local = columns.whole = 0;
    if (!all) return 1;
    /* indentation of slices, which other forces lower */
    for (int k = 0; k < all; k++) {
        active[k] = forces[k] > 0.0;
        columns.places[k] = -1;
        response_see(&state->at, k, columns.points + k);
    }
    add_local(&state->at, active, &columns);
    for (int c = 0; c < columns.local; c++) pressing[c] = forces[columns.rows[c]];
    add_product(&columns, pressing, all, after);
    response_indent(contacts, after);
    /* gaps without contact forces, g_k - W_k . C S w, the dome in g_k included, where w is without inertia's wrenches */
    response_move(problem, state, state->pressed, motion);
    for (int k = 0; k < all; k++) gaps[k] = objects_gap(contacts, k) - response_opening(&state->at, k, motion);
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int those[FINGERFEM_MOST_CONTACTS], wrong[FINGERFEM_MOST_CONTACTS], count = 0, wrongs = 0;
        double matrix[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], found[FINGERFEM_MOST_CONTACTS];
        add_local(&state->at, active, &columns);
        add_openings(problem, state, &columns);
        /* forces of the active contacts, which close their gaps */
        for (int k = 0; k < all; k++)
            if (active[k]) those[count++] = k;
        for (int i = 0; i < count; i++) {
            found[i] = -gaps[those[i]];
            for (int j = 0; j < count; j++) matrix[count * i + j] = columns.matrix[columns.places[those[j]]][those[i]];
        }
        if (!small_solve(count, matrix, 1, found)) return 0;
        /* gaps with them */
        memset(forces, 0, (size_t)all * sizeof *forces);
        memset(pressing, 0, (size_t)columns.local * sizeof *pressing);
        for (int j = 0; j < count; j++) forces[those[j]] = pressing[columns.places[those[j]]] = found[j];
        memcpy(after, gaps, (size_t)all * sizeof *after);
        add_product(&columns, pressing, all, after);
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

#include "response.h"
#include <math.h>
#include "small.h"

#define INLINE __attribute__((always_inline)) static inline
#define PIVOTS 64
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] */

/* G: how W f changes as the plates move. */
static void follow(const contact_problem *problem, contact_state *state)
{
    const objects_contacts *contacts = &state->at.contacts;
    for (int i = 0; i < problem->size; i++)
        memset(state->following[i], 0, (size_t)problem->size * sizeof **state->following);
    for (int k = 0; k < contacts->count; k++) {
        if (state->forces[k] == 0.0) continue;
        const int first = W * contacts->plates[k];
        double own[W][W];
        objects_change(problem->touching->object, contacts, k, own);
        for (int i = 0; i < W; i++)
            for (int j = 0; j < W; j++) state->following[first + i][first + j] += state->forces[k] * own[i][j];
    }
}

INLINE void product(int size, const chain_matrix a, const chain_matrix b, chain_matrix out)
{
    for (int i = 0; i < size; i++) {
        for (int j = 0; j < size; j++) out[i][j] = 0.0;
        for (int k = 0; k < size; k++)
            for (int j = 0; j < size; j++) out[i][j] += a[i][k] * b[k][j];
    }
}

/* S = (1 - G C)^-1 and C S. */
INLINE int find(int size, contact_state *state)
{
    chain_matrix compliance, made;
    double system[CHAIN_WRENCH * CHAIN_WRENCH], inverse[CHAIN_WRENCH * CHAIN_WRENCH];
    for (int i = 0; i < size; i++)
        memcpy(compliance[i], state->at.chain.plates[i / W].motion[i % W], (size_t)size * sizeof **compliance);
    product(size, state->following, compliance, made);
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) {
            inverse[size * i + j] = i == j;
            system[size * i + j] = (i == j) - made[i][j];
        }
    if (!small_solve_of(size, system, size, inverse)) return 0;
    for (int i = 0; i < size; i++) memcpy(state->soft[i], inverse + size * i, (size_t)size * sizeof *inverse);
    product(size, compliance, state->soft, state->yielding);
    return 1;
}

int response_find(const contact_problem *problem, contact_state *state)
{
    follow(problem, state);
    return problem->size == W ? find(W, state) : find(problem->size, state); /* the loops of one plate are unrolled */
}

void response_product(int size, const chain_matrix m, const double *vector, double *out)
{
    for (int i = 0; i < size; i++) {
        out[i] = 0.0;
        for (int j = 0; j < size; j++) out[i] += m[i][j] * vector[j];
    }
}

/* The motion of all plates with a unit force at a contact, C S W. */
static void yield(const contact_problem *problem, const contact_state *state, int k, double *out)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int first = W * contacts->plates[k];
    for (int i = 0; i < problem->size; i++) {
        out[i] = 0.0;
        for (int j = 0; j < W; j++) out[i] += state->yielding[i][first + j] * contacts->wrenches[k][j];
    }
}

/* How much the gap of a contact grows with a motion of all plates. */
static double opening(const objects_contacts *contacts, int k, const double *motion)
{
    const double *own = motion + W * contacts->plates[k], *wrench = contacts->wrenches[k];
    double sum = 0.0;
    for (int i = 0; i < W; i++) sum += own[i] * wrench[i];
    return sum;
}

/* Solve for forces, (count), at some contacts whose gaps open by them as much as is wanted. */
static int forces_for(const objects_contacts *contacts, int count, const int *rows,
                      double (*columns)[CHAIN_WRENCH], double *wanted)
{
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = opening(contacts, rows[i], columns[rows[j]]) + (i == j ? SOFT : 0.0);
    return small_solve(count, a, 1, wanted);
}

int response_balance(const contact_problem *problem, const contact_state *state, double *forces)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = problem->size;
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], still[CHAIN_WRENCH], motion[CHAIN_WRENCH];
    int active[FINGERFEM_MOST_CONTACTS], known[FINGERFEM_MOST_CONTACTS] = {0};
    response_product(w, state->yielding, state->wrench, still);
    for (int k = 0; k < contacts->count; k++) active[k] = forces[k] > 0.0;
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int rows[FINGERFEM_MOST_CONTACTS], count = 0, wrong = -1;
        double found[FINGERFEM_MOST_CONTACTS];
        for (int k = 0; k < contacts->count; k++) {
            if (!active[k]) continue;
            if (!known[k]) yield(problem, state, k, columns[k]);
            known[k] = 1;
            found[count] = opening(contacts, k, still) - contacts->gaps[k];
            rows[count++] = k;
        }
        if (!forces_for(contacts, count, rows, columns, found)) return 0;
        memset(forces, 0, (size_t)contacts->count * sizeof *forces);
        for (int i = 0; i < w; i++) motion[i] = -still[i];
        for (int k = 0; k < count; k++) {
            forces[rows[k]] = found[k];
            for (int i = 0; i < w; i++) motion[i] += found[k] * columns[rows[k]][i];
        }
        for (int k = 0; k < contacts->count && wrong < 0; k++)
            if (active[k] ? forces[k] < -PULL : contacts->gaps[k] + opening(contacts, k, motion) < -INSIDE) wrong = k;
        if (wrong < 0) return 1;
        active[wrong] = !active[wrong];
    }
    return 0;
}

/* The contacts that press, and the motion with a unit force at each; their number. */
static int pressing(const contact_problem *problem, const contact_state *state, int *rows,
                    double (*columns)[CHAIN_WRENCH])
{
    int count = 0;
    for (int k = 0; k < state->at.contacts.count; k++) {
        if (!(state->forces[k] > 0.0)) continue;
        yield(problem, state, k, columns[k]);
        rows[count++] = k;
    }
    return count;
}

/* Add how the wrench of a force at a contact changes as the plate's point there moves by v: the normal turns as if the plate
 * moved, and the arm is another. */
static void bend(const contact_problem *problem, const contact_state *state, int k, const double *v, double *turned)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int first = W * contacts->plates[k];
    double own[W][W], moment[3];
    objects_change(problem->touching->object, contacts, k, own);
    objects_cross(v, contacts->wrenches[k], moment);
    for (int i = 0; i < W; i++)
        turned[first + i] += state->forces[k] * (objects_dot(own[i], v) + (i < 3 ? 0.0 : moment[i - 3]));
}

int response_follow(const contact_problem *problem, const contact_state *state, const double *drift, const double *bends,
                    double *wrench_change)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = problem->size;
    int rows[FINGERFEM_MOST_CONTACTS];
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], turned[CHAIN_WRENCH], motion[CHAIN_WRENCH];
    double forces[FINGERFEM_MOST_CONTACTS];
    const int count = pressing(problem, state, rows, columns);
    response_product(w, state->following, drift, turned);
    for (int k = 0; k < count && bends; k++) bend(problem, state, rows[k], bends + 3 * rows[k], turned);
    response_product(w, state->yielding, turned, motion);
    for (int i = 0; i < w; i++) motion[i] += drift[i];
    for (int k = 0; k < count; k++) {
        forces[k] = -opening(contacts, rows[k], motion);
        if (bends) forces[k] -= objects_dot(contacts->wrenches[rows[k]], bends + 3 * rows[k]);
    }
    if (!forces_for(contacts, count, rows, columns, forces)) return 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++)
            turned[W * contacts->plates[rows[k]] + i] += forces[k] * contacts->wrenches[rows[k]][i];
    response_product(w, state->soft, turned, wrench_change);
    return 1;
}

int response_stable(const contact_problem *problem, const contact_state *state)
{
    const int w = problem->size;
    int rows[FINGERFEM_MOST_CONTACTS];
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], yielding[CHAIN_WRENCH * CHAIN_WRENCH];
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    const int count = pressing(problem, state, rows, columns);
    for (int i = 0; i < w; i++) memcpy(yielding + w * i, state->yielding[i], (size_t)w * sizeof *yielding);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = opening(&state->at.contacts, rows[i], columns[rows[j]]) + (i == j ? SOFT : 0.0);
    return small_negative(w, yielding) == small_negative(count, a); /* of 1/K as of K */
}

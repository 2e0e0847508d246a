/* What an object and plates do to each other: complementarity of gaps and forces, linearised about the last poses.
 *
 * The plates move by xi = C dw with their wrenches w, C the compliance. Contact forces f >= 0 make the wrenches W f, and as
 * the plates move these change by G xi besides, for the normals turn in their frames. So, from w,
 *
 *     dw = S (W f - w),    S = (1 - G C)^-1,    gaps + W^T C dw >= 0,  with f or the gap zero at every contact.
 *
 * The next pose is where this leads; near the end it is Newton's method.
 */
#include <math.h>
#include <stdlib.h>
#include "contact.h"
#include "small.h"

#define INLINE __attribute__((always_inline)) static inline
#define ITERATIONS 30
#define STEPS 4      /* on that way, at first */
#define HALVINGS 10  /* of such a step until there is no answer */
#define EVALUATIONS 500 /* most of the map for one answer */
#define CLOSE 1e-7   /* of the box: a last step of the wrench, a small part of which is left [-] */
#define LONGEST 0.5  /* of the box: a step of the wrench [-] */

/* W f, and G: how that changes as the plates move. */
static void pressed(const contact_problem *problem, const objects_contacts *contacts, const double *forces,
                    double *wrench, chain_matrix change)
{
    memset(wrench, 0, (size_t)problem->size * sizeof *wrench);
    for (int i = 0; i < problem->size; i++) memset(change[i], 0, (size_t)problem->size * sizeof *change[i]);
    for (int k = 0; k < contacts->count; k++) {
        if (forces[k] == 0.0) continue;
        const int first = W * contacts->plates[k];
        double own[W][W];
        objects_change(problem->touching->object, contacts, k, own);
        for (int i = 0; i < W; i++) {
            wrench[first + i] += forces[k] * contacts->wrenches[k][i];
            for (int j = 0; j < W; j++) change[first + i][first + j] += forces[k] * own[i][j];
        }
    }
}

/* C, of all plates. */
static void compliance(const contact_state *state, int size, chain_matrix out)
{
    for (int i = 0; i < size; i++) memcpy(out[i], state->at.chain.plates[i / W].motion[i % W], (size_t)size * sizeof **out);
}

INLINE void product(int size, const chain_matrix a, const chain_matrix b, chain_matrix out)
{
    for (int i = 0; i < size; i++) {
        for (int j = 0; j < size; j++) out[i][j] = 0.0;
        for (int k = 0; k < size; k++)
            for (int j = 0; j < size; j++) out[i][j] += a[i][k] * b[k][j];
    }
}

/* S = (1 - G C)^-1 and C S; returns 0 if there is none. */
INLINE int softened_of(int size, contact_state *state)
{
    chain_matrix moved, made;
    double system[size * size], inverse[size * size];
    compliance(state, size, moved);
    product(size, state->following, moved, made);
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) {
            inverse[size * i + j] = i == j;
            system[size * i + j] = (i == j) - made[i][j];
        }
    if (!small_solve(size, system, size, inverse)) return 0;
    for (int i = 0; i < size; i++) memcpy(state->soft[i], inverse + size * i, (size_t)size * sizeof *inverse);
    product(size, moved, state->soft, state->yielding);
    return 1;
}

/* The loops of one plate are unrolled. */
static int softened(int size, contact_state *state) { return size == W ? softened_of(W, state) : softened_of(size, state); }

static double dot(int size, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < size; i++) sum += a[i] * b[i];
    return sum;
}

/* The wrench of a contact, as a row, times a matrix. */
static void row_product(const contact_problem *problem, const objects_contacts *contacts, int k, const chain_matrix m,
                        double *out)
{
    const double *row = contacts->wrenches[k];
    const int first = W * contacts->plates[k];
    for (int j = 0; j < problem->size; j++) out[j] = 0.0;
    for (int i = 0; i < W; i++)
        for (int j = 0; j < problem->size; j++) out[j] += row[i] * m[first + i][j];
}

/* A row of all wrenches times the wrench of a contact. */
static double along(const double *row, const objects_contacts *contacts, int k)
{
    return dot(W, row + W * contacts->plates[k], contacts->wrenches[k]);
}

/* Forces that the contacts had before, found again by their names. */
static void carry(const objects_contacts *before, const double *forces, const objects_contacts *now, double *found)
{
    for (int k = 0; k < now->count; k++) {
        found[k] = 0.0;
        for (int j = 0; j < before->count; j++)
            if (before->names[j] == now->names[k] && before->plates[j] == now->plates[k]) found[k] = forces[j];
    }
}

/* One step; returns the largest change of what a plate bears over its box, negative if there is none. */
static double step(const contact_problem *problem, contact_state *state)
{
    const fingerfem_chain *chain = problem->touching->chain;
    objects_contacts *contacts = &state->at.contacts;
    const int count = contacts->count, w = problem->size;
    double made[CHAIN_WRENCH], target[CHAIN_WRENCH], change[CHAIN_WRENCH];
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], b[FINGERFEM_MOST_CONTACTS];
    pressed(problem, contacts, state->forces, made, state->following);
    if (!softened(w, state)) return -1.0;
    for (int i = 0; i < count; i++) {
        double row[CHAIN_WRENCH];
        row_product(problem, contacts, i, state->yielding, row);
        b[i] = contacts->gaps[i] - dot(w, row, state->wrench);
        for (int j = 0; j < count; j++) a[count * i + j] = along(row, contacts, j);
    }
    double forces[FINGERFEM_MOST_CONTACTS];
    memcpy(forces, state->forces, sizeof forces);
    if (!small_complementarity(count, a, b, SOFT, forces)) return -1.0;
    for (int i = 0; i < w; i++) target[i] = -state->wrench[i];
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++) target[W * contacts->plates[k] + i] += forces[k] * contacts->wrenches[k][i];
    double size = 0.0;
    for (int i = 0; i < w; i++) {
        const fingerfem_segment *segment = chain->segments[i / W];
        change[i] = dot(w, state->soft[i], target);
        const double own = fabs(change[i]) / segment->upper[segment->tensions + i % W];
        if (own > size || isnan(own)) size = own;
    }
    if (isnan(size)) return -1.0;
    const double share = size > LONGEST ? LONGEST / size : 1.0;
    for (int i = 0; i < w; i++) state->wrench[i] += share * change[i];
    for (int k = 0; k < count; k++) state->forces[k] += share * (forces[k] - state->forces[k]);
    for (int k = 0; k < chain->plates; k++) { /* where the next pose would be found */
        chain_plate *plate = state->at.chain.plates + k;
        for (int j = 0; j < 3; j++) {
            const double moved = share * dot(w, plate->motion[j], change);
            for (int i = 0; i < 3; i++) plate->centre[i] += plate->rotation[3 * i + j] * moved;
        }
    }
    return size;
}

/* Solve from a state's wrench and forces; returns the number of evaluations, negative if it did not end. */
static int solve_from(const contact_problem *problem, double d, contact_state *state)
{
    objects_contacts before = state->at.contacts;
    for (int k = 1; k <= ITERATIONS; k++) {
        double forces[FINGERFEM_MOST_CONTACTS];
        memcpy(forces, state->forces, sizeof forces);
        placed_under(problem, state->wrench, d, &state->at);
        carry(&before, forces, &state->at.contacts, state->forces);
        const double size = step(problem, state);
        if (size < 0.0) return -k;
        if (size < CLOSE) return k;
        before = state->at.contacts;
    }
    return -ITERATIONS;
}

/* Bring the object from where it touches the free plate to d, so that of several answers the one is found that its
 * approach leads to; returns as `solve_from`. */
static int approach(const contact_problem *problem, double touch, double d, contact_state *state)
{
    int evaluations = 0;
    double at = touch, size = (d - touch) / STEPS;
    const double least = fabs(size) / (1 << HALVINGS);
    memset(state->wrench, 0, sizeof state->wrench);
    state->at.contacts.count = 0;
    while (at > d) {
        contact_state last = *state;
        const double next = at + size > d + least ? at + size : d;
        const int used = solve_from(problem, next, state);
        evaluations += abs(used);
        if (used > 0) {
            at = next;
            size *= 1.5;
            continue;
        }
        *state = last;
        size /= 2.0;
        if (fabs(size) < least || evaluations > EVALUATIONS) return -evaluations;
    }
    return evaluations;
}

/* Solve at d: from a wrench that is known; or at once, where that is near enough; or from where the object touches. */
int contact_solve(const contact_problem *problem, double touch, double d, contact_state *state)
{
    const double shallow = objects_shallow(problem->touching->object, problem->touching->chain->segments[0]->half_lengths);
    int known = 0, evaluations = 0;
    for (int i = 0; i < problem->size; i++) known |= state->wrench[i] != 0.0;
    if (known || touch - d < shallow) {
        state->at.contacts.count = 0;
        evaluations = solve_from(problem, d, state);
        if (evaluations > 0) return evaluations;
    }
    const int more = approach(problem, touch, d, state);
    return more > 0 ? abs(evaluations) + more : evaluations - abs(more);
}

/* W^T C S W of the contacts that press, and a little more on its diagonal: (pressing, pressing); their number. */
static int pressing(const contact_problem *problem, const contact_state *state, int *rows, double *found)
{
    const objects_contacts *contacts = &state->at.contacts;
    int count = 0;
    for (int k = 0; k < contacts->count; k++)
        if (state->forces[k] > 0.0) rows[count++] = k;
    for (int i = 0; i < count; i++) {
        double row[CHAIN_WRENCH];
        row_product(problem, contacts, rows[i], state->yielding, row);
        for (int j = 0; j < count; j++) found[count * i + j] = along(row, contacts, rows[j]) + (i == j ? SOFT : 0.0);
    }
    return count;
}

int contact_follow(const contact_problem *problem, const contact_state *state, const double *drift,
                   double *wrench_change)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = problem->size;
    int rows[FINGERFEM_MOST_CONTACTS];
    double turned[CHAIN_WRENCH], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], forces[FINGERFEM_MOST_CONTACTS];
    const int count = pressing(problem, state, rows, a);
    for (int i = 0; i < w; i++) turned[i] = dot(w, state->following[i], drift);
    for (int i = 0; i < count; i++) {
        double row[CHAIN_WRENCH];
        row_product(problem, contacts, rows[i], state->yielding, row);
        forces[i] = -dot(w, row, turned) - along(drift, contacts, rows[i]);
    }
    if (!small_solve(count, a, 1, forces)) return 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++)
            turned[W * contacts->plates[rows[k]] + i] += forces[k] * contacts->wrenches[rows[k]][i];
    for (int i = 0; i < w; i++) wrench_change[i] = dot(w, state->soft[i], turned);
    return 1;
}

int contact_stable(const contact_problem *problem, const contact_state *state)
{
    const int w = problem->size;
    int rows[FINGERFEM_MOST_CONTACTS];
    double yielding[w * w], stiffness[w * w], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < w; i++)
        for (int j = 0; j < w; j++) {
            yielding[w * i + j] = state->yielding[i][j];
            stiffness[w * i + j] = i == j;
        }
    if (!small_solve(w, yielding, w, stiffness)) return 0;
    const int count = pressing(problem, state, rows, a);
    return small_negative(w, stiffness) == small_negative(count, a);
}

#include "response.h"
#include <math.h>
#include <stdlib.h>
#include "../linear_algebra/small.h"

#define INLINE __attribute__((always_inline)) static inline
#define PIVOTS 128
#define BLOCKS 3 /* pivots of all contacts at once without fewer wrong ones, until one at a time */
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] */

/* How what a unit force at contact k puts on its bodies changes as these move: (6 bodies, 6 bodies). */
static void changes_of(const contact_problem *problem, const contact_state *state, int k, double (*found)[SLICE_INPUTS])
{
    const objects_contacts *contacts = &state->at.contacts;
    double own[W][W];
    if (state->at.arms[k].count > 1) {
        slices_change(problem, state->at.d, &state->at, k, NULL, found);
        return;
    }
    objects_change(contact_object(problem, contacts->objects[k]), contacts, k, own);
    for (int i = 0; i < W; i++) memcpy(found[i], own[i], sizeof own[i]);
}

/* G: how W f changes as the bodies move. */
static void follow(const contact_problem *problem, contact_state *state)
{
    const int size = contact_size(problem);
    for (int i = 0; i < size; i++) memset(state->following[i], 0, (size_t)size * sizeof **state->following);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        double own[SLICE_INPUTS][SLICE_INPUTS];
        if (state->forces[k] == 0.0) continue;
        changes_of(problem, state, k, own);
        for (int a = 0; a < arms->count; a++)
            for (int b = 0; b < arms->count; b++)
                for (int i = 0; i < W; i++)
                    for (int j = 0; j < W; j++)
                        state->following[W * arms->bodies[a] + i][W * arms->bodies[b] + j] +=
                            state->forces[k] * own[W * a + i][W * b + j];
    }
}

/* Its part of the contacts with one object, times a motion. */
static void follow_one(const contact_problem *problem, const contact_state *state, int object, const double *motion, double *wrench)
{
    memset(wrench, 0, (size_t)contact_size(problem) * sizeof *wrench);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        double own[SLICE_INPUTS][SLICE_INPUTS];
        if (state->forces[k] == 0.0 || state->at.contacts.objects[k] != object) continue;
        changes_of(problem, state, k, own);
        for (int a = 0; a < arms->count; a++)
            for (int b = 0; b < arms->count; b++)
                for (int i = 0; i < W; i++)
                    for (int j = 0; j < W; j++)
                        wrench[W * arms->bodies[a] + i] += state->forces[k] * own[W * a + i][W * b + j] * motion[W * arms->bodies[b] + j];
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
        memcpy(compliance[i], state->at.chain.bodies[i / W].motion[i % W], (size_t)size * sizeof **compliance);
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
    return contact_size(problem) == W ? find(W, state) : find(contact_size(problem), state); /* the loops of one plate are unrolled */
}

void response_product(int size, const chain_matrix m, const double *vector, double *out)
{
    for (int i = 0; i < size; i++) {
        out[i] = 0.0;
        for (int j = 0; j < size; j++) out[i] += m[i][j] * vector[j];
    }
}

/* The motion of all bodies with a unit force at a contact, C S W. */
static void yield(const contact_problem *problem, const contact_state *state, int k, double *out)
{
    const contact_arms *arms = state->at.arms + k;
    const int size = contact_size(problem);
    for (int i = 0; i < size; i++) {
        out[i] = 0.0;
        for (int a = 0; a < arms->count; a++)
            for (int j = 0; j < W; j++) out[i] += state->yielding[i][W * arms->bodies[a] + j] * arms->wrenches[a][j];
    }
}

/* How much the gap of a contact grows with a motion of all bodies. */
static double opening(const placed *at, int k, const double *motion)
{
    const contact_arms *arms = at->arms + k;
    double sum = 0.0;
    for (int a = 0; a < arms->count; a++)
        for (int i = 0; i < W; i++) sum += motion[W * arms->bodies[a] + i] * arms->wrenches[a][i];
    return sum;
}

void response_press(const placed *at, int k, double force, double *wrench)
{
    const contact_arms *arms = at->arms + k;
    for (int a = 0; a < arms->count; a++)
        for (int i = 0; i < W; i++) wrench[W * arms->bodies[a] + i] += force * arms->wrenches[a][i];
}

/* The deflection at the fraction a of an element, clamped at both ends, by a unit force at its fraction b [m/N]. It is that of a
 * cantilever, minus the part of the reactions at its other end; phi as in slice_forces.c. */
static double deflection(double length, double phi, double stiffness, double a, double b)
{
    const double near = fmin(a, b), far = fmax(a, b), held = 12.0 / (1.0 + phi);
    const double free = near * near * (3.0 * far - near) / 6.0 + phi * near / 12.0;
    const double way_a = a * a * (3.0 - a) / 6.0 + phi * a / 12.0, way_b = b * b * (3.0 - b) / 6.0 + phi * b / 12.0;
    const double turn_a = 0.5 * a * a, turn_b = 0.5 * b * b;
    const double back = held * (way_a * way_b - 0.5 * (way_a * turn_b + turn_a * way_b) + (1.0 / 3.0 + phi / 12.0) * turn_a * turn_b);
    return length * length * length / stiffness * (free - back);
}

/* This deflection at contact k by a unit force at another one, along both normals; 0 if they are on different elements. */
static double element_compliance(const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const rubber_slice *own = placed_slice_of(at, k), *its = placed_slice_of(at, other);
    if (!own || !its || own->segment != its->segment || own->element != its->element) return 0.0;
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    const double a = own->share + contacts->points[k][0] / own->length, b = its->share + contacts->points[other][0] / its->length;
    return (n[1] * m[1] + n[2] * m[2]) * deflection(own->length, own->slender, own->stiffness, a, b);
}

/* Between two slices: the components of both normals that press on the same face count by that face's compliance, those on
 * opposite faces by the opposite one's. */
double response_compliance(const contact_problem *problem, const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const int segment = contacts->segments[k], away = abs(contacts->plates[k] - contacts->plates[other]);
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    double sum = 0.0;
    if (k == other) return contacts->compliance[k] + element_compliance(at, k, k);
    if (segment < 0 || segment != contacts->segments[other] || contacts->compliance[k] == OBJECTS_COMPLIANCE) return 0.0;
    const fingerfem_segment *own = problem->touching->chain->segments[segment];
    for (int i = 1; i < 3; i++) sum += n[i] * m[i] > 0.0 ? n[i] * m[i] * own->row_compliance[away] : -n[i] * m[i] * own->opposite_compliance[away];
    return sum + element_compliance(at, k, other);
}

double response_indentation(const contact_problem *problem, const placed *at, const double *forces, int k)
{
    double sum = 0.0;
    for (int j = 0; j < at->contacts.count; j++)
        if (forces[j] > 0.0) sum += response_compliance(problem, at, k, j) * forces[j];
    return sum;
}

/* Solve for forces, (count), at some contacts whose gaps open by them as much as is wanted. */
static int forces_for(const contact_problem *problem, const placed *at, int count, const int *rows,
                      double (*columns)[CHAIN_WRENCH], double *wanted)
{
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = opening(at, rows[i], columns[rows[j]]) + response_compliance(problem, at, rows[i], rows[j]);
    return small_solve(count, a, 1, wanted);
}

int response_balance(const contact_problem *problem, const contact_state *state, double *forces)
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = contact_size(problem), all = contacts->count;
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], still[CHAIN_WRENCH], motion[CHAIN_WRENCH];
    int active[FINGERFEM_MOST_CONTACTS], known[FINGERFEM_MOST_CONTACTS] = {0}, fewest = all + 1, tries = 0;
    response_product(w, state->yielding, state->wrench, still);
    for (int k = 0; k < all; k++) active[k] = forces[k] > 0.0;
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int rows[FINGERFEM_MOST_CONTACTS], wrong[FINGERFEM_MOST_CONTACTS], count = 0, wrongs = 0;
        double found[FINGERFEM_MOST_CONTACTS];
        for (int k = 0; k < all; k++) {
            if (!active[k]) continue;
            if (!known[k]) yield(problem, state, k, columns[k]);
            known[k] = 1;
            found[count] = opening(&state->at, k, still) - contacts->gaps[k] - contacts->domes[k];
            rows[count++] = k;
        }
        if (!forces_for(problem, &state->at, count, rows, columns, found)) return 0;
        memset(forces, 0, (size_t)all * sizeof *forces);
        for (int i = 0; i < w; i++) motion[i] = -still[i];
        for (int k = 0; k < count; k++) {
            forces[rows[k]] = found[k];
            for (int i = 0; i < w; i++) motion[i] += found[k] * columns[rows[k]][i];
        }
        for (int k = 0; k < all; k++)
            if (active[k] ? forces[k] < -PULL
                          : contacts->gaps[k] + contacts->domes[k] + opening(&state->at, k, motion) + response_indentation(problem, &state->at, forces, k) < -INSIDE)
                wrong[wrongs++] = k;
        if (!wrongs) return 1;
        tries = wrongs < fewest ? 0 : tries + 1;
        fewest = wrongs < fewest ? wrongs : fewest;
        if (tries > BLOCKS) wrongs = 1;
        for (int k = 0; k < wrongs; k++) active[wrong[k]] = !active[wrong[k]];
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
    if (state->at.arms[k].count > 1) return; /* a slice's shape by tensions does not count beside the bending */
    const int first = W * state->at.arms[k].bodies[0];
    double own[W][W], moment[3];
    objects_change(contact_object(problem, contacts->objects[k]), contacts, k, own);
    objects_cross(v, contacts->wrenches[k], moment);
    for (int i = 0; i < W; i++)
        turned[first + i] += state->forces[k] * (objects_dot(own[i], v) + (i < 3 ? 0.0 : moment[i - 3]));
}

void response_wrenches(const contact_problem *problem, const contact_state *state, int object, double *wrench)
{
    memset(wrench, 0, (size_t)contact_size(problem) * sizeof *wrench);
    for (int k = 0; k < state->at.contacts.count; k++)
        if (state->at.contacts.objects[k] == object) response_press(&state->at, k, state->forces[k], wrench);
}

/* What the wrenches of every object's contacts change, as pressing contacts' forces change and bodies move besides their drift. */
static void follow_each(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                        int count, const int *rows, const double *forces, const double *change, double (*by_object)[CHAIN_WRENCH])
{
    const int w = contact_size(problem);
    for (int j = 0; j < problem->touching->count; j++) {
        double motion[CHAIN_WRENCH];
        for (int i = 0; i < w; i++) {
            motion[i] = only < 0 || only == j ? drift[i] : 0.0;
            for (int k = 0; k < w; k++) motion[i] += state->at.chain.bodies[i / W].motion[i % W][k] * change[k];
        }
        follow_one(problem, state, j, motion, by_object[j]);
        for (int k = 0; k < count; k++) {
            if (state->at.contacts.objects[rows[k]] != j) continue;
            if (bends) bend(problem, state, rows[k], bends + 3 * rows[k], by_object[j]);
            response_press(&state->at, rows[k], forces[k], by_object[j]);
        }
    }
}

int response_follow(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                    double *wrench_change, double (*by_object)[CHAIN_WRENCH])
{
    const objects_contacts *contacts = &state->at.contacts;
    const int w = contact_size(problem);
    int rows[FINGERFEM_MOST_CONTACTS];
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], turned[CHAIN_WRENCH], motion[CHAIN_WRENCH];
    double forces[FINGERFEM_MOST_CONTACTS];
    const int count = pressing(problem, state, rows, columns);
    if (only >= 0) follow_one(problem, state, only, drift, turned);
    else response_product(w, state->following, drift, turned);
    for (int k = 0; k < count && bends; k++) bend(problem, state, rows[k], bends + 3 * rows[k], turned);
    response_product(w, state->yielding, turned, motion);
    for (int i = 0; i < w && only < 0; i++) motion[i] += drift[i];
    for (int k = 0; k < count; k++) {
        forces[k] = -opening(&state->at, rows[k], motion);
        if (contacts->objects[rows[k]] == only) forces[k] -= opening(&state->at, rows[k], drift);
        if (bends) forces[k] -= objects_dot(contacts->wrenches[rows[k]], bends + 3 * rows[k]);
    }
    if (!forces_for(problem, &state->at, count, rows, columns, forces)) return 0;
    for (int k = 0; k < count; k++) response_press(&state->at, rows[k], forces[k], turned);
    response_product(w, state->soft, turned, wrench_change);
    if (problem->touching->count == 1) memcpy(by_object[0], wrench_change, (size_t)w * sizeof *wrench_change);
    else follow_each(problem, state, only, drift, bends, count, rows, forces, wrench_change, by_object);
    return 1;
}

int response_stable(const contact_problem *problem, const contact_state *state)
{
    const int ground = problem->map->bodies[0].segment == CHAIN_GROUND ? W : 0, w = contact_size(problem) - ground;
    int rows[FINGERFEM_MOST_CONTACTS];
    double columns[FINGERFEM_MOST_CONTACTS][CHAIN_WRENCH], yielding[CHAIN_WRENCH * CHAIN_WRENCH];
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    const int count = pressing(problem, state, rows, columns);
    for (int i = 0; i < w; i++) memcpy(yielding + w * i, state->yielding[ground + i] + ground, (size_t)w * sizeof *yielding);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = opening(&state->at, rows[i], columns[rows[j]]) + response_compliance(problem, &state->at, rows[i], rows[j]);
    return small_negative(w, yielding) == small_negative(count, a); /* of 1/K as of K */
}

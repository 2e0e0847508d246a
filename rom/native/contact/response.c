/* Response of the bodies to contact forces: G, S and C S, derivatives, and stability. */
#include "acting.h"
#include "inertia.h"
#include "response.h"
#include "slices.h"
#include "../linear_algebra/small.h"

/* Change of the wrenches of a unit force at contact k with the motions of its bodies: (6 bodies, 6 bodies). */
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

/* G: change of the wrenches sum_k f_k W_k with the motions of the bodies. */
static void follow(const contact_problem *problem, contact_state *state)
{
    const int size = contact_size(problem);
    for (int i = 0; i < size; i++) memset(state->following[i], 0, (size_t)size * sizeof **state->following);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        double own[SLICE_INPUTS][SLICE_INPUTS];
        if (state->forces[k] == 0.0) continue;
        changes_of(problem, state, k, own);
        acting_change(&state->at, k, own);
        const double force = problem->share * acting_force(state, k);
        /* G += f_k dW_k, in the blocks of the contact's bodies a, b */
        for (int a = 0; a < arms->count; a++)
            for (int b = 0; b < arms->count; b++)
                for (int i = 0; i < W; i++)
                    for (int j = 0; j < W; j++)
                        state->following[W * arms->bodies[a] + i][W * arms->bodies[b] + j] +=
                            force * own[W * a + i][W * b + j];
    }
}

/* G_j xi: the part of G of the contacts with one object j, times a motion xi of all bodies. */
static void follow_one(const contact_problem *problem, const contact_state *state, int object, const double *motion, double *wrench)
{
    memset(wrench, 0, (size_t)contact_size(problem) * sizeof *wrench);
    for (int k = 0; k < state->at.contacts.count; k++) {
        const contact_arms *arms = state->at.arms + k;
        double own[SLICE_INPUTS][SLICE_INPUTS];
        if (state->forces[k] == 0.0 || state->at.contacts.objects[k] != object) continue;
        changes_of(problem, state, k, own);
        /* wrench += f_k dW_k xi */
        for (int a = 0; a < arms->count; a++)
            for (int b = 0; b < arms->count; b++)
                for (int i = 0; i < W; i++)
                    for (int j = 0; j < W; j++)
                        wrench[W * arms->bodies[a] + i] += state->forces[k] * own[W * a + i][W * b + j] * motion[W * arms->bodies[b] + j];
    }
}

/* Factors of 1 - G C. Rows of G have few numbers: those of bodies that contact or mass connects. */
static int factorise(int size, contact_state *state)
{
    for (int i = 0; i < size; i++) {
        double *restrict row = state->factors[i];
        for (int j = 0; j < size; j++) row[j] = i == j;
        for (int k = 0; k < size; k++) {
            const double g = state->following[i][k], *motion = state->at.chain.bodies[k / W].motion[k % W];
            if (g == 0.0) continue;
            for (int j = 0; j < size; j++) row[j] -= g * motion[j];
        }
    }
    return small_factorise(size, CHAIN_WRENCH, state->factors[0], state->exchanged);
}

int response_find(const contact_problem *problem, contact_state *state)
{
    follow(problem, state);
    if (problem->step) inertia_follow(problem, state->mass, state->inertial, state->following);
    return factorise(contact_size(problem), state);
}

void response_soften(const contact_problem *problem, const contact_state *state, const double *wrench, double *out)
{
    const int size = contact_size(problem);
    memcpy(out, wrench, (size_t)size * sizeof *out);
    small_substitute(size, CHAIN_WRENCH, state->factors[0], state->exchanged, out);
}

void response_move(const contact_problem *problem, const contact_state *state, const double *wrench, double *out)
{
    const int size = contact_size(problem);
    double soft[CHAIN_WRENCH];
    response_soften(problem, state, wrench, soft);
    for (int i = 0; i < size; i++) {
        const double *row = state->at.chain.bodies[i / W].motion[i % W];
        double sum = 0.0;
        for (int j = 0; j < size; j++) sum += row[j] * soft[j];
        out[i] = sum;
    }
}

void response_yields(const contact_problem *problem, const contact_state *state, int count, const int *rows, small_columns *motions)
{
    const int size = contact_size(problem);
    small_columns soft[CHAIN_WRENCH];
    memset(soft, 0, (size_t)size * sizeof *soft);
    for (int c = 0; c < count; c++) {
        const contact_arms *arms = state->at.arms + rows[c];
        const contact_acting *acting = state->at.acting + rows[c];
        for (int a = 0; a < arms->count; a++)
            for (int i = 0; i < W; i++) soft[W * arms->bodies[a] + i][c] += problem->share * acting->slope * acting->wrenches[a][i];
    }
    small_substitute_columns(size, CHAIN_WRENCH, state->factors[0], state->exchanged, soft);
    for (int i = 0; i < size; i++) small_combine(size, state->at.chain.bodies[i / W].motion[i % W], soft, motions[i]);
}

void response_press(const placed *at, int k, double force, double *wrench)
{
    const contact_arms *arms = at->arms + k;
    for (int a = 0; a < arms->count; a++)
        for (int i = 0; i < W; i++) wrench[W * arms->bodies[a] + i] += force * at->acting[k].wrenches[a][i];
}

/* The contacts that press, `rows`, and the motions C S W_k with a unit force at each; returns their number. */
static int pressing(const contact_problem *problem, const contact_state *state, int *rows,
                    double (*columns)[CHAIN_WRENCH])
{
    int count = 0;
    for (int k = 0; k < state->at.contacts.count; k++) {
        if (!(state->forces[k] > 0.0)) continue;
        response_yield(problem, state, k, columns[k]);
        rows[count++] = k;
    }
    return count;
}

/* Add the change of the wrench of contact k as the plate bends, so that its point there moves by v: f (dn, dm + v x n),
 * with dn, dm as if the whole plate moved by v, and v x n as the arm changes. */
static void bend(const contact_problem *problem, const contact_state *state, int k, const double *v, double *turned)
{
    const objects_contacts *contacts = &state->at.contacts;
    if (state->at.arms[k].count > 1) return; /* neglected for slices, beside the bending of their element */
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

/* Changes of the wrenches of every object's contacts, (count, CHAIN_WRENCH), with the changes `forces` of contact
 * forces, and with the motion of all bodies, by their drift and by the changes `change` of all wrenches. */
static void follow_each(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                        int count, const int *rows, const double *forces, const double *change, double (*by_object)[CHAIN_WRENCH])
{
    const int w = contact_size(problem);
    for (int j = 0; j < problem->touching->count; j++) {
        double motion[CHAIN_WRENCH];
        /* motion relative to object j: drift + C dw */
        for (int i = 0; i < w; i++) {
            motion[i] = only < 0 || only == j ? drift[i] : 0.0;
            for (int k = 0; k < w; k++) motion[i] += state->at.chain.bodies[i / W].motion[i % W][k] * change[k];
        }
        /* G_j xi + changes by bent plates + sum_k df_k W_k */
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
    /* wrenches at fixed forces change by G drift, or by G_only drift, and as plates bend */
    if (only >= 0) follow_one(problem, state, only, drift, turned);
    for (int i = 0; i < w && only < 0; i++) {
        turned[i] = 0.0;
        for (int j = 0; j < w; j++) turned[i] += state->following[i][j] * drift[j];
    }
    for (int k = 0; k < count && bends; k++) bend(problem, state, rows[k], bends + 3 * rows[k], turned);
    /* motion of all bodies at fixed forces: C S (G drift + bends), plus the drift if the bodies themselves drift */
    response_move(problem, state, turned, motion);
    for (int i = 0; i < w && only < 0; i++) motion[i] += drift[i];
    /* forces that keep contacts closed: (W^T C S W + c) df = -W^T motion - n . bend; motion includes the drift */
    for (int k = 0; k < count; k++) {
        forces[k] = -response_opening(&state->at, rows[k], motion);
        if (contacts->objects[rows[k]] == only) forces[k] -= response_opening(&state->at, rows[k], drift);
        if (bends) forces[k] -= objects_dot(contacts->wrenches[rows[k]], bends + 3 * rows[k]);
    }
    if (!response_forces(&state->at, count, rows, columns, forces)) return 0;
    /* change of all wrenches: dw = S (G drift + bends + W df) */
    for (int k = 0; k < count; k++) response_press(&state->at, rows[k], forces[k], turned);
    response_soften(problem, state, turned, wrench_change);
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
    /* C S without the ground, which does not move */
    for (int j = 0; j < w; j++) {
        double unit[CHAIN_WRENCH] = {0.0}, motion[CHAIN_WRENCH];
        unit[ground + j] = 1.0;
        response_move(problem, state, unit, motion);
        for (int i = 0; i < w; i++) yielding[w * i + j] = motion[ground + i];
    }
    /* A = W^T C S W + c over the pressing contacts */
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = response_opening(&state->at, rows[i], columns[rows[j]]) + response_compliance(&state->at, rows[i], rows[j]);
    return small_negative(w, yielding) == small_negative(count, a); /* of C S = 1/K as of K */
}

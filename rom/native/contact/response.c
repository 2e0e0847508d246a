/* How the bodies yield to contact forces: G, S and C S, the balance of gaps and forces, derivatives, and stability. */
#include "response.h"
#include "slices.h"
#include <math.h>
#include <stdlib.h>
#include "../linear_algebra/small.h"

#define INLINE __attribute__((always_inline)) static inline
#define PIVOTS 128
#define BLOCKS 3 /* pivots on all wrong contacts without fewer of them, before single ones follow */
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] of a gap below zero that is rounding */

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
        /* G += f_k dW_k, in the blocks of the contact's bodies a, b */
        for (int a = 0; a < arms->count; a++)
            for (int b = 0; b < arms->count; b++)
                for (int i = 0; i < W; i++)
                    for (int j = 0; j < W; j++)
                        state->following[W * arms->bodies[a] + i][W * arms->bodies[b] + j] +=
                            state->forces[k] * own[W * a + i][W * b + j];
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
    /* C: motions of all bodies by their wrenches; then G C */
    for (int i = 0; i < size; i++)
        memcpy(compliance[i], state->at.chain.bodies[i / W].motion[i % W], (size_t)size * sizeof **compliance);
    product(size, state->following, compliance, made);
    /* S: solve (1 - G C) S = 1 */
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

/* C S W_k: the motion of all bodies with a unit force at contact k. */
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

/* W_k . xi: how much the gap of contact k grows with a motion xi of all bodies. */
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

/* The deflection at the fraction a of an element, clamped at both ends, by a unit force at its fraction b [m/N]: that
 * of a cantilever, minus the part of the reactions at its other end; phi as in slice_forces.c. */
static double deflection(double length, double phi, double stiffness, double a, double b)
{
    const double near = fmin(a, b), far = fmax(a, b), held = 12.0 / (1.0 + phi);
    /* cantilever of unit length and E I: w = near^2 (3 far - near) / 6 + phi near / 12 */
    const double free = near * near * (3.0 * far - near) / 6.0 + phi * near / 12.0;
    /* deflection and rotation of the free end by a unit force at a, and at b */
    const double way_a = a * a * (3.0 - a) / 6.0 + phi * a / 12.0, way_b = b * b * (3.0 - b) / 6.0 + phi * b / 12.0;
    const double turn_a = 0.5 * a * a, turn_b = 0.5 * b * b;
    /* reactions that hold the free end: (way, turn)_a^T K (way, turn)_b, K the stiffness of that end */
    const double back = held * (way_a * way_b - 0.5 * (way_a * turn_b + turn_a * way_b) + (1.0 / 3.0 + phi / 12.0) * turn_a * turn_b);
    return length * length * length / stiffness * (free - back);
}

/* The deflection at contact k along its normal by a unit force at another one along that one's normal; 0 on different
 * elements. */
static double element_compliance(const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const rubber_slice *own = placed_slice_of(at, k), *its = placed_slice_of(at, other);
    if (!own || !its || own->segment != its->segment || own->element != its->element) return 0.0;
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    const double a = own->share + contacts->points[k][0] / own->length, b = its->share + contacts->points[other][0] / its->length;
    return (n[1] * m[1] + n[2] * m[2]) * deflection(own->length, own->slender, own->stiffness, a, b);
}

/* Between two slices: components of both normals n, m into the same face take that face's compliance, n_i m_i c(away);
 * those into opposite faces take the compliance of the opposite face, which moves the other way. */
double response_compliance(const contact_problem *problem, const placed *at, int k, int other)
{
    const objects_contacts *contacts = &at->contacts;
    const int segment = contacts->segments[k], away = abs(contacts->plates[k] - contacts->plates[other]);
    const double *n = contacts->wrenches[k], *m = contacts->wrenches[other];
    double sum = 0.0;
    if (k == other) sum = contacts->compliance[k] / contacts->shares[k];
    if (segment < 0 || segment != contacts->segments[other] || contacts->compliance[k] == OBJECTS_COMPLIANCE) return sum;
    const fingerfem_segment *own = problem->touching->chain->segments[segment];
    /* points of one face */
    const int name = contacts->names[k], same = name == contacts->names[other] && name >= SLICE_FACES && name < SLICE_LINES;
    if (same) sum -= own->point_compliance[away];
    for (int i = 1; i < 3 && k != other; i++) sum += n[i] * m[i] > 0.0 ? n[i] * m[i] * own->row_compliance[away] : -n[i] * m[i] * own->opposite_compliance[away];
    return sum + element_compliance(at, k, other);
}

double response_indentation(const contact_problem *problem, const placed *at, const double *forces, int k)
{
    double sum = 0.0;
    for (int j = 0; j < at->contacts.count; j++)
        if (forces[j] > 0.0) sum += response_compliance(problem, at, k, j) * forces[j];
    return sum;
}

void response_indent(const contact_problem *problem, contact_state *state)
{
    objects_contacts *contacts = &state->at.contacts;
    for (int k = 0; k < contacts->count; k++) {
        /* depth of the closest point, without what other forces lower it by */
        const double own = contacts->compliance[k] / contacts->shares[k] * state->forces[k];
        const double others = response_indentation(problem, &state->at, state->forces, k) - own;
        if (contacts->segments[k] >= 0)
            indentation_tangent(contacts->profiles + k, -contacts->gaps[k] - contacts->domes[k] - others, contacts->shares + k, contacts->lifts + k);
    }
}

/* Forces, (count), at some contacts, by which their gaps open as much as `wanted`, in place: solve
 * (W^T C S W + c) f = wanted, c the local compliances. Returns 0 if that is singular. */
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
    /* still = C S w: minus the motion of all bodies without contact forces */
    response_product(w, state->yielding, state->wrench, still);
    for (int k = 0; k < all; k++) active[k] = forces[k] > 0.0;
    for (int pivot = 0; pivot < PIVOTS; pivot++) {
        int rows[FINGERFEM_MOST_CONTACTS], wrong[FINGERFEM_MOST_CONTACTS], count = 0, wrongs = 0;
        double found[FINGERFEM_MOST_CONTACTS];
        /* active contacts: columns C S W_k, and wanted openings W_k . C S w - g_k, the dome in g_k included */
        for (int k = 0; k < all; k++) {
            if (!active[k]) continue;
            if (!known[k]) yield(problem, state, k, columns[k]);
            known[k] = 1;
            found[count] = opening(&state->at, k, still) - objects_gap(contacts, k);
            rows[count++] = k;
        }
        /* forces of the active contacts, and motion sum_k f_k C S W_k - C S w of all bodies */
        if (!forces_for(problem, &state->at, count, rows, columns, found)) return 0;
        memset(forces, 0, (size_t)all * sizeof *forces);
        for (int i = 0; i < w; i++) motion[i] = -still[i];
        for (int k = 0; k < count; k++) {
            forces[rows[k]] = found[k];
            for (int i = 0; i < w; i++) motion[i] += found[k] * columns[rows[k]][i];
        }
        /* wrong contacts: active ones that pull, others whose gap g_k + W_k . xi + sum_j c_kj f_j is negative */
        for (int k = 0; k < all; k++)
            if (active[k] ? forces[k] < -PULL
                          : objects_gap(contacts, k) + opening(&state->at, k, motion) + response_indentation(problem, &state->at, forces, k) < -INSIDE)
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

/* The contacts that press, `rows`, and the motions C S W_k with a unit force at each; returns their number. */
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
    else response_product(w, state->following, drift, turned);
    for (int k = 0; k < count && bends; k++) bend(problem, state, rows[k], bends + 3 * rows[k], turned);
    /* motion of all bodies at fixed forces: C S (G drift + bends), plus the drift if the bodies themselves drift */
    response_product(w, state->yielding, turned, motion);
    for (int i = 0; i < w && only < 0; i++) motion[i] += drift[i];
    /* forces that keep contacts closed: (W^T C S W + c) df = -W^T motion - n . bend; motion includes the drift */
    for (int k = 0; k < count; k++) {
        forces[k] = -opening(&state->at, rows[k], motion);
        if (contacts->objects[rows[k]] == only) forces[k] -= opening(&state->at, rows[k], drift);
        if (bends) forces[k] -= objects_dot(contacts->wrenches[rows[k]], bends + 3 * rows[k]);
    }
    if (!forces_for(problem, &state->at, count, rows, columns, forces)) return 0;
    /* change of all wrenches: dw = S (G drift + bends + W df) */
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
    /* C S without the ground, which does not move */
    for (int i = 0; i < w; i++) memcpy(yielding + w * i, state->yielding[ground + i] + ground, (size_t)w * sizeof *yielding);
    /* A = W^T C S W + c over the pressing contacts */
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[count * i + j] = opening(&state->at, rows[i], columns[rows[j]]) + response_compliance(problem, &state->at, rows[i], rows[j]);
    return small_negative(w, yielding) == small_negative(count, a); /* of C S = 1/K as of K */
}

/* What an object and a plate do to each other: complementarity of gaps and forces, linearised about the last pose.
 *
 * The plate moves by xi = C dw with the wrench w, C its compliance. Contact forces f >= 0 make the wrench W f, and as the
 * plate moves this changes by G xi besides, for the normals turn in its frame. So, from w,
 *
 *     dw = S (W f - w),    S = (1 - G C)^-1,    gaps + W^T C dw >= 0,  with f or the gap zero at every contact.
 *
 * The next pose is where this leads; near the end it is Newton's method.
 */
#include <math.h>
#include <stdlib.h>
#include "contact.h"
#include "small.h"

#define ITERATIONS 30
#define STEPS 4      /* on that way, at first */
#define HALVINGS 10  /* of such a step until there is no answer */
#define EVALUATIONS 500 /* most of the map for one answer */
#define CLOSE 1e-7   /* of the box: a last step of the wrench, a small part of which is left [-] */
#define LONGEST 0.5  /* of the box: a step of the wrench [-] */

/* W f, and G: how that changes as the plate moves. */
static void pressed(const fingerfem_object *object, const objects_contacts *contacts, const double *forces,
                    double *wrench, matrix change)
{
    memset(wrench, 0, W * sizeof *wrench);
    memset(change, 0, sizeof(matrix));
    for (int k = 0; k < contacts->count; k++) {
        if (forces[k] == 0.0) continue;
        matrix own;
        objects_change(object, contacts, k, own);
        for (int i = 0; i < W; i++) {
            wrench[i] += forces[k] * contacts->wrenches[k][i];
            for (int j = 0; j < W; j++) change[i][j] += forces[k] * own[i][j];
        }
    }
}

static void product(const matrix a, const matrix b, matrix out)
{
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            out[i][j] = 0.0;
            for (int k = 0; k < W; k++) out[i][j] += a[i][k] * b[k][j];
        }
}

/* S = (1 - G C)^-1; returns 0 if there is none. */
static int softened(const matrix following, const matrix compliance, matrix out)
{
    matrix system;
    product(following, compliance, system);
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++) {
            out[i][j] = i == j;
            system[i][j] = (i == j) - system[i][j];
        }
    return small_solve(W, &system[0][0], W, &out[0][0]);
}

static double dot(const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < W; i++) sum += a[i] * b[i];
    return sum;
}

/* A row times a matrix. */
static void row_product(const double *row, const matrix m, double *out)
{
    for (int j = 0; j < W; j++) {
        out[j] = 0.0;
        for (int i = 0; i < W; i++) out[j] += row[i] * m[i][j];
    }
}

/* Forces that the contacts had before, found again by their names. */
static void carry(const objects_contacts *before, const double *forces, const objects_contacts *now, double *found)
{
    for (int k = 0; k < now->count; k++) {
        found[k] = 0.0;
        for (int j = 0; j < before->count; j++)
            if (before->names[j] == now->names[k]) found[k] = forces[j];
    }
}

/* One step; returns the change of the wrench over the box, negative if there is none. */
static double step(const contracted_map *map, contact_state *state)
{
    const fingerfem_segment *segment = map->touching->segment;
    const double *upper = segment->upper + segment->tensions;
    objects_contacts *contacts = &state->at.contacts;
    const int count = contacts->count;
    double made[W], target[W], change[W], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    double b[FINGERFEM_MOST_CONTACTS];
    pressed(map->touching->object, contacts, state->forces, made, state->following);
    if (!softened(state->following, state->at.compliance, state->soft)) return -1.0;
    product(state->at.compliance, state->soft, state->yielding);
    for (int i = 0; i < count; i++) {
        double row[W];
        row_product(contacts->wrenches[i], state->yielding, row);
        b[i] = contacts->gaps[i] - dot(row, state->wrench);
        for (int j = 0; j < count; j++) a[count * i + j] = dot(row, contacts->wrenches[j]);
    }
    double forces[FINGERFEM_MOST_CONTACTS];
    memcpy(forces, state->forces, sizeof forces);
    if (!small_complementarity(count, a, b, SOFT, forces)) return -1.0;
    memset(target, 0, sizeof target);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++) target[i] += forces[k] * contacts->wrenches[k][i];
    double size = 0.0;
    for (int i = 0; i < W; i++) {
        change[i] = 0.0;
        for (int j = 0; j < W; j++) change[i] += state->soft[i][j] * (target[j] - state->wrench[j]);
        const double own = fabs(change[i]) / upper[i];
        if (own > size || isnan(own)) size = own;
    }
    if (isnan(size)) return -1.0;
    const double share = size > LONGEST ? LONGEST / size : 1.0;
    for (int i = 0; i < W; i++) state->wrench[i] += share * change[i];
    for (int k = 0; k < count; k++) state->forces[k] += share * (forces[k] - state->forces[k]);
    for (int i = 0; i < 3; i++) /* where the next pose would be found */
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < W; k++)
                state->at.centre[i] += state->at.rotation[3 * i + j] * state->at.compliance[j][k] * share * change[k];
    return size;
}

/* Solve from a state's wrench and forces; returns the number of evaluations, negative if it did not end. */
static int solve_from(const contracted_map *map, double d, contact_state *state)
{
    objects_contacts before = state->at.contacts;
    for (int k = 1; k <= ITERATIONS; k++) {
        double forces[FINGERFEM_MOST_CONTACTS];
        memcpy(forces, state->forces, sizeof forces);
        placed_under(map, state->wrench, d, &state->at);
        carry(&before, forces, &state->at.contacts, state->forces);
        const double size = step(map, state);
        if (size < 0.0) return -k;
        if (size < CLOSE) return k;
        before = state->at.contacts;
    }
    return -ITERATIONS;
}

/* Bring the object from where it touches the free plate to d, so that of several answers the one is found that its
 * approach leads to; returns as `solve_from`. */
static int approach(const contracted_map *map, double touch, double d, contact_state *state)
{
    int evaluations = 0;
    double at = touch, size = (d - touch) / STEPS;
    const double least = fabs(size) / (1 << HALVINGS);
    memset(state->wrench, 0, sizeof state->wrench);
    state->at.contacts.count = 0;
    while (at > d) {
        contact_state last = *state;
        const double next = at + size > d + least ? at + size : d;
        const int used = solve_from(map, next, state);
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
int contact_solve(const contracted_map *map, double touch, double d, contact_state *state)
{
    const double shallow = objects_shallow(map->touching->object, map->touching->segment->half_lengths);
    int known = 0, evaluations = 0;
    for (int i = 0; i < W; i++) known |= state->wrench[i] != 0.0;
    if (known || touch - d < shallow) {
        state->at.contacts.count = 0;
        evaluations = solve_from(map, d, state);
        if (evaluations > 0) return evaluations;
    }
    const int more = approach(map, touch, d, state);
    return more > 0 ? abs(evaluations) + more : evaluations - abs(more);
}

/* How wrench and plate move with a tension, or with d: drift is the motion at a fixed wrench, of the plate or relative to
 * the object. Contacts that press stay closed. */
int contact_follow(const contact_state *state, const double *drift, double *wrench_change)
{
    const objects_contacts *contacts = &state->at.contacts;
    int rows[FINGERFEM_MOST_CONTACTS], count = 0;
    double turned[W], a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], forces[FINGERFEM_MOST_CONTACTS];
    for (int k = 0; k < contacts->count; k++)
        if (state->forces[k] > 0.0) rows[count++] = k;
    for (int i = 0; i < W; i++) {
        turned[i] = 0.0;
        for (int j = 0; j < W; j++) turned[i] += state->following[i][j] * drift[j];
    }
    for (int i = 0; i < count; i++) {
        const double *own = contacts->wrenches[rows[i]];
        double row[W];
        row_product(own, state->yielding, row);
        forces[i] = -dot(row, turned) - dot(own, drift);
        for (int j = 0; j < count; j++)
            a[count * i + j] = dot(row, contacts->wrenches[rows[j]]) + (i == j ? SOFT : 0.0);
    }
    if (!small_solve(count, a, 1, forces)) return 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < W; i++) turned[i] += forces[k] * contacts->wrenches[rows[k]][i];
    for (int i = 0; i < W; i++) {
        wrench_change[i] = 0.0;
        for (int j = 0; j < W; j++) wrench_change[i] += state->soft[i][j] * turned[j];
    }
    return 1;
}

int contact_stable(const contact_state *state)
{
    const objects_contacts *contacts = &state->at.contacts;
    matrix compliance, stiffness = {{0.0}};
    int rows[FINGERFEM_MOST_CONTACTS], count = 0;
    double a[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS];
    memcpy(compliance, state->yielding, sizeof compliance);
    for (int i = 0; i < W; i++) stiffness[i][i] = 1.0;
    if (!small_solve(W, &compliance[0][0], W, &stiffness[0][0])) return 0;
    for (int k = 0; k < contacts->count; k++)
        if (state->forces[k] > 0.0) rows[count++] = k;
    for (int i = 0; i < count; i++) {
        double row[W];
        row_product(contacts->wrenches[rows[i]], state->yielding, row);
        for (int j = 0; j < count; j++)
            a[count * i + j] = dot(row, contacts->wrenches[rows[j]]) + (i == j ? SOFT : 0.0);
    }
    return small_negative(W, &stiffness[0][0]) == small_negative(count, a);
}

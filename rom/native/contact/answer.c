/* An answer at a solved state: tip displacement, contact forces, touch distances, and their derivatives. */
#include "answer.h"
#include <math.h>
#include "response.h"

/* The wrenches of object j's contacts on all bodies; of a single object these are the state's wrenches. */
static void wrenches_with(const contact_problem *problem, const contact_state *state, int j, double *wrench)
{
    if (problem->touching->count == 1) memcpy(wrench, state->wrench, (size_t)contact_size(problem) * sizeof *wrench);
    else response_wrenches(problem, state, j, wrench);
}

/* R^T v: a vector of space in a body's frame. */
static void seen_by(const chain_body *plate, const double *v, double *found)
{
    const double *r = plate->rotation;
    for (int i = 0; i < 3; i++) found[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
}

void answer_report(const contact_problem *problem, const contact_state *state, double *out)
{
    const fingerfem_chain *chain = problem->touching->chain;
    const chain_body *bodies = state->at.chain.bodies, *tip = bodies + problem->map->count - 1;
    /* tip displacement: centre of the last plate, minus that at rest [m] */
    for (int i = 0; i < 3; i++) out[i] = tip->centre[i] - chain->rest[i];
    /* N_j = -sum_q e . f_q over all bodies q: force of object j against its direction e [N] */
    for (int j = 0; j < problem->touching->count; j++) {
        double wrench[CHAIN_WRENCH], e[3];
        wrenches_with(problem, state, j, wrench);
        out[3 + j] = 0.0;
        for (int q = 0; q < problem->map->count; q++) {
            placed_leaving(problem, j, bodies + q, e);
            out[3 + j] -= objects_dot(e, wrench + W * q);
        }
    }
}

int answer_change(const contact_problem *problem, const contact_state *state, int only, const double *drift, const double *bends,
                  reported_change *all, double *found)
{
    const chain_body *bodies = state->at.chain.bodies;
    double *change = all->wrench, own[FINGERFEM_MOST_OBJECTS][CHAIN_WRENCH];
    if (!response_follow(problem, state, only, drift, bends, change, own)) return 0;
    /* motion of every body: C dw, plus the drift if that is a motion of the bodies */
    for (int q = 0; q < problem->map->count; q++) {
        double *motion = all->motion + W * q;
        for (int i = 0; i < W; i++) {
            motion[i] = bends ? drift[W * q + i] : 0.0;
            for (int j = 0; j < contact_size(problem); j++) motion[i] += bodies[q].motion[i][j] * change[j];
        }
    }
    /* motion of the tip in space: R (R^T dc) */
    const double *r = bodies[problem->map->count - 1].rotation, *tip = all->motion + W * (problem->map->count - 1);
    for (int i = 0; i < 3; i++) found[i] = objects_dot(r + 3 * i, tip);
    /* dN_j = -sum_q (e . df_q + (e x theta_q) . f_q): the second term as e turns in the frame of body q */
    for (int j = 0; j < problem->touching->count; j++) {
        double wrench[CHAIN_WRENCH], e[3], turned[3];
        wrenches_with(problem, state, j, wrench);
        found[3 + j] = 0.0;
        for (int q = 0; q < problem->map->count; q++) {
            placed_leaving(problem, j, bodies + q, e);
            objects_cross(e, all->motion + W * q + 3, turned);
            found[3 + j] -= objects_dot(e, own[j] + W * q) + objects_dot(turned, wrench + W * q);
        }
    }
    return 1;
}

/* Displacement, (3), of a point fixed to an object at d, as this moves by v and turns by t about its centre, (v, t) =
 * `motion`: v + t x (place - centre). */
static void carried(const fingerfem_object *object, double d, const double *motion, const double *place, double *found)
{
    double arm[3];
    for (int i = 0; i < 3; i++) arm[i] = place[i] - object->centre[i] - d * object->direction[i];
    objects_cross(motion + 3, arm, found);
    for (int i = 0; i < 3; i++) found[i] += motion[i];
}

/* As `answer_change`, for a motion (v, t) of object j, which is at d: every body drifts by the opposite motion. */
static int report_object(const contact_problem *problem, const contact_state *state, int j, double d, const double *motion,
                         reported_change *all, double *found)
{
    double drift[CHAIN_WRENCH] = {0.0}, v[3];
    /* drift of body q relative to the object, in the body's frame: -R^T (v + t x arm), -R^T t */
    for (int q = 0; q < problem->map->count; q++) {
        const chain_body *plate = state->at.chain.bodies + q;
        carried(contact_object(problem, j), d, motion, plate->centre, v);
        seen_by(plate, v, drift + W * q);
        seen_by(plate, motion + 3, drift + W * q + 3);
        for (int i = 0; i < W; i++) drift[W * q + i] = -drift[W * q + i];
    }
    return answer_change(problem, state, problem->touching->count == 1 ? -1 : j, drift, NULL, all, found);
}

int answer_derivatives(const contact_problem *problem, const contact_state *state, const double *d, const int *d_moves,
                       double *jacobian, double *by_object, reported_change *changes)
{
    const int t = problem->touching->chain->tensions, m = problem->touching->count, p = t + m, rows = 3 + m;
    double drift[CHAIN_WRENCH], found[3 + FINGERFEM_MOST_OBJECTS], bends[FINGERFEM_MOST_CONTACTS][3 * TENSIONS_MOST];
    double along[3 * FINGERFEM_MOST_CONTACTS] = {0.0};
    reported_change own;
    /* motion of the loaded contacts' points with the tensions, besides that of their bodies (tensions, 3) */
    for (int c = 0; c < state->at.contacts.count; c++)
        if (state->forces[c] > 0.0) placed_bend(problem, &state->at, c, bends[c]);
    /* columns of the tensions: by F_k all bodies drift, and contact points move by their bend */
    for (int k = 0; k < t; k++) {
        for (int i = 0; i < contact_size(problem); i++)
            drift[i] = state->at.chain.bodies[i / W].motion[i % W][contact_size(problem) + k];
        for (int c = 0; c < state->at.contacts.count; c++)
            if (state->forces[c] > 0.0) memcpy(along + 3 * c, bends[c] + 3 * k, 3 * sizeof *along);
        if (!answer_change(problem, state, -1, drift, along, changes ? changes + k : &own, found)) return 0;
        for (int i = 0; i < rows; i++) jacobian[p * i + k] = found[i];
    }
    /* columns of d: object j moves along its direction */
    for (int j = 0; j < m; j++) {
        double away[W] = {0.0};
        memcpy(away, contact_object(problem, j)->direction, 3 * sizeof *away);
        if (d_moves[j]) {
            if (!report_object(problem, state, j, d[j], away, changes ? changes + t + j : &own, found)) return 0;
            for (int i = 0; i < rows; i++) jacobian[p * i + t + j] = found[i];
        }
        /* columns of the motion of object j: three displacements, three turns about its centre */
        for (int k = 0; k < W && by_object; k++) {
            double unit[W] = {0.0};
            unit[k] = 1.0;
            if (!contact_is_there(problem, j)) continue;
            if (!report_object(problem, state, j, d[j], unit, &own, found)) return 0;
            for (int i = 0; i < rows; i++) by_object[W * m * i + W * j + k] = found[i];
        }
    }
    return 1;
}

void answer_touched(const contact_problem *problem, const placed *at, touched_point *first)
{
    const objects_contacts *contacts = &at->contacts;
    const int nearest = placed_nearest(contacts);
    /* point p + bent in the plate's frame, and the wrench (n, p x n) of a unit force */
    first->plate = at->chain.bodies + contacts->plates[nearest];
    for (int i = 0; i < 3; i++) first->p[i] = contacts->points[nearest][i] + contacts->bent[nearest][i];
    memcpy(first->wrench, contacts->wrenches[nearest], sizeof first->wrench);
    first->off = 0.0;
    placed_bend(problem, at, nearest, first->bends);
}

void answer_touch(const contact_problem *problem, int j, const touched_point *first, double touch, double *out,
                  double *jacobian, double *by_object)
{
    const int t = problem->touching->chain->tensions, m = problem->touching->count, row = 3 + m + j;
    const chain_body *plate = first->plate;
    const double *normal = first->wrench;
    double e[3];
    out[row] = touch;
    if (!isfinite(touch)) return;
    /* n . e: the gap grows by -n . e per d */
    placed_leaving(problem, j, plate, e);
    const double down = objects_dot(normal, e);
    /* dd/dF_k = (n . b_k + W . xi_k) / (n . e), as the surface bends by b_k and the plate moves by xi_k */
    for (int k = 0; k < t; k++) {
        double opened = objects_dot(normal, first->bends + 3 * k);
        for (int i = 0; i < W; i++) opened += normal[i] * plate->motion[i][contact_size(problem) + k];
        jacobian[(t + m) * row + k] = opened / down;
    }
    /* dd = -n . v / (n . e), as a unit motion of the object displaces its touching point by v */
    for (int k = 0; k < W && by_object; k++) {
        double unit[W] = {0.0}, place[3], v[3], seen[3];
        unit[k] = 1.0;
        for (int i = 0; i < 3; i++) place[i] = plate->centre[i] + objects_dot(plate->rotation + 3 * i, first->p);
        carried(contact_object(problem, j), touch, unit, place, v);
        seen_by(plate, v, seen);
        by_object[W * m * row + W * j + k] = -objects_dot(normal, seen) / down;
    }
}

/* A chain of segments, as a nonlinear transfer-matrix method. From tip to base: a body transmits its own wrench and
 * that of the body beyond it, moved to its centre, and nothing else. Under this wrench its part of the rod gives its
 * pose seen from the body before. A long tendon slides through a plate, and enters the rods of the segments that it
 * passes as if it ended at their plates. From base to tip: relative poses and motions are composed to those in
 * space. */
#include "chain_weight.h"

#define INLINE __attribute__((always_inline)) static inline

/* Inlined, so that loops over many inputs are vectorised. */
INLINE void cross(const double *a, const double *b, double *out)
{
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

INLINE void turned(const double *rotation, const double *v, double *out)
{
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
}

INLINE void turned_back(const double *rotation, const double *v, double *out)
{
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) out[i] = rotation[i] * v[0] + rotation[3 + i] * v[1] + rotation[6 + i] * v[2];
}

/* The inverse of the pose p, Q of the end of its part seen from the body. If a part ends at the clamp of a segment beyond a plate, that plate's centre lies half a
 * plate before. */
void chain_locate(const chain_rods *map, int b, chain_body *body)
{
    const chain_place *own = map->bodies + b;
    const fingerfem_segment *const *segment = map->chain->segments + own->segment;
    /* inverse pose: a = -Q^T p, A = Q^T */
    for (int i = 0; i < 3; i++) {
        const double *p = body->end.place, *Q = body->end.rotation + i; /* of that end, seen from the body */
        body->arm[i] = -(Q[0] * p[0] + Q[3] * p[1] + Q[6] * p[2]);
        for (int j = 0; j < 3; j++) body->relative[3 * i + j] = Q[3 * j];
    }
    /* from the clamp back to the centre of the plate before [m] */
    if (own->segment && own->part.last == segment[0]->elements) body->arm[0] += segment[-1]->half_lengths[0];
}

/* The first body that moves: the ground does not. */
static int first_moving(const chain_rods *map) { return map->bodies[0].segment == CHAIN_GROUND; }

/* Derivative of the wrench f' = A f, m' = A m + a x f' that a body passes on to the one before, with its arm a and
 * rotation A:
 *
 *     df' = A df + b x f',    dm' = A dm + b x A m + da x f' + a x df',
 *
 * where da = A dc and b = A dtheta are by its relative motion, (6). Change, (6), is df, dm on entry; force, moment
 * are A f, A m. */
INLINE void pass_change(const chain_body *body, const double *force, const double *moment, const double *motion, double *change)
{
    double moved[3], spun[3], by_force[3], by_moment[3], one[3], two[3], three[3];
    /* relative motion and change of the wrench, in the frame of the body before */
    turned(body->relative, motion, moved);
    turned(body->relative, motion + 3, spun);
    turned(body->relative, change, by_force);
    turned(body->relative, change + 3, by_moment);
    /* df' = A df + b x f' */
    cross(spun, force, one);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) by_force[i] += one[i];
    /* dm' = A dm + b x A m + da x f' + a x df' */
    cross(spun, moment, one);
    cross(moved, force, two);
    cross(body->arm, by_force, three);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        change[i] = by_force[i];
        change[3 + i] = by_moment[i] + one[i] + two[i] + three[i];
    }
}

void chain_pass_change(const chain_body *body, const double *motion, double *change)
{
    double force[3], moment[3];
    /* the transmitted wrench in the frame of the body before: A f, A m */
    turned(body->relative, body->transmitted, force);
    turned(body->relative, body->transmitted + 3, moment);
    pass_change(body, force, moment, motion, change);
}

/* From the wrench that a body transmits, (6), to that which it passes on to the one before, and likewise its
 * derivatives by inputs first ... last - 1, (6, inputs); in place. */
static void pass_on(const chain_body *body, int first, int last, double *transmitted, double (*by)[CHAIN_INPUTS])
{
    double force[3], moment[3], found[W];
    /* A f and A m */
    turned(body->relative, transmitted, force);
    turned(body->relative, transmitted + 3, moment);
    /* derivatives, input by input */
    for (int c = first; c < last; c++) {
        double motion[W], column[W];
#pragma GCC unroll 6
        for (int i = 0; i < W; i++) {
            motion[i] = body->motion[i][c];
            column[i] = by[i][c];
        }
        pass_change(body, force, moment, motion, column);
#pragma GCC unroll 6
        for (int i = 0; i < W; i++) by[i][c] = column[i];
    }
    /* f' = A f, m' = A m + a x f' */
    cross(body->arm, force, found);
    for (int i = 0; i < 3; i++) {
        transmitted[i] = force[i];
        transmitted[3 + i] = moment[i] + found[i];
    }
}

/* A body's motion relative to the end of its part by inputs first ... last - 1, at fixed tensions: Y_w dw, with the
 * compliance Y_w of the part and the derivatives dw of the transmitted wrench, `by`, (6, inputs). */
static void relative_motion(int first, int last, double (*by)[CHAIN_INPUTS], chain_body *body)
{
    for (int i = 0; i < W; i++) {
        for (int c = first; c < last; c++) body->motion[i][c] = 0.0;
        for (int j = 0; j < W; j++)
            for (int c = first; c < last; c++) body->motion[i][c] += body->end.by_wrench[i][j] * by[j][c];
    }
}

/* Add a body's relative motion by the tensions of its segment, at fixed wrench. */
static void add_by_tensions(const chain_rods *map, int b, chain_body *body)
{
    const fingerfem_chain *chain = map->chain;
    const int k = map->bodies[b].segment;
    const int32_t *own = chain->own + chain->tensions * k;
    /* columns: those of the tensions lie behind those of the wrenches */
    for (int i = 0; i < W; i++)
        for (int j = 0; j < chain->segments[k]->tensions; j++)
            body->motion[i][chain_size(map) + own[j]] += body->by_tensions[i][j];
}

void chain_compose(const chain_rods *map, int first, int last, chain_state *state)
{
    static const double origin[3] = {0.0}, upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const int begin = first_moving(map);
    for (int b = 0; b < map->count; b++) {
        chain_body *body = state->bodies + b, *before = body - 1;
        /* the ground: at the origin, without motion */
        if (b < begin) {
            memcpy(body->centre, origin, sizeof origin);
            memcpy(body->rotation, upright, sizeof upright);
            for (int i = 0; i < W; i++) memset(body->motion[i] + first, 0, (size_t)(last - first) * sizeof(double));
        }
        /* the first moving body: its relative pose is its pose in space */
        if (b == begin) {
            memcpy(body->centre, body->arm, sizeof body->centre);
            memcpy(body->rotation, body->relative, sizeof body->rotation);
        }
        if (b <= begin) continue;
        /* pose: c_b = c + R a, R_b = R A, with c, R of the body before */
        double moved[3], carried[3], spun[3];
        turned(before->rotation, body->arm, moved);
        for (int i = 0; i < 3; i++) {
            body->centre[i] = before->centre[i] + moved[i];
            turned_back(body->relative, before->rotation + 3 * i, body->rotation + 3 * i); /* row of R times relative */
        }
        /* motion: dc_b += A^T (dc + t x a), dtheta_b += A^T t, with dc, t of the body before */
        for (int c = first; c < last; c++) {
            double t[3];
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) t[i] = before->motion[3 + i][c];
            cross(t, body->arm, moved);
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) moved[i] += before->motion[i][c];
            turned_back(body->relative, moved, carried);
            turned_back(body->relative, t, spun);
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                body->motion[i][c] += carried[i];
                body->motion[3 + i][c] += spun[i];
            }
        }
    }
}

void chain_without_weight(const chain_rods *map, const double *wrench, int motions, chain_state *state)
{
    const int w = motions ? chain_size(map) : 0, begin = first_moving(map);
    double transmitted[W] = {0.0}, by[W][CHAIN_INPUTS];
    /* derivatives of the transmitted wrench by all wrenches; unused for a single body */
    for (int i = 0; i < W && w && map->count > 1; i++) memset(by[i], 0, (size_t)w * sizeof(double));
    /* from tip to base */
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        /* add the wrench on this body */
        for (int i = 0; i < W; i++) {
            transmitted[i] += wrench[W * b + i];
            if (w && map->count > 1) by[i][W * b + i] += 1.0;
            body->transmitted[i] = transmitted[i];
        }
        /* its part of the rod under that wrench: relative pose and compliance Y_w */
        rod_under(map->rods + map->bodies[b].segment, map->bodies[b].part, transmitted, motions, &body->end);
        chain_locate(map, b, body);
        /* relative motion, Y_w dw, by the wrenches on this body and those beyond; of a single body Y_w itself */
        for (int i = 0; i < W && w; i++) memset(body->motion[i], 0, (size_t)(W * b) * sizeof(double));
        if (map->count > 1) relative_motion(W * b, w, by, body);
        else for (int i = 0; i < W && w; i++) memcpy(body->motion[i], body->end.by_wrench[i], sizeof body->end.by_wrench[i]);
        if (b > begin) pass_on(body, W * b, w, transmitted, by);
    }
    /* from base to tip: poses in space, motions by wrenches */
    chain_compose(map, 0, w, state);
}

int chain_again(const chain_rods *map, const double *wrench, chain_state *state)
{
    if (map->weight) return chain_weight_under(map, wrench, state);
    chain_without_weight(map, wrench, 0, state);
    return 1;
}

int chain_under(const chain_rods *map, const double *wrench, chain_state *state)
{
    if (map->weight) return chain_weight_under(map, wrench, state);
    chain_without_weight(map, wrench, 1, state);
    return 1;
}

int chain_free(const chain_rods *map, chain_state *state)
{
    if (map->weight) return chain_weight_free(map, state);
    const int w = chain_size(map), inputs = w + map->chain->tensions;
    double by[W][CHAIN_INPUTS] = {{0.0}};
    /* relative poses and motions by tensions, body by body: nothing is transmitted */
    for (int b = 0; b < map->count; b++) {
        chain_body *body = state->bodies + b;
        rod_free(map->rods + map->bodies[b].segment, &body->end, body->by_tensions);
        memset(body->transmitted, 0, sizeof body->transmitted); /* no wrench, whatever the tensions */
        chain_locate(map, b, body);
        relative_motion(w, inputs, by, body);
        add_by_tensions(map, b, body);
    }
    /* poses in space, motions by tensions */
    chain_compose(map, w, inputs, state);
    return 1;
}

void chain_by_variants(const chain_rods *map, int pressed, chain_state *state)
{
    if (map->weight) {
        chain_weight_by_inputs(map, 1, state);
        return;
    }
    const int w = chain_size(map), count = map->chain->segments[0]->deviating, begin = first_moving(map);
    double by[W][CHAIN_INPUTS] = {{0.0}};
    /* from tip to base: motions by variants, and the changes that these make in transmitted wrenches */
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        double transmitted[W];
        rod_by_variants(map->rods + map->bodies[b].segment, map->bodies[b].part, pressed, body->by_tensions);
        memcpy(transmitted, body->transmitted, sizeof transmitted);
        relative_motion(w, w + count, by, body);
        /* at fixed wrench: the variants' columns stand in place of the tensions' */
        for (int i = 0; i < W; i++)
            for (int v = 0; v < count; v++) body->motion[i][w + v] += body->by_tensions[i][v];
        if (b > begin) pass_on(body, w, w + count, transmitted, by);
    }
    chain_compose(map, w, w + count, state);
}

void chain_by_tensions(const chain_rods *map, chain_state *state)
{
    if (map->weight) {
        chain_weight_by_inputs(map, 0, state);
        return;
    }
    const int w = chain_size(map), inputs = w + map->chain->tensions, begin = first_moving(map);
    double by[W][CHAIN_INPUTS] = {{0.0}};
    /* from tip to base: motions by tensions, at fixed wrench and through the transmitted wrench */
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        double transmitted[W];
        rod_by_tensions(map->rods + map->bodies[b].segment, map->bodies[b].part, body->by_tensions);
        memcpy(transmitted, body->transmitted, sizeof transmitted);
        relative_motion(w, inputs, by, body);
        add_by_tensions(map, b, body);
        if (b > begin) pass_on(body, w, inputs, transmitted, by);
    }
    chain_compose(map, w, inputs, state);
}

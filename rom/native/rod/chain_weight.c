/* A chain that weighs. Its march needs the acceleration g that the tip sees, which depends on how the tip is turned:
 *
 *     g = R^T G,    with the tip's rotation R in space, and the acceleration G that the clamp sees.
 *
 * Newton's method finds it: as g changes, the tip turns by M dg in its own frame, and R^T G by [R^T G]x M dg. So
 *
 *     (1 - [R^T G]x M) dg = R^T G - g.
 *
 * Where g is found, inputs that turn the tip by dtheta at fixed g change it by
 *
 *     dg = T dtheta,    T = (1 - [g]x M)^-1 [g]x,
 *
 * and all motions by what follows from that. One eigenvalue of 1 - [g]x M is 1. Where G grows from zero, the finger's stiffness
 * is singular where another one passes zero. So it rests there while these two have a positive sum and product. */
#include "chain_weight.h"
#include <math.h>
#include "../linear_algebra/small.h"

#define FOUND 1e-14   /* converged: how far g is off, over its size [-] */
#define NEAR 1e-8     /* converged too after one more step from here, which leaves about the square of it; and where rounding lets
                         no step come nearer [-] */
#define MARCHES 30    /* most marches of one solve */
#define LONGEST 0.5   /* longest step of g, over its size [-] */
#define SHORTEST 1e-2 /* least share of a step that is tried [-] */
#define STAGE 0.125   /* where no equilibrium is found at once, weight grows: first by this share, and as it is found by more or less [-] */
#define LEAST 1e-3    /* least share that it grows by [-] */

static double size_of(const double *v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static void turned(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
}

static int first_moving(const chain_rods *map) { return map->bodies[0].segment == CHAIN_GROUND; }

static chain_body *tip_of(const chain_rods *map, chain_state *state) { return state->bodies + map->count - 1; }

/* 1 - [g]x M, (3, 3), with the tip's turns M by g. */
static void system_of(const chain_rods *map, const chain_body *tip, const double *pull, double *system)
{
    const int first = chain_size(map) + CHAIN_PULL;
    for (int j = 0; j < 3; j++) {
        const double turn[3] = {tip->motion[3][first + j], tip->motion[4][first + j], tip->motion[5][first + j]};
        double change[3];
        follow_cross(pull, turn, change);
        for (int i = 0; i < 3; i++) system[3 * i + j] = (i == j) - change[i];
    }
}

/* A vector's length made `size`. */
static void resize(double size, double *v)
{
    const double own = size_of(v);
    for (int i = 0; i < 3 && own > 0.0; i++) v[i] *= size / own;
}

/* Newton's method from the weight's last `pull`, for a share of the weight; returns 0 if it finds none. */
static int newton(const chain_rods *map, const double *wrench, double share, chain_state *state)
{
    double *pull = map->weight->pull, whole[3], tried[3], step[3] = {0.0}, least = INFINITY, part = 1.0;
    for (int i = 0; i < 3; i++) whole[i] = share * map->chain->gravity[i];
    const double size = size_of(whole);
    memcpy(tried, pull, sizeof tried);
    resize(size, tried);
    for (int k = 0; k < MARCHES; k++) {
        const chain_body *tip = tip_of(map, state);
        double seen[3], system[9];
        chain_loads_march(map, wrench, tried, state);
        /* R^T G, and how far g is off */
        for (int i = 0; i < 3; i++) seen[i] = tip->rotation[i] * whole[0] + tip->rotation[3 + i] * whole[1] + tip->rotation[6 + i] * whole[2];
        const double rest[3] = {seen[0] - tried[0], seen[1] - tried[1], seen[2] - tried[2]}, off = size_of(rest);
        if (!(off < least)) { /* no decrease: rounding, or half the step */
            if (least <= NEAR * size) {
                chain_loads_march(map, wrench, pull, state);
                return 1;
            }
            part *= 0.5;
            if (part < SHORTEST || !isfinite(least)) return 0;
        } else {
            memcpy(pull, tried, sizeof tried);
            if (off <= FOUND * size || least <= NEAR * size) return 1;
            /* (1 - [R^T G]x M) dg = R^T G - g, at most LONGEST of its size */
            least = off;
            part = 1.0;
            system_of(map, tip, seen, system);
            memcpy(step, rest, sizeof step);
            if (!small_solve(3, system, 1, step)) return 0;
            if (size_of(step) > LONGEST * size) resize(LONGEST * size, step);
        }
        for (int i = 0; i < 3; i++) tried[i] = pull[i] + part * step[i];
        resize(size, tried);
    }
    return 0;
}

/* The acceleration that the tip sees in a pose. */
static void start_from(const chain_rods *map, chain_state *state)
{
    const double *R = tip_of(map, state)->rotation, *G = map->chain->gravity;
    for (int i = 0; i < 3; i++) map->weight->pull[i] = R[i] * G[0] + R[3 + i] * G[1] + R[6 + i] * G[2];
}

/* Predict the acceleration from the last one, as the wrenches change. */
static void predict(const chain_rods *map, const double *wrench)
{
    chain_weight *weight = map->weight;
    for (int c = 0; c < chain_size(map) && weight->count == map->count; c++)
        for (int i = 0; i < 3; i++) weight->pull[i] += weight->by_wrench[i][c] * (wrench[c] - weight->wrench[c]);
}

/* Let the weight grow from the pose without it. Its direction as the tip sees it, pull / share, is predicted on the line through the
 * last two; a stage that finds nothing is halved. */
static int grow(const chain_rods *map, const double *wrench, chain_state *state)
{
    double *pull = map->weight->pull, last[3], slope[3] = {0.0}, share = 0.0, stage = STAGE;
    chain_without_weight(map, wrench, 1, state);
    start_from(map, state);
    memcpy(last, pull, sizeof last);
    while (share < 1.0) {
        const double next = fmin(share + stage, 1.0);
        for (int i = 0; i < 3; i++) pull[i] = last[i] + slope[i] * (next - share);
        if (newton(map, wrench, next, state)) {
            for (int i = 0; i < 3; i++) {
                const double whole = pull[i] / next;
                slope[i] = (whole - last[i]) / (next - share);
                last[i] = whole;
            }
            share = next;
            stage *= 2.0;
        } else if ((stage *= 0.5) < LEAST) return 0;
    }
    return 1;
}

/* Find the acceleration: from the last one; or from the pose without weight, at once, or as the weight grows. */
static int solve(const chain_rods *map, const double *wrench, chain_state *state)
{
    if (map->weight->found) {
        predict(map, wrench);
        if (newton(map, wrench, 1.0, state)) return 1;
    }
    chain_without_weight(map, wrench, 1, state);
    start_from(map, state);
    if (newton(map, wrench, 1.0, state)) return 1;
    return grow(map, wrench, state);
}

/* T, and whether the finger rests there; returns 0 if it is singular. */
static int find_turning(const chain_rods *map, chain_state *state)
{
    chain_weight *weight = map->weight;
    const double *g = weight->pull;
    const double across[9] = {0.0, -g[2], g[1], g[2], 0.0, -g[0], -g[1], g[0], 0.0};
    double a[9];
    system_of(map, tip_of(map, state), g, a);
    /* trace - 1 and determinant: sum and product of two eigenvalues */
    const double sum = a[0] + a[4] + a[8] - 1.0;
    const double product = a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
    weight->stable = sum > 0.0 && product > 0.0;
    memcpy(weight->turning, across, sizeof across);
    if (small_solve(3, a, 3, weight->turning)) return 1;
    memset(weight->turning, 0, sizeof weight->turning);
    return 0;
}

/* Add to the motions of all bodies by inputs first ... last - 1 what follows from dg = T dtheta of the tip; `changes`, (3, inputs),
 * takes dg. */
static void turn_with_tip(const chain_rods *map, int first, int last, chain_state *state, double (*changes)[CHAIN_INPUTS])
{
    const int pull = chain_size(map) + CHAIN_PULL;
    for (int c = first; c < last; c++) {
        const chain_body *tip = tip_of(map, state);
        const double turn[3] = {tip->motion[3][c], tip->motion[4][c], tip->motion[5][c]};
        double change[3];
        turned(map->weight->turning, turn, change);
        for (int i = 0; i < 3; i++) changes[i][c] = change[i];
        for (int b = first_moving(map); b < map->count; b++)
            for (int i = 0; i < W; i++) {
                double *row = state->bodies[b].motion[i];
                row[c] += row[pull] * change[0] + row[pull + 1] * change[1] + row[pull + 2] * change[2];
            }
    }
}

int chain_weight_under(const chain_rods *map, const double *wrench, chain_state *state)
{
    chain_weight *weight = map->weight;
    weight->found = solve(map, wrench, state);
    weight->found &= find_turning(map, state);
    turn_with_tip(map, 0, chain_size(map), state, weight->by_wrench);
    weight->count = map->count;
    memcpy(weight->wrench, wrench, (size_t)chain_size(map) * sizeof *wrench);
    return weight->found;
}

int chain_weight_free(const chain_rods *map, chain_state *state)
{
    const double none[CHAIN_WRENCH] = {0.0};
    chain_contract(map);
    const int found = chain_weight_under(map, none, state);
    chain_weight_by_inputs(map, 0, state);
    return found && map->weight->stable;
}

void chain_weight_by_inputs(const chain_rods *map, int variants, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = chain_size(map), inputs = w + (variants ? chain->segments[0]->deviating : chain->tensions);
    double changes[3][CHAIN_INPUTS];
    chain_loads_by_inputs(map, variants, state);
    turn_with_tip(map, w, inputs, state, changes);
    /* changes of the loads by the tensions, as that acceleration changes */
    for (int b = first_moving(map); b < map->count && !variants; b++) {
        chain_load *own = map->weight->bodies + b;
        for (int i = 0; i < ROD_LOAD; i++)
            for (int c = w; c < inputs; c++)
                for (int j = 0; j < 3; j++) own->by_tensions[i][c - w] += own->by_pull[i][j] * changes[j][c];
    }
}

/* The march of chain.c where the chain weighs: from tip to base, a body transmits its load, which is a wrench and the acceleration
 * that it sees. The end of its part transmits, about the body's centre, the wrench and all weights of the part,
 *
 *     F = f + mu g,    M = m + s x g,
 *
 * and passes it on to the body before as chain.c does; g is turned alike. */
#include "chain_weight.h"

static void turned(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
}

static int first_moving(const chain_rods *map) { return map->bodies[0].segment == CHAIN_GROUND; }

void chain_weight_change(const chain_load *body, const double *load, const double *moment, double *change)
{
    const rod_mass *all = &body->own.all;
    double shift[3], by_shift[3], by_pull[3];
    /* dF = df + mu dg, dM = dm + ds x g + s x dg */
    for (int i = 0; i < 3; i++) {
        shift[i] = moment[i];
        for (int j = 0; j < ROD_LOAD; j++) shift[i] += body->own.moment_by_load[i][j] * load[j];
    }
    follow_cross(shift, body->load + W, by_shift);
    follow_cross(all->moment, load + W, by_pull);
    for (int i = 0; i < 3; i++) {
        change[i] = load[i] + all->mass * load[W + i];
        change[3 + i] = load[3 + i] + by_shift[i] + by_pull[i];
    }
}

/* From a body's load, (9), to that which it passes on to the one before, in place: f + mu g, m + s x g, g, turned and moved. */
static void pass_load(const chain_body *body, const rod_mass *all, double *load)
{
    double wrench[W], moment[3];
    follow_cross(all->moment, load + W, moment);
    for (int i = 0; i < 3; i++) {
        wrench[i] = load[i] + all->mass * load[W + i];
        wrench[3 + i] = load[3 + i] + moment[i];
    }
    /* A F, A M + a x A F, A g */
    turned(body->relative, wrench, load);
    turned(body->relative, wrench + 3, load + 3);
    follow_cross(body->arm, load, moment);
    for (int i = 0; i < 3; i++) load[3 + i] += moment[i];
    double pull[3];
    turned(body->relative, load + W, pull);
    memcpy(load + W, pull, sizeof pull);
}

/* The same of changes by inputs first ... last - 1, (9, inputs), in place, with the body's relative motions by them, and changes
 * of the first moment at fixed load, (3, inputs), or NULL. `passed` is the load that it passes on. */
static void pass_changes(const chain_body *body, const chain_load *own, const double *passed, int first, int last,
                         double (*moments)[CHAIN_INPUTS], double (*by)[CHAIN_INPUTS])
{
    for (int c = first; c < last; c++) {
        double motion[W], load[ROD_LOAD], change[W], moment[3] = {0.0}, spun[3], spin[3], pull[3];
        for (int i = 0; i < W; i++) motion[i] = body->motion[i][c];
        for (int i = 0; i < ROD_LOAD; i++) load[i] = by[i][c];
        for (int i = 0; i < 3 && moments; i++) moment[i] = moments[i][c];
        /* the wrench, of the part's end; then as the body moves relative to the one before */
        chain_weight_change(own, load, moment, change);
        chain_pass_change(body, motion, change);
        /* d(A g) = A dg + A dtheta x A g */
        turned(body->relative, motion + 3, spin);
        turned(body->relative, load + W, pull);
        follow_cross(spin, passed + W, spun);
        for (int i = 0; i < W; i++) by[i][c] = change[i];
        for (int i = 0; i < 3; i++) by[W + i][c] = pull[i] + spun[i];
    }
}

/* A body's motion relative to the end of its part by inputs first ... last - 1 at fixed tensions, from changes of its load. */
static void relative_motion(const chain_load *own, int first, int last, double (*by)[CHAIN_INPUTS], chain_body *body)
{
    for (int i = 0; i < W; i++) {
        for (int c = first; c < last; c++) body->motion[i][c] = 0.0;
        for (int j = 0; j < ROD_LOAD; j++)
            for (int c = first; c < last; c++) body->motion[i][c] += own->own.by_load[i][j] * by[j][c];
    }
}

/* The wrench that a part's end transmits, in the body's frame: what `chain_pass_change` takes. */
static void leave_transmitted(const chain_load *own, chain_body *body)
{
    double moment[3];
    follow_cross(own->own.all.moment, own->load + W, moment);
    for (int i = 0; i < 3; i++) {
        body->transmitted[i] = own->load[i] + own->own.all.mass * own->load[W + i];
        body->transmitted[3 + i] = own->load[3 + i] + moment[i];
    }
}

void chain_loads_march(const chain_rods *map, const double *wrench, const double *pull, chain_state *state)
{
    const int w = chain_size(map), begin = first_moving(map), first = w + CHAIN_PULL;
    double load[ROD_LOAD] = {0.0}, by[ROD_LOAD][CHAIN_INPUTS];
    for (int i = 0; i < ROD_LOAD; i++) {
        memset(by[i], 0, (size_t)(first + 3) * sizeof(double));
        if (i >= W) by[i][first + i - W] = 1.0;
    }
    memcpy(load + W, pull, 3 * sizeof *pull);
    /* from tip to base */
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        chain_load *own = map->weight->bodies + b;
        /* add the wrench on this body */
        for (int i = 0; i < W; i++) {
            load[i] += wrench[W * b + i];
            by[i][W * b + i] += 1.0;
        }
        memcpy(own->load, load, sizeof load);
        for (int i = 0; i < ROD_LOAD; i++) memcpy(own->by_pull[i], by[i] + first, sizeof own->by_pull[i]);
        /* its part of the rod: relative pose, and relative motions */
        rod_weight_under(map->rods + map->bodies[b].segment, map->bodies[b].part, load, &body->end, &own->own);
        chain_locate(map, b, body);
        leave_transmitted(own, body);
        relative_motion(own, 0, w, by, body);
        relative_motion(own, first, first + 3, by, body);
        if (b == begin) break;
        pass_load(body, &own->own.all, load);
        pass_changes(body, own, load, 0, w, NULL, by);
        pass_changes(body, own, load, first, first + 3, NULL, by);
    }
    chain_compose(map, 0, w, state);
    chain_compose(map, first, first + 3, state);
}

void chain_loads_by_inputs(const chain_rods *map, int variants, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = chain_size(map), begin = first_moving(map), inputs = w + (variants ? chain->segments[0]->deviating : chain->tensions);
    double by[ROD_LOAD][CHAIN_INPUTS] = {{0.0}};
    /* from tip to base: motions at fixed load, and through the changes of the load, where the tip sees the same acceleration */
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        chain_load *own = map->weight->bodies + b;
        const int k = map->bodies[b].segment, count = variants ? inputs - w : chain->segments[k]->tensions;
        const int32_t *tensions = chain->own + chain->tensions * k;
        double moments[3][CHAIN_INPUTS], passed[ROD_LOAD];
        if (variants) rod_weight_by_variants(map->rods + k, map->bodies[b].part, own->load + W, body->by_tensions, &own->own);
        else rod_weight_by_tensions(map->rods + k, map->bodies[b].part, own->load + W, body->by_tensions, &own->own);
        for (int i = 0; i < ROD_LOAD && !variants; i++)
            for (int c = w; c < inputs; c++) own->by_tensions[i][c - w] = by[i][c];
        relative_motion(own, w, inputs, by, body);
        for (int i = 0; i < 3; i++) memset(moments[i] + w, 0, (size_t)(inputs - w) * sizeof(double));
        /* a segment's own tensions are some of the chain's */
        for (int j = 0; j < count; j++) {
            const int c = w + (variants ? j : tensions[j]);
            for (int i = 0; i < W; i++) body->motion[i][c] += body->by_tensions[i][j];
            for (int i = 0; i < 3; i++) moments[i][c] = own->own.moment_by_inputs[i][j];
        }
        if (b == begin) break;
        memcpy(passed, own->load, sizeof passed);
        pass_load(body, &own->own.all, passed);
        pass_changes(body, own, passed, w, inputs, moments, by);
    }
    chain_compose(map, w, inputs, state);
}

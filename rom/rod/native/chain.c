/* From tip to base: a rod says where its plate is, seen from the plate before. What that plate bears is its own wrench and
 * the one that the next plate bears, moved there, and nothing else: a long tendon slides through a plate, and enters the
 * rods of the segments it passes as if it ended at their plates. From base to tip the poses follow each other. (Such a
 * march is a nonlinear transfer-matrix method.) */
#include "chain.h"

int32_t fingerfem_chain_memory(const fingerfem_chain *chain)
{
    int size = 0;
    for (int k = 0; k < chain->plates; k++) size += fingerfem_segment_memory(chain->segments[k]);
    return size;
}

void chain_set_tensions(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found)
{
    found->chain = chain;
    found->work = memory;
    for (int k = 0; k < chain->plates; k++) found->work += rod_memory(chain->segments[k]);
    for (int k = 0; k < chain->plates; k++) {
        const fingerfem_segment *segment = chain->segments[k];
        double own[TENSIONS_MOST];
        for (int i = 0; i < segment->tensions; i++) own[i] = tensions[chain->own[chain->tensions * k + i]];
        rod_set_tensions(segment, own, memory, found->work, found->rods + k);
        tensions_corners(segment, found->rods[k].monomials, found->corners[k]);
        memory += rod_memory(segment);
    }
}

void chain_contract(const chain_rods *map)
{
    for (int k = 0; k < map->chain->plates; k++) rod_contract(map->rods + k);
}

static void cross(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void turned(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] + rotation[3 * i + 2] * v[2];
}

static void turned_back(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[i] * v[0] + rotation[3 + i] * v[1] + rotation[6 + i] * v[2];
}

/* Where a plate is, seen from its segment's clamp; the arm is from the plate before, whose centre lies half a plate before
 * the clamp. */
static void locate(const fingerfem_chain *chain, int k, chain_plate *plate)
{
    for (int i = 0; i < 3; i++) {
        const double *p = plate->end.place, *Q = plate->end.rotation + i; /* of the clamp, seen from the plate */
        plate->arm[i] = -(Q[0] * p[0] + Q[3] * p[1] + Q[6] * p[2]);
        for (int j = 0; j < 3; j++) plate->relative[3 * i + j] = Q[3 * j];
    }
    if (k) plate->arm[0] += chain->segments[k]->half_lengths[0];
}

/* How what a plate passes on changes, (6), in place, as its motion relative to the one before, (6), and what it transmits do;
 * force and moment are what it passes on, about its own centre. */
static inline void pass_change(const chain_plate *plate, const double *force, const double *moment, const double *motion,
                               double *change)
{
    double moved[3], spun[3], by_force[3], by_moment[3], one[3], two[3], three[3];
    turned(plate->relative, motion, moved);
    turned(plate->relative, motion + 3, spun);
    turned(plate->relative, change, by_force);
    turned(plate->relative, change + 3, by_moment);
    cross(spun, force, one);
    for (int i = 0; i < 3; i++) by_force[i] += one[i];
    cross(spun, moment, one);
    cross(moved, force, two);
    cross(plate->arm, by_force, three);
    for (int i = 0; i < 3; i++) {
        change[i] = by_force[i];
        change[3 + i] = by_moment[i] + one[i] + two[i] + three[i];
    }
}

void chain_pass_change(const chain_plate *plate, const double *motion, double *change)
{
    double force[3], moment[3];
    turned(plate->relative, plate->borne, force);
    turned(plate->relative, plate->borne + 3, moment);
    pass_change(plate, force, moment, motion, change);
}

/* What a plate passes on to the one before, and how that changes by inputs first ... last - 1, (6) and (6, inputs); in
 * place. */
static void pass_on(const chain_plate *plate, int first, int last, double *borne, double (*by)[CHAIN_INPUTS])
{
    double force[3], moment[3], found[W];
    turned(plate->relative, borne, force);
    turned(plate->relative, borne + 3, moment);
    for (int c = first; c < last; c++) {
        double motion[W], column[W];
        for (int i = 0; i < W; i++) {
            motion[i] = plate->motion[i][c];
            column[i] = by[i][c];
        }
        pass_change(plate, force, moment, motion, column);
        for (int i = 0; i < W; i++) by[i][c] = column[i];
    }
    cross(plate->arm, force, found);
    for (int i = 0; i < 3; i++) {
        borne[i] = force[i];
        borne[3 + i] = moment[i] + found[i];
    }
}

/* A plate's motion relative to its clamp by inputs first ... last - 1, of which what it bears changes by `by`. */
static void relative_motion(int first, int last, double (*by)[CHAIN_INPUTS], chain_plate *plate)
{
    for (int i = 0; i < W; i++) {
        for (int c = first; c < last; c++) plate->motion[i][c] = 0.0;
        for (int j = 0; j < W; j++)
            for (int c = first; c < last; c++) plate->motion[i][c] += plate->end.by_wrench[i][j] * by[j][c];
    }
}

/* Add that by its segment's tensions. */
static void add_by_tensions(const fingerfem_chain *chain, int k, chain_plate *plate)
{
    const int32_t *own = chain->own + chain->tensions * k;
    for (int i = 0; i < W; i++)
        for (int j = 0; j < chain->segments[k]->tensions; j++)
            plate->motion[i][W * chain->plates + own[j]] += plate->by_tensions[i][j];
}

/* Poses in space and motions by inputs first ... last - 1, from those relative to the plate before. */
static void compose(const fingerfem_chain *chain, int first, int last, chain_state *state)
{
    for (int k = 0; k < chain->plates; k++) {
        chain_plate *plate = state->plates + k, *before = plate - 1;
        if (!k) {
            memcpy(plate->centre, plate->arm, sizeof plate->centre);
            memcpy(plate->rotation, plate->relative, sizeof plate->rotation);
            continue;
        }
        double moved[3], carried[3], spun[3];
        turned(before->rotation, plate->arm, moved);
        for (int i = 0; i < 3; i++) {
            plate->centre[i] = before->centre[i] + moved[i];
            turned_back(plate->relative, before->rotation + 3 * i, plate->rotation + 3 * i); /* row of R times relative */
        }
        for (int c = first; c < last; c++) {
            double t[3];
            for (int i = 0; i < 3; i++) t[i] = before->motion[3 + i][c];
            cross(t, plate->arm, moved);
            for (int i = 0; i < 3; i++) moved[i] += before->motion[i][c];
            turned_back(plate->relative, moved, carried);
            turned_back(plate->relative, t, spun);
            for (int i = 0; i < 3; i++) {
                plate->motion[i][c] += carried[i];
                plate->motion[3 + i][c] += spun[i];
            }
        }
    }
}

void chain_under(const chain_rods *map, const double *wrench, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = W * chain->plates;
    double borne[W] = {0.0}, by[W][CHAIN_INPUTS] = {{0.0}};
    for (int k = chain->plates - 1; k >= 0; k--) {
        chain_plate *plate = state->plates + k;
        for (int i = 0; i < W; i++) {
            borne[i] += wrench[W * k + i];
            by[i][W * k + i] += 1.0;
            plate->borne[i] = borne[i];
        }
        rod_under(map->rods + k, borne, &plate->end);
        locate(chain, k, plate);
        if (chain->plates > 1) relative_motion(0, w, by, plate);
        else for (int i = 0; i < W; i++) memcpy(plate->motion[i], plate->end.by_wrench[i], sizeof plate->end.by_wrench[i]);
        if (k) pass_on(plate, 0, w, borne, by);
    }
    compose(chain, 0, w, state);
}

void chain_free(const chain_rods *map, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = W * chain->plates, inputs = w + chain->tensions;
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int k = 0; k < chain->plates; k++) {
        chain_plate *plate = state->plates + k;
        rod_free(map->rods + k, &plate->end, plate->by_tensions);
        memset(plate->borne, 0, sizeof plate->borne); /* whatever the tensions */
        locate(chain, k, plate);
        relative_motion(w, inputs, by, plate);
        add_by_tensions(chain, k, plate);
    }
    compose(chain, w, inputs, state);
}

void chain_by_variants(const chain_rods *map, int pressed, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = W * chain->plates, count = chain->segments[0]->deviating;
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int k = chain->plates - 1; k >= 0; k--) {
        chain_plate *plate = state->plates + k;
        double borne[W];
        rod_by_variants(map->rods + k, pressed, plate->by_tensions);
        memcpy(borne, plate->borne, sizeof borne);
        relative_motion(w, w + count, by, plate);
        for (int i = 0; i < W; i++)
            for (int v = 0; v < count; v++) plate->motion[i][w + v] += plate->by_tensions[i][v];
        if (k) pass_on(plate, w, w + count, borne, by);
    }
    compose(chain, w, w + count, state);
}

void chain_by_tensions(const chain_rods *map, chain_state *state)
{
    const fingerfem_chain *chain = map->chain;
    const int w = W * chain->plates, inputs = w + chain->tensions;
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int k = chain->plates - 1; k >= 0; k--) {
        chain_plate *plate = state->plates + k;
        double borne[W];
        rod_by_tensions(map->rods + k, plate->by_tensions);
        memcpy(borne, plate->borne, sizeof borne);
        relative_motion(w, inputs, by, plate);
        add_by_tensions(chain, k, plate);
        if (k) pass_on(plate, w, inputs, borne, by);
    }
    compose(chain, w, inputs, state);
}

int chain_placed(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory, double *held,
                 chain_rods *map, chain_state *state)
{
    int inside = tensions_all_clamped(chain->segments[0], tensions, held);
    chain_set_tensions(chain, held, memory, map);
    chain_contract(map);
    chain_under(map, wrenches, state);
    chain_by_tensions(map, state);
    for (int k = 0; k < chain->plates; k++) inside &= state->plates[k].end.inside;
    return inside;
}

int fingerfem_chain_place(const fingerfem_chain *chain, const double *tensions, const double *wrenches, double *memory,
                          double *centres, double *rotations, double *motions)
{
    const int n = chain->plates, w = W * n, t = chain->tensions;
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    const int inside = chain_placed(chain, tensions, wrenches, memory, held, &map, &state);
    for (int k = 0; k < n; k++) {
        const chain_plate *plate = state.plates + k;
        memcpy(centres + 3 * k, plate->centre, sizeof plate->centre);
        memcpy(rotations + 9 * k, plate->rotation, sizeof plate->rotation);
        for (int i = 0; i < W; i++)
            for (int c = 0; c < t + w; c++)
                motions[(t + w) * (W * k + i) + c] = plate->motion[i][c < t ? w + c : c - t] * (c >= t || held[c] == tensions[c]);
    }
    return inside;
}

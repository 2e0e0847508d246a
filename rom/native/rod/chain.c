/* From tip to base: a part of a rod says where its body is, seen from the body before. What a body transmits is its own wrench and
 * what the next one transmits, moved there, and nothing else: a long tendon slides through a plate, and enters the
 * rods of the segments it passes as if it ended at their plates. From base to tip the poses follow each other. (Such a
 * march is a nonlinear transfer-matrix method.) */
#include "chain.h"

int32_t fingerfem_chain_memory(const fingerfem_chain *chain)
{
    int size = 0;
    for (int k = 0; k < chain->plates; k++) size += fingerfem_segment_memory(chain->segments[k]);
    return size;
}

int32_t fingerfem_chain_loads(const fingerfem_chain *chain)
{
    int count = 0;
    for (int k = 0; k < chain->plates; k++) count += chain->segments[k]->elements;
    return W * count;
}

void chain_plates_alone(chain_rods *map)
{
    map->count = map->chain->plates;
    for (int k = 0; k < map->count; k++) map->bodies[k] = (chain_place){k, {0, map->chain->segments[k]->elements}};
}

void chain_set_tensions(const fingerfem_chain *chain, const double *tensions, double *memory, chain_rods *found)
{
    found->chain = chain;
    found->work = memory;
    chain_plates_alone(found);
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

int chain_body_of(const chain_rods *map, int segment, int element)
{
    for (int b = 0; b < map->count; b++)
        if (map->bodies[b].segment == segment && (segment < 0 || map->bodies[b].part.first == element)) return b;
    return -1;
}

int chain_plate_of(const chain_rods *map, int plate) { return chain_body_of(map, plate, 0); }

int chain_add_body(chain_rods *map, int segment, int element)
{
    const int known = chain_body_of(map, segment, element);
    if (known >= 0) return known;
    if (map->count == MOST_BODIES) return -1;
    int b = map->count; /* its place: nearer to the clamp than all that are beyond it */
    while (b && (map->bodies[b - 1].segment > segment ||
                 (map->bodies[b - 1].segment == segment && map->bodies[b - 1].part.first < element)))
        b--;
    memmove(map->bodies + b + 1, map->bodies + b, (size_t)(map->count - b) * sizeof *map->bodies);
    map->count++;
    map->bodies[b] = (chain_place){segment, {element, 0}};
    if (segment < 0) return b;
    map->bodies[b].part.last = map->bodies[b + 1].part.last; /* a plate is beyond it */
    map->bodies[b + 1].part.last = element;
    return b;
}

int chain_load_of(const chain_rods *map, int body)
{
    const chain_place *own = map->bodies + body;
    int load = map->chain->plates;
    if (!own->part.first) return own->segment;
    for (int k = 0; k < own->segment; k++) load += map->chain->segments[k]->elements - 1;
    return load + own->part.first - 1;
}

int chain_take_loads(chain_rods *map, const double *loads, double *wrench)
{
    int load = map->chain->plates, room = 1;
    for (int k = 0; k < map->chain->plates; k++)
        for (int e = 1; e < map->chain->segments[k]->elements; e++, load++) {
            int any = 0;
            for (int i = 0; i < W; i++) any |= loads[W * load + i] != 0.0;
            room &= !any || chain_add_body(map, k, e) >= 0;
        }
    for (int b = 0; b < map->count; b++) memcpy(wrench + W * b, loads + W * chain_load_of(map, b), W * sizeof *wrench);
    return room;
}

void chain_leave_loads(const chain_rods *map, const double *wrench, double *loads)
{
    memset(loads, 0, (size_t)fingerfem_chain_loads(map->chain) * sizeof *loads);
    for (int b = 0; b < map->count; b++)
        if (map->bodies[b].segment != CHAIN_GROUND) memcpy(loads + W * chain_load_of(map, b), wrench + W * b, W * sizeof *loads);
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

/* Where a body is, seen from where its part ends; the arm is from the body before. If that is a plate, its centre lies half a
 * plate before the clamp. */
static void locate(const chain_rods *map, int b, chain_body *body)
{
    const chain_place *own = map->bodies + b;
    const fingerfem_segment *const *segment = map->chain->segments + own->segment;
    for (int i = 0; i < 3; i++) {
        const double *p = body->end.place, *Q = body->end.rotation + i; /* of that end, seen from the body */
        body->arm[i] = -(Q[0] * p[0] + Q[3] * p[1] + Q[6] * p[2]);
        for (int j = 0; j < 3; j++) body->relative[3 * i + j] = Q[3 * j];
    }
    if (own->segment && own->part.last == segment[0]->elements) body->arm[0] += segment[-1]->half_lengths[0];
}

/* The first body that moves: the ground does not. */
static int first_moving(const chain_rods *map) { return map->bodies[0].segment == CHAIN_GROUND; }

/* How what a body passes on changes, (6), in place, as its motion relative to the one before, (6), and what it transmits do;
 * force and moment are what it passes on, about its own centre. */
static inline void pass_change(const chain_body *body, const double *force, const double *moment, const double *motion,
                               double *change)
{
    double moved[3], spun[3], by_force[3], by_moment[3], one[3], two[3], three[3];
    turned(body->relative, motion, moved);
    turned(body->relative, motion + 3, spun);
    turned(body->relative, change, by_force);
    turned(body->relative, change + 3, by_moment);
    cross(spun, force, one);
    for (int i = 0; i < 3; i++) by_force[i] += one[i];
    cross(spun, moment, one);
    cross(moved, force, two);
    cross(body->arm, by_force, three);
    for (int i = 0; i < 3; i++) {
        change[i] = by_force[i];
        change[3 + i] = by_moment[i] + one[i] + two[i] + three[i];
    }
}

void chain_pass_change(const chain_body *body, const double *motion, double *change)
{
    double force[3], moment[3];
    turned(body->relative, body->transmitted, force);
    turned(body->relative, body->transmitted + 3, moment);
    pass_change(body, force, moment, motion, change);
}

/* What a body passes on to the one before, and how that changes by inputs first ... last - 1, (6) and (6, inputs); in
 * place. */
static void pass_on(const chain_body *body, int first, int last, double *transmitted, double (*by)[CHAIN_INPUTS])
{
    double force[3], moment[3], found[W];
    turned(body->relative, transmitted, force);
    turned(body->relative, transmitted + 3, moment);
    for (int c = first; c < last; c++) {
        double motion[W], column[W];
        for (int i = 0; i < W; i++) {
            motion[i] = body->motion[i][c];
            column[i] = by[i][c];
        }
        pass_change(body, force, moment, motion, column);
        for (int i = 0; i < W; i++) by[i][c] = column[i];
    }
    cross(body->arm, force, found);
    for (int i = 0; i < 3; i++) {
        transmitted[i] = force[i];
        transmitted[3 + i] = moment[i] + found[i];
    }
}

/* A body's motion relative to where its part ends by inputs first ... last - 1, of which what it transmits changes by `by`. */
static void relative_motion(int first, int last, double (*by)[CHAIN_INPUTS], chain_body *body)
{
    for (int i = 0; i < W; i++) {
        for (int c = first; c < last; c++) body->motion[i][c] = 0.0;
        for (int j = 0; j < W; j++)
            for (int c = first; c < last; c++) body->motion[i][c] += body->end.by_wrench[i][j] * by[j][c];
    }
}

/* Add that by its segment's tensions. */
static void add_by_tensions(const chain_rods *map, int b, chain_body *body)
{
    const fingerfem_chain *chain = map->chain;
    const int k = map->bodies[b].segment;
    const int32_t *own = chain->own + chain->tensions * k;
    for (int i = 0; i < W; i++)
        for (int j = 0; j < chain->segments[k]->tensions; j++)
            body->motion[i][chain_size(map) + own[j]] += body->by_tensions[i][j];
}

/* Poses in space and motions by inputs first ... last - 1, from those relative to the body before. */
static void compose(const chain_rods *map, int first, int last, chain_state *state)
{
    static const double origin[3] = {0.0}, upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const int begin = first_moving(map);
    for (int b = 0; b < map->count; b++) {
        chain_body *body = state->bodies + b, *before = body - 1;
        if (b < begin) {
            memcpy(body->centre, origin, sizeof origin);
            memcpy(body->rotation, upright, sizeof upright);
            for (int i = 0; i < W; i++) memset(body->motion[i] + first, 0, (size_t)(last - first) * sizeof(double));
        }
        if (b == begin) {
            memcpy(body->centre, body->arm, sizeof body->centre);
            memcpy(body->rotation, body->relative, sizeof body->rotation);
        }
        if (b <= begin) continue;
        double moved[3], carried[3], spun[3];
        turned(before->rotation, body->arm, moved);
        for (int i = 0; i < 3; i++) {
            body->centre[i] = before->centre[i] + moved[i];
            turned_back(body->relative, before->rotation + 3 * i, body->rotation + 3 * i); /* row of R times relative */
        }
        for (int c = first; c < last; c++) {
            double t[3];
            for (int i = 0; i < 3; i++) t[i] = before->motion[3 + i][c];
            cross(t, body->arm, moved);
            for (int i = 0; i < 3; i++) moved[i] += before->motion[i][c];
            turned_back(body->relative, moved, carried);
            turned_back(body->relative, t, spun);
            for (int i = 0; i < 3; i++) {
                body->motion[i][c] += carried[i];
                body->motion[3 + i][c] += spun[i];
            }
        }
    }
}

void chain_under(const chain_rods *map, const double *wrench, chain_state *state)
{
    const int w = chain_size(map), begin = first_moving(map);
    double transmitted[W] = {0.0}, by[W][CHAIN_INPUTS];
    for (int i = 0; i < W && map->count > 1; i++) memset(by[i], 0, (size_t)w * sizeof(double));
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        for (int i = 0; i < W; i++) {
            transmitted[i] += wrench[W * b + i];
            if (map->count > 1) by[i][W * b + i] += 1.0;
            body->transmitted[i] = transmitted[i];
        }
        rod_under(map->rods + map->bodies[b].segment, map->bodies[b].part, transmitted, &body->end);
        locate(map, b, body);
        if (map->count > 1) relative_motion(0, w, by, body);
        else for (int i = 0; i < W; i++) memcpy(body->motion[i], body->end.by_wrench[i], sizeof body->end.by_wrench[i]);
        if (b > begin) pass_on(body, 0, w, transmitted, by);
    }
    compose(map, 0, w, state);
}

void chain_free(const chain_rods *map, chain_state *state)
{
    const int w = chain_size(map), inputs = w + map->chain->tensions;
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int b = 0; b < map->count; b++) {
        chain_body *body = state->bodies + b;
        rod_free(map->rods + map->bodies[b].segment, &body->end, body->by_tensions);
        memset(body->transmitted, 0, sizeof body->transmitted); /* whatever the tensions */
        locate(map, b, body);
        relative_motion(w, inputs, by, body);
        add_by_tensions(map, b, body);
    }
    compose(map, w, inputs, state);
}

void chain_by_variants(const chain_rods *map, int pressed, chain_state *state)
{
    const int w = chain_size(map), count = map->chain->segments[0]->deviating, begin = first_moving(map);
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        double transmitted[W];
        rod_by_variants(map->rods + map->bodies[b].segment, map->bodies[b].part, pressed, body->by_tensions);
        memcpy(transmitted, body->transmitted, sizeof transmitted);
        relative_motion(w, w + count, by, body);
        for (int i = 0; i < W; i++)
            for (int v = 0; v < count; v++) body->motion[i][w + v] += body->by_tensions[i][v];
        if (b > begin) pass_on(body, w, w + count, transmitted, by);
    }
    compose(map, w, w + count, state);
}

void chain_by_tensions(const chain_rods *map, chain_state *state)
{
    const int w = chain_size(map), inputs = w + map->chain->tensions, begin = first_moving(map);
    double by[W][CHAIN_INPUTS] = {{0.0}};
    for (int b = map->count - 1; b >= begin; b--) {
        chain_body *body = state->bodies + b;
        double transmitted[W];
        rod_by_tensions(map->rods + map->bodies[b].segment, map->bodies[b].part, body->by_tensions);
        memcpy(transmitted, body->transmitted, sizeof transmitted);
        relative_motion(w, inputs, by, body);
        add_by_tensions(map, b, body);
        if (b > begin) pass_on(body, w, inputs, transmitted, by);
    }
    compose(map, w, inputs, state);
}

void chain_section(const chain_rods *map, const chain_state *state, int segment, int element, double *place, double *rotation)
{
    const rod_element *own = map->rods[segment].elements + element;
    int b = chain_plate_of(map, segment);
    while (map->bodies[b].part.last <= element) b--;
    const chain_body *body = state->bodies + b;
    for (int i = 0; i < 3; i++) {
        const double *row = body->rotation + 3 * i, *Q = own->rotation;
        place[i] = body->centre[i] + row[0] * own->place[0] + row[1] * own->place[1] + row[2] * own->place[2];
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = row[0] * Q[j] + row[1] * Q[3 + j] + row[2] * Q[6 + j];
    }
}

int chain_placed(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory, double *held,
                 chain_rods *map, chain_state *state)
{
    double wrench[CHAIN_WRENCH];
    int inside = tensions_all_clamped(chain->segments[0], tensions, held);
    chain_set_tensions(chain, held, memory, map);
    chain_contract(map);
    inside &= chain_take_loads(map, loads, wrench);
    chain_under(map, wrench, state);
    chain_by_tensions(map, state);
    for (int b = 0; b < map->count; b++) inside &= state->bodies[b].end.inside;
    return inside;
}

int fingerfem_chain_place(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                          double *centres, double *rotations, double *motions)
{
    const int n = chain->plates, t = chain->tensions, columns = t + W * n;
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    const int inside = chain_placed(chain, tensions, loads, memory, held, &map, &state), w = chain_size(&map);
    for (int k = 0; k < n; k++) {
        const chain_body *plate = state.bodies + chain_plate_of(&map, k);
        memcpy(centres + 3 * k, plate->centre, sizeof plate->centre);
        memcpy(rotations + 9 * k, plate->rotation, sizeof plate->rotation);
        for (int i = 0; i < W; i++) {
            double *row = motions + columns * (W * k + i);
            for (int c = 0; c < t; c++) row[c] = held[c] == tensions[c] ? plate->motion[i][w + c] : 0.0;
            for (int j = 0; j < n; j++) memcpy(row + t + W * j, plate->motion[i] + W * chain_plate_of(&map, j), W * sizeof *row);
        }
    }
    return inside;
}

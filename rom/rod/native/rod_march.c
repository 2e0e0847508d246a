/* Section k has its place p and rotation Q seen from the plate, and carries the plate's wrench f, m, moved there: Q^T f and
 * Q^T (m - p x f). The element beyond it has the place q and the rotation R by its Gibbs vector g, so that
 *
 *     p' = p + Q q,    Q' = Q R,    R = 1 + s [g]x + s [g]x [g]x,    s = 2 / (1 + g.g).
 *
 * Changes are followed in the plate's frame: a section moves by dp and turns by b, dQ = [b]x Q, so that
 *
 *     b' = b + s Q (1 + [g]x) dg,    dp' = dp + b x Q q + Q dq,
 *
 * where dq and dg are the element's, by the tensions, and by the wrench that changes as its section moves. They are rows of
 * eight numbers, one for every input. */
#include "rod_march.h"

enum { POSE = FINGERFEM_POSE, W = ROD_WRENCH };

static const fingerfem_law *law_of(const rod_state *rod, int k) { return rod->segment->law[rod->segment->law_of[k]]; }

/* The largest that any law needs of something. */
static int most(const fingerfem_segment *segment, int (*of)(const fingerfem_segment *, const fingerfem_law *))
{
    int found = 0;
    for (int k = 0; k < segment->laws; k++) {
        const int own = of(segment, segment->law[k]);
        found = own > found ? own : found;
    }
    return found;
}

int rod_memory(const fingerfem_segment *segment)
{
    const int element = (int)(sizeof(rod_element) / sizeof(double)) + most(segment, element_products);
    const int law = most(segment, element_contracted) + POSE * (1 + segment->tensions);
    return POSE + segment->laws * law + segment->elements * element + (1 + segment->tensions) * segment->monomials;
}

int rod_work(const fingerfem_segment *segment) { return outline_work(segment); }

int32_t fingerfem_segment_memory(const fingerfem_segment *segment) { return rod_memory(segment) + rod_work(segment); }

void rod_pull(const fingerfem_segment *segment, const double *tensions, double *memory, double *work, rod_state *found)
{
    found->segment = segment;
    found->free_stride = POSE * (1 + segment->tensions);
    found->contracted_stride = most(segment, element_contracted);
    found->products_stride = most(segment, element_products);
    memory += (0 - (uintptr_t)memory / sizeof *memory) % POSE; /* whole eights lie in one line of the cache */
    found->contracted = memory;
    memory += segment->laws * found->contracted_stride;
    found->free = memory;
    memory += segment->laws * found->free_stride;
    found->elements = (rod_element *)memory;
    memory += segment->elements * (int)(sizeof(rod_element) / sizeof(double));
    found->products = memory;
    found->monomials = memory + segment->elements * found->products_stride;
    found->work = work;
    tensions_monomials(segment, tensions, found->monomials);
}

void rod_contract(const rod_state *rod)
{
    for (int k = 0; k < rod->segment->laws; k++)
        element_contract(rod->segment, rod->segment->law[k], rod->monomials, rod->contracted + k * rod->contracted_stride);
}

/* Where an element's proximal section is, and what its changes are turned by. */
static void advance(rod_element *element, double *place, double *rotation)
{
    const double *Q = element->rotation, *q = element->pose, *g = element->pose + 3;
    const double s = 2.0 / (1.0 + g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    double next[9];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const double *row = Q + 3 * i, along = row[0] * g[0] + row[1] * g[1] + row[2] * g[2];
        const double across[3] = {row[1] * g[2] - row[2] * g[1], row[2] * g[0] - row[0] * g[2], row[0] * g[1] - row[1] * g[0]};
        element->arm[i] = row[0] * q[0] + row[1] * q[1] + row[2] * q[2];
        place[i] = element->place[i] + element->arm[i];
#pragma GCC unroll 3
        for (int j = 0; j < 3; j++) {
            element->turning[3 * i + j] = s * (row[j] + across[j]);
            next[3 * i + j] = s * (row[j] + across[j] + along * g[j]) - row[j];
        }
    }
    memcpy(rotation, next, sizeof next);
}

/* The motion of an element's proximal section, from that of its distal one and from changes of its pose, (6). */
static inline void move_on(const rod_element *element, const eight *change, rod_motion *moved)
{
    const double *a = element->arm;
    eight turn[3];
    memcpy(turn, moved->turn, sizeof turn);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const double *Q = element->rotation + 3 * i, *G = element->turning + 3 * i;
        moved->turn[i] += G[0] * change[3] + G[1] * change[4] + G[2] * change[5];
        moved->move[i] += Q[0] * change[0] + Q[1] * change[1] + Q[2] * change[2];
    }
    moved->move[0] += turn[1] * a[2] - turn[2] * a[1];
    moved->move[1] += turn[2] * a[0] - turn[0] * a[2];
    moved->move[2] += turn[0] * a[1] - turn[1] * a[0];
}

static const eight units[POSE] = {
    {1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 1.0},
    {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
};

static inline void cross(const double *a, const double *b, double *found)
{
    found[0] = a[1] * b[2] - a[2] * b[1];
    found[1] = a[2] * b[0] - a[0] * b[2];
    found[2] = a[0] * b[1] - a[1] * b[0];
}

/* The moment of the plate's wrench about a section's centre, in the plate's frame. */
static inline void moment_at(const double *place, const double *wrench, double *moment)
{
    cross(place, wrench, moment);
    for (int i = 0; i < 3; i++) moment[i] = wrench[3 + i] - moment[i];
}

/* The plate's wrench as an element's distal section carries it, in its own frame. */
static inline void carry(const double *wrench, rod_element *element)
{
    const double *Q = element->rotation;
    double moment[3];
    moment_at(element->place, wrench, moment);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        element->wrench[i] = Q[i] * wrench[0] + Q[3 + i] * wrench[1] + Q[6 + i] * wrench[2];
        element->wrench[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

/* How that changes as the section moves, and, where the inputs are the wrench's components, with these; (6). */
__attribute__((always_inline)) static inline void carry_change(const double *wrench, const rod_element *element,
                                                               const rod_motion *moved, int by_wrench, eight *change)
{
    const double *Q = element->rotation, *f = wrench, *p = element->place;
    const eight *dp = moved->move, *b = moved->turn;
    eight force[3], moment[3];
    double m[3];
    moment_at(p, wrench, m);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        force[i] = b[l] * f[j] - b[j] * f[l];
        moment[i] = (dp[l] * f[j] - dp[j] * f[l]) + (b[l] * m[j] - b[j] * m[l]);
        if (!by_wrench) continue;
        force[i] += units[i];
        moment[i] += units[3 + i] - (p[j] * units[l] - p[l] * units[j]);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        change[i] = Q[i] * force[0] + Q[3 + i] * force[1] + Q[6 + i] * force[2];
        change[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

/* Add the change of an element's pose, (6), with the wrench that it carries. */
static inline void yield_to(const rod_element *element, const eight *wrench, eight *change)
{
#pragma GCC unroll 6
    for (int i = 0; i < W; i++)
#pragma GCC unroll 6
        for (int o = 0; o < W; o++) change[o] += element->by_wrench[POSE * i + o] * wrench[i];
}

/* The motion of the plate seen from the clamp, in its own frame, by that of the clamp seen from the plate. */
static inline void seen_from_clamp(const double *place, const rod_motion *clamp, eight *found)
{
    const eight *b = clamp->turn;
    const double *p = place;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        found[i] = b[j] * p[l] - b[l] * p[j] - clamp->move[i];
        found[3 + i] = -b[i];
    }
}

static const double plate_place[3] = {0.0}, plate_rotation[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};

void rod_under(const rod_state *rod, const double *wrench, rod_end *end)
{
    const fingerfem_segment *segment = rod->segment;
    rod_motion moved = {{{0.0}}, {{0.0}}};
    eight seen[W];
    end->inside = 1;
    memcpy(end->place, plate_place, sizeof end->place);
    memcpy(end->rotation, plate_rotation, sizeof end->rotation);
    for (int k = 0; k < segment->elements; k++) {
        rod_element *element = rod->elements + k;
        const fingerfem_law *law = law_of(rod, k);
        eight carried[W], change[W] = {{0.0}};
        memcpy(element->place, end->place, sizeof element->place);
        memcpy(element->rotation, end->rotation, sizeof element->rotation);
        carry(wrench, element);
        end->inside &= element_inside(law, element->wrench);
        element_pose(law, rod->contracted + segment->law_of[k] * rod->contracted_stride, element->wrench,
                     rod->products + k * rod->products_stride, element->pose, element->by_wrench);
        advance(element, end->place, end->rotation);
        if (k) carry_change(wrench, element, &moved, 1, carried);
        yield_to(element, k ? carried : units, change);
        move_on(element, change, &moved);
    }
    seen_from_clamp(end->place, &moved, seen);
    for (int i = 0; i < W; i++) memcpy(end->by_wrench[i], seen + i, sizeof end->by_wrench[i]);
}

void rod_by_tensions(const rod_state *rod, double (*by_tensions)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    const double *wrench = rod->elements[0].wrench;
    rod_motion moved = {{{0.0}}, {{0.0}}};
    eight seen[W];
    double end[3], own[TENSIONS_MOST * POSE];
    for (int k = 0; k < segment->elements; k++) {
        const rod_element *element = rod->elements + k;
        eight carried[W], change[W] = {{0.0}};
        element_by_tensions(segment, law_of(rod, k), rod->contracted + segment->law_of[k] * rod->contracted_stride,
                            rod->products + k * rod->products_stride, own);
        for (int j = 0; j < segment->tensions; j++)
            for (int o = 0; o < W; o++) change[o] += own[POSE * j + o] * units[j];
        if (k) carry_change(wrench, element, &moved, 0, carried);
        if (k) yield_to(element, carried, change);
        move_on(element, change, &moved);
        for (int i = 0; i < 3; i++) end[i] = element->place[i] + element->arm[i];
    }
    seen_from_clamp(end, &moved, seen);
    memcpy(by_tensions, seen, sizeof seen);
}

void rod_free_motion(const rod_state *rod, int section, rod_motion *moved)
{
    const fingerfem_segment *segment = rod->segment;
    memset(moved, 0, sizeof *moved);
    for (int k = 0; k < section; k++) {
        const double *free = rod->free + segment->law_of[k] * rod->free_stride;
        eight change[W] = {{0.0}};
        for (int j = 0; j < segment->tensions; j++)
            for (int o = 0; o < W; o++) change[o] += free[POSE * (1 + j) + o] * units[j];
        move_on(rod->elements + k, change, moved);
    }
}

void rod_free(const rod_state *rod, rod_end *end, double (*by_tensions)[TENSIONS_MOST])
{
    const fingerfem_segment *segment = rod->segment;
    rod_motion moved;
    eight seen[W];
    end->inside = 1; /* every box is as wide to both sides of no wrench */
    memset(end->by_wrench, 0, sizeof end->by_wrench);
    memcpy(end->place, plate_place, sizeof end->place);
    memcpy(end->rotation, plate_rotation, sizeof end->rotation);
    for (int k = 0; k < segment->laws; k++)
        element_free(segment, segment->law[k], rod->monomials, rod->free + k * rod->free_stride);
    for (int k = 0; k < segment->elements; k++) {
        rod_element *element = rod->elements + k;
        memcpy(element->place, end->place, sizeof element->place);
        memcpy(element->rotation, end->rotation, sizeof element->rotation);
        memcpy(element->pose, rod->free + segment->law_of[k] * rod->free_stride, sizeof element->pose);
        advance(element, end->place, end->rotation);
    }
    rod_free_motion(rod, segment->elements, &moved);
    seen_from_clamp(end->place, &moved, seen);
    memcpy(by_tensions, seen, sizeof seen);
}

int fingerfem_place(const fingerfem_segment *segment, const double *tensions, const double *wrench, double *memory,
                    double *centre, double *rotation, double *motion)
{
    const int t = segment->tensions, columns = t + W;
    double held[TENSIONS_MOST], by_tensions[W][TENSIONS_MOST];
    rod_state rod;
    rod_end end;
    const int within = tensions_all_held(segment, tensions, held);
    rod_pull(segment, held, memory, memory + rod_memory(segment), &rod);
    rod_contract(&rod);
    rod_under(&rod, wrench, &end);
    rod_by_tensions(&rod, by_tensions);
    for (int i = 0; i < 3; i++) {
        centre[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            rotation[3 * i + j] = end.rotation[3 * j + i];
            centre[i] -= end.rotation[3 * j + i] * end.place[j];
        }
    }
    for (int i = 0; i < W; i++) {
        for (int j = 0; j < t; j++) motion[columns * i + j] = held[j] == tensions[j] ? by_tensions[i][j] : 0.0;
        memcpy(motion + columns * i + t, end.by_wrench[i], sizeof end.by_wrench[i]);
    }
    return within && end.inside;
}

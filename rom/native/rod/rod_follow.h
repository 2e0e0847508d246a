/* Propagation of changes along a rod, see rod_march.c: rows of numbers, one for every input, in parts. */
#ifndef FINGERFEM_ROD_FOLLOW_H
#define FINGERFEM_ROD_FOLLOW_H
#include "rod_march.h"

/* Motion and rotation of a section by a part of the inputs, in the plate's frame. */
typedef struct {
    wide move[3], turn[3];
} follow_motion;

/* The motion of an element's proximal section, from that of its distal one and from changes of its pose, (6). */
static inline void follow_move(const rod_element *element, const wide *change, follow_motion *moved)
{
    const double *a = element->arm;
    wide turn[3];
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

/* The proximal section of an element, p' = p + Q q and Q' = Q R; and G = s Q (1 + [g]x), so that b' = b + G dg. */
static inline void follow_advance(rod_element *element, double *place, double *rotation)
{
    const double *Q = element->rotation, *q = element->pose, *g = element->pose + 3;
    const double s = 2.0 / (1.0 + g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    double next[9];
    /* row i of Q q, of G = s (Q + Q [g]x), and of Q' = s (Q + Q [g]x + Q g g^T) - Q */
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

/* Distal section of an element: the body itself for k = 0, else where the element before ends. */
static inline void follow_begin(rod_element *element, int k, rod_end *end)
{
    static const double place[3] = {0.0}, rotation[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    memcpy(element->place, k ? end->place : place, sizeof place);
    memcpy(element->rotation, k ? end->rotation : rotation, sizeof rotation);
}

/* A part of the row of an input that changes itself. */
static inline wide follow_unit(int input, int part)
{
    static const double units[FINGERFEM_POSE][FINGERFEM_POSE] = {
        {1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 1.0},
        {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
    };
    return wide_load(units[input] + part);
}

static inline void follow_cross(const double *a, const double *b, double *found)
{
    found[0] = a[1] * b[2] - a[2] * b[1];
    found[1] = a[2] * b[0] - a[0] * b[2];
    found[2] = a[0] * b[1] - a[1] * b[0];
}

/* The moment of the plate's wrench about a section's centre, in the plate's frame. */
static inline void follow_moment(const double *place, const double *wrench, double *moment)
{
    follow_cross(place, wrench, moment);
    for (int i = 0; i < 3; i++) moment[i] = wrench[3 + i] - moment[i];
}

/* How that changes as the section moves, (6), and, where the inputs are the wrench's components, with these, of which it is
 * a part. */
__attribute__((always_inline)) static inline void follow_carry(const double *wrench, const rod_element *element,
                                                               const follow_motion *moved, int by_wrench, int part, wide *change)
{
    const double *Q = element->rotation, *f = wrench, *p = element->place;
    const wide *dp = moved->move, *b = moved->turn;
    wide force[3], moment[3];
    double m[3];
    follow_moment(p, wrench, m);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        force[i] = b[l] * f[j] - b[j] * f[l];
        moment[i] = (dp[l] * f[j] - dp[j] * f[l]) + (b[l] * m[j] - b[j] * m[l]);
        if (!by_wrench) continue;
        force[i] += follow_unit(i, part);
        moment[i] += follow_unit(3 + i, part) - (p[j] * follow_unit(l, part) - p[l] * follow_unit(j, part));
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        change[i] = Q[i] * force[0] + Q[3 + i] * force[1] + Q[6 + i] * force[2];
        change[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

/* Add the change of an element's pose, (6), with the wrench that it carries. */
static inline void follow_by_wrench(const rod_element *element, const wide *wrench, wide *change)
{
#pragma GCC unroll 6
    for (int i = 0; i < ROD_WRENCH; i++)
#pragma GCC unroll 6
        for (int o = 0; o < ROD_WRENCH; o++) change[o] += element->by_wrench[FINGERFEM_POSE * i + o] * wrench[i];
}

/* A part of the motion of the plate seen from the clamp, in its own frame, (6, 8), by that of the clamp seen from the plate. */
static inline void follow_from_clamp(const double *place, const follow_motion *clamp, double *found)
{
    const wide *b = clamp->turn;
    const double *p = place;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        wide_store(found + FINGERFEM_POSE * i, b[j] * p[l] - b[l] * p[j] - clamp->move[i]);
        wide_store(found + FINGERFEM_POSE * (3 + i), -b[i]);
    }
}

/* A part of an element's changes by the tensions, (6), from those of its pose by every one, (tensions, 8). */
static inline void follow_by_inputs(int tensions, const double *by_tensions, int part, wide *change)
{
    for (int j = part; j < tensions && j < part + WIDE; j++)
#pragma GCC unroll 6
        for (int o = 0; o < ROD_WRENCH; o++) change[o] += by_tensions[FINGERFEM_POSE * j + o] * follow_unit(j, part);
}

/* The motion of an element's proximal section by some inputs that change its pose, (count, 8), under a wrench. */
__attribute__((always_inline)) static inline void follow_changes(const rod_element *element, const double *wrench, int count,
                                                                 const double *changes, follow_motion *moved)
{
    for (int part = 0; WIDE * part < count; part++) {
        wide carried[ROD_WRENCH], change[ROD_WRENCH] = {{0.0}};
        follow_by_inputs(count, changes, WIDE * part, change);
        follow_carry(wrench, element, moved + part, 0, 0, carried);
        follow_by_wrench(element, carried, change);
        follow_move(element, change, moved + part);
    }
}

/* End of a part, seen from its body, (3). */
static inline void follow_clamp(const rod_state *rod, rod_part part, double *end)
{
    const rod_element *last = rod->elements + part.last - 1;
    for (int i = 0; i < 3; i++) end[i] = last->place[i] + last->arm[i];
}
#endif

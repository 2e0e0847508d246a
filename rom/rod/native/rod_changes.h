/* How changes of a segment's inputs go on from section to section, see rod_march.c: rows of numbers, one for every input, in
 * parts. */
#ifndef FINGERFEM_ROD_CHANGES_H
#define FINGERFEM_ROD_CHANGES_H
#include "rod_march.h"

/* How a section moves and turns with a part of the inputs, in the plate's frame. */
typedef struct {
    wide move[3], turn[3];
} rod_moved;

/* The motion of an element's proximal section, from that of its distal one and from changes of its pose, (6). */
static inline void rod_move_on(const rod_element *element, const wide *change, rod_moved *moved)
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

/* A part of the row of an input that changes itself. */
static inline wide rod_unit(int input, int part)
{
    static const double units[ROD_POSE][ROD_POSE] = {
        {1.0}, {0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 1.0},
        {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
    };
    return wide_load(units[input] + part);
}

static inline void rod_cross(const double *a, const double *b, double *found)
{
    found[0] = a[1] * b[2] - a[2] * b[1];
    found[1] = a[2] * b[0] - a[0] * b[2];
    found[2] = a[0] * b[1] - a[1] * b[0];
}

/* The moment of the plate's wrench about a section's centre, in the plate's frame. */
static inline void rod_moment_at(const double *place, const double *wrench, double *moment)
{
    rod_cross(place, wrench, moment);
    for (int i = 0; i < 3; i++) moment[i] = wrench[3 + i] - moment[i];
}

/* How that changes as the section moves, (6), and, where the inputs are the wrench's components, with these, of which it is
 * a part. */
__attribute__((always_inline)) static inline void rod_carry_change(const double *wrench, const rod_element *element,
                                                               const rod_moved *moved, int by_wrench, int part, wide *change)
{
    const double *Q = element->rotation, *f = wrench, *p = element->place;
    const wide *dp = moved->move, *b = moved->turn;
    wide force[3], moment[3];
    double m[3];
    rod_moment_at(p, wrench, m);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        force[i] = b[l] * f[j] - b[j] * f[l];
        moment[i] = (dp[l] * f[j] - dp[j] * f[l]) + (b[l] * m[j] - b[j] * m[l]);
        if (!by_wrench) continue;
        force[i] += rod_unit(i, part);
        moment[i] += rod_unit(3 + i, part) - (p[j] * rod_unit(l, part) - p[l] * rod_unit(j, part));
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        change[i] = Q[i] * force[0] + Q[3 + i] * force[1] + Q[6 + i] * force[2];
        change[3 + i] = Q[i] * moment[0] + Q[3 + i] * moment[1] + Q[6 + i] * moment[2];
    }
}

/* Add the change of an element's pose, (6), with the wrench that it carries. */
static inline void rod_add_by_wrench(const rod_element *element, const wide *wrench, wide *change)
{
#pragma GCC unroll 6
    for (int i = 0; i < ROD_WRENCH; i++)
#pragma GCC unroll 6
        for (int o = 0; o < ROD_WRENCH; o++) change[o] += element->by_wrench[ROD_POSE * i + o] * wrench[i];
}

/* A part of an element's changes by the tensions, (6), from those of its pose by every one, (tensions, 8). */
static inline void rod_add_by_tensions(int tensions, const double *by_tensions, int part, wide *change)
{
    for (int j = part; j < tensions && j < part + WIDE; j++)
#pragma GCC unroll 6
        for (int o = 0; o < ROD_WRENCH; o++) change[o] += by_tensions[ROD_POSE * j + o] * rod_unit(j, part);
}
#endif

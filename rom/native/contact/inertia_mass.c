/* The mass matrix of all bodies, and the turns between them. With the mass of elements accelerations of bodies next to each other come
 * in, see rom/rod/motion/lumps.py. */
#include "inertia.h"

#define LITTLE 1e-8 /* sine of an angle below which its axis is not divided by it [-] */

/* The rotation vector of R_0^T R, (3) [rad]: less than half a turn. */
void inertia_turn_between(const double *from, const double *to, double *found)
{
    double rotation[9], sine = 0.0, trace = -1.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = from[i] * to[j] + from[3 + i] * to[3 + j] + from[6 + i] * to[6 + j];
    /* 2 sin(phi) along the axis, 2 cos(phi) = trace - 1 */
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        found[i] = 0.5 * (rotation[3 * k + j] - rotation[3 * j + k]);
        sine += found[i] * found[i];
        trace += rotation[4 * i];
    }
    sine = sqrt(sine);
    const double factor = sine > LITTLE ? atan2(sine, 0.5 * trace) / sine : 1.0;
    for (int i = 0; i < 3; i++) found[i] *= factor;
}

/* The rotation matrix of a rotation vector, (3) [rad]: 1 + sin(phi) / phi [v]x + (1 - cos(phi)) / phi^2 [v]x^2. */
static void rotation_of(const double *v, double *found)
{
    const double angle = sqrt(objects_dot(v, v));
    const double one = angle > LITTLE ? sin(angle) / angle : 1.0, two = angle > LITTLE ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) found[3 * i + j] = two * v[i] * v[j] + (i == j ? 1.0 - two * angle * angle : 0.0);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        found[3 * i + j] -= one * v[k];
        found[3 * j + i] += one * v[k];
    }
}

void inertia_turn(const double *turn, double *rotation)
{
    double change[9], before[9];
    memcpy(before, rotation, sizeof before);
    rotation_of(turn, change);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rotation[3 * i + j] = before[3 * i] * change[j] + before[3 * i + 1] * change[3 + j] + before[3 * i + 2] * change[6 + j];
}

/* Add Q^T K P of a block K of an element's mass, one of (12, 12), to the block of bodies a, b: Q and P turn their frames into that
 * between both. */
static void add_block(const double *K, int first, int second, const double *Q, const double *P, int a, int b, chain_matrix mass)
{
    for (int r = 0; r < W; r += 3)
        for (int c = 0; c < W; c += 3) {
            double half[9];
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                const double *own = K + 2 * W * (first + r + i) + second + c;
#pragma GCC unroll 3
                for (int j = 0; j < 3; j++) half[3 * i + j] = own[0] * P[j] + own[1] * P[3 + j] + own[2] * P[6 + j];
            }
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++)
#pragma GCC unroll 3
                for (int j = 0; j < 3; j++)
                    mass[W * a + r + i][W * b + c + j] += Q[i] * half[j] + Q[3 + i] * half[3 + j] + Q[6 + i] * half[6 + j];
        }
}

void inertia_middle(const chain_body *before, const chain_body *body, double *found)
{
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double turn[3];
    inertia_turn_between(before ? before->rotation : upright, body->rotation, turn);
    for (int i = 0; i < 3; i++) turn[i] *= 0.5;
    rotation_of(turn, found);
}

void inertia_mass(const contact_problem *problem, const chain_state *state, chain_matrix mass)
{
    const fingerfem_inertia *inertia = problem->step->inertia;
    const int size = contact_size(problem);
    for (int i = 0; i < size; i++) memset(mass[i], 0, (size_t)size * sizeof **mass);
    for (int b = 0; b < problem->map->count; b++) {
        double (*rows)[CHAIN_WRENCH] = mass + W * b;
        /* the ground does not move */
        for (int i = 0; i < W && problem->map->bodies[b].segment == CHAIN_GROUND; i++) rows[i][W * b + i] = 1.0;
        if (problem->map->bodies[b].segment == CHAIN_GROUND) continue;
        /* lumps: (m, -s x; s x, J) */
        const int load = chain_load_of(problem->map, b), before = b && problem->map->bodies[b - 1].segment != CHAIN_GROUND;
        const double *s = inertia->moments + 3 * load, *J = inertia->inertias + 9 * load, *K = inertia->elements + 4 * W * W * load;
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            rows[i][W * b + i] += inertia->masses[load];
            rows[i][W * b + 3 + j] += s[k];
            rows[i][W * b + 3 + k] -= s[j];
            rows[3 + i][W * b + j] -= s[k];
            rows[3 + i][W * b + k] += s[j];
            for (int l = 0; l < 3; l++) rows[3 + i][W * b + 3 + l] += J[3 * i + l];
        }
        /* the element towards the clamp, in the frame between both its sections */
        double to_middle[9], from_middle[9];
        inertia_middle(b ? state->bodies + b - 1 : NULL, state->bodies + b, to_middle);
        for (int i = 0; i < 9; i++) from_middle[i] = to_middle[3 * (i % 3) + i / 3];
        add_block(K, 0, 0, to_middle, to_middle, b, b, mass);
        if (!before) continue;
        add_block(K, 0, W, to_middle, from_middle, b, b - 1, mass);
        add_block(K, W, 0, from_middle, to_middle, b - 1, b, mass);
        add_block(K, W, W, from_middle, from_middle, b - 1, b - 1, mass);
    }
}

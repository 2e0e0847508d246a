/* The rubber of one segment in a MuJoCo model: what a rod's inertia and weight have between the bodies at both ends. */
#ifndef CONTROL_ROD_INERTIA_H
#define CONTROL_ROD_INERTIA_H
#include <stdint.h>

/* A rod between the clamp's body and a plate, and the arrays of MuJoCo's mjModel and mjData that it reads and changes.
 * The path has the velocities that move the plate, from the root; the last ones are those of the plate's own joints. */
typedef struct {
    int32_t n, own;                    /* velocities on the path, and how many of them are the plate's own */
    int32_t clamp, plate, root;        /* bodies: the parent of the plate, the plate, and the root of their tree */
    double mass, length;               /* [kg, m] */
    double begin, end;                 /* of the rod on the x axes of clamp and plate [m] */
    const int32_t *path, *rows;        /* (n): the velocities, and where their rows begin in M */
    const double *xpos, *xmat, *subtree_com, *cvel, *cdof, *cdof_dot, *qvel;
    double *M, *qfrc_bias;
    double *memory;                    /* (12 n) */
} control_rod;

/* Add the coupling of both ends to M and qfrc_bias, with gravity (3) [m/s^2]. Positions and velocities must be current. */
void control_couple(const control_rod *rod, const double *gravity);
#endif

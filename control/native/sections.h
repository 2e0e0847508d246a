/* Rubber and tendons of a finger in a MuJoCo model: an element between every section and the one that holds it. */
#ifndef CONTROL_SECTIONS_H
#define CONTROL_SECTIONS_H
#include "../../rom/native/segment.h"

/* Numbers of the joints of a section: coordinates, and the lower triangle of its block, (6, 6), of the inertia. */
enum { CONTROL_COORDINATES = 7, CONTROL_TRIANGLE = 21 };

/* A finger's elements from clamp to tip, and the arrays of MuJoCo's mjData that are read and changed. The joints of a
 * section are three slides along the axes of the section before, and a ball. */
typedef struct {
    int32_t n, clamp;                         /* number of sections; index of the clamp's body */
    const fingerfem_chain *chain;             /* the whole finger */
    const fingerfem_segment *const *elements; /* (n): segments of one element each */
    const int32_t *pulled;                    /* (n, FINGERFEM_MOST_TENSIONS): which of the finger's tensions are an element's */
    const int32_t *positions, *velocities;    /* (n): where a section's coordinates and velocities begin */
    const int32_t *bodies, *geoms;            /* (n): of the sections; their first geoms */
    const int32_t *inertia;                   /* (n, CONTROL_TRIANGLE): places in M, row by row */
    const double *offsets;                    /* (n, 3): of each section from where its element begins, undeformed [m] */
    double relaxation;                        /* [s] */
    const double *loads;                      /* tensions [N] and pressures [Pa] of the finger */
    const double *qpos, *qvel;
    double *qfrc_applied, *M;
    double *held;      /* (n, CONTROL_COORDINATES): coordinates at which the element's law had an inverse last */
    double *wrenches;  /* (n, 6): what held the section there, in its frame [N, N m] */
    double *forces;    /* (n, 6): the same along its joints */
    double *stiffness; /* (n, 6, 6) there */
    double *trained;   /* (n, 3): slides at which it was last within its trained domain [m] */
    double *places, *rotations; /* (n, 3), (n, 3, 3): in the clamp's axes, when contacts were found last [m, -] */
    double *memory;             /* of the largest size for elements and the chain */
} control_sections;

/* Set the forces of a finger at its loads, and add what a linearly implicit step of length h [s] adds to the inertia:
 *
 *     qfrc_applied = -(f + (D + h K) v),    M += h D + h^2 K,    D = relaxation K.
 *
 * Where an element has no such pose its force is linear about its last one. Marks, (n, 2): whether an element is within its
 * trained domain, and whether it has such a pose.
 * Returns 1 if all are and have, else 0. */
int control_pull(const control_sections *sections, double h, int32_t *marks);
#endif

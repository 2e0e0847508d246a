/* Contacts and constraints in a MuJoCo model, for fingers' contacts and friction. */
#ifndef CONTROL_ENGINE_H
#define CONTROL_ENGINE_H
#include <stddef.h>
#include "../../rom/native/segment.h"

/* Arrays of mjData, by its names. Those of mjContact point to the first contact's; the next one's is `stride` bytes further. */
typedef struct {
    int32_t nv, ncon, stride, unused; /* pointers follow */
    const double *qvel, *qacc, *xpos, *xmat, *geom_xpos, *geom_xmat;
    double *dist, *pos, *frame, *includemargin, *friction, *mu;
    int32_t *dim, *geom, *geom1, *geom2, *exclude, *efc_address;
    double *efc_J, *efc_R, *efc_D, *efc_aref, *efc_vel, *efc_force;
    const int32_t *efc_J_rownnz, *efc_J_rowadr, *efc_J_colind; /* NULL where the Jacobian is dense */
} control_engine;

/* A field of contact k, as a pointer to anything. */
#define CONTROL_CONTACT(engine, field, k) ((void *)((char *)(engine)->field + (ptrdiff_t)(k) * (engine)->stride))

/* A row of the Jacobian of constraints times a vector, (nv). */
double control_engine_along(const control_engine *engine, int row, const double *vector);
#endif

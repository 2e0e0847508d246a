/* Contacts of fingers' rubber in a MuJoCo model, see control/mujoco/contact/rubber_contacts.py. */
#ifndef CONTROL_RUBBER_CONTACTS_H
#define CONTROL_RUBBER_CONTACTS_H
#include "engine.h"
#include "sections.h"

/* A geom near a finger's rubber, and its contacts there. */
typedef struct {
    const control_sections *sections;
    int32_t finger, geom;
    fingerfem_object *object;                /* in the clamp's axes */
    double *vertices, *along, *normals;      /* the object's, if it is a hull */
    const double *own;                       /* (corners + edges + faces, 3): these in the geom's axes, in this order */
    fingerfem_engine_contacts *found;
    int32_t chosen[FINGERFEM_MOST_CONTACTS]; /* (count): those that take part */
    int32_t count, first;                    /* first: index of the first of these among all contacts of the model */
    int32_t like, axes;                      /* index of a contact of both blocks; 1 without friction, else 3 */
    double sign;                             /* 1 where MuJoCo's normal points to the finger, else -1 */
    double depth;                            /* largest one in the blocks [m] */
    int32_t is_buried, unused;               /* it is deep in the blocks, and has no contact */
} control_near;

/* All fingers' rubber before all geoms. */
typedef struct {
    int32_t fingers, geoms;
    const int32_t *finger_of; /* (geoms): finger of a block of rubber, else -1 */
    const uint8_t *is_object; /* (geoms): whether a geom can have contact with rubber */
    control_near **near;      /* (fingers, geoms): NULL until blocks have contact */
    control_near **met;       /* (fingers, geoms): those in this step, of which there are `count` */
    int32_t count, unused;
} control_rubbers;

/* Exclude contacts of rubber's blocks, and forget contacts of rubber with geoms that met none. Returns -1, or the index of a
 * pair that is missing in `near`: call it again with this pair. */
int control_rubber_meet(const control_engine *engine, control_rubbers *all);

/* Find the contacts of a finger with a geom. */
void control_rubber_find(const control_engine *engine, control_near *near);

/* Write contacts into MuJoCo's, which are copies of the one of both blocks. */
void control_rubber_place(const control_engine *engine, control_near *near);

/* Set the constraints of contacts at a step h [s]: the Jacobian, so that both sections of an element share forces as in the rod;
 * the regularisation; and the reference acceleration. */
void control_rubber_constrain(const control_engine *engine, const control_near *near, double h);

/* Note forces, about which the contacts of the next step are linearised. */
void control_rubber_note(const control_engine *engine, const control_near *near);
#endif

/* Where rigid objects may touch a plate: points of the plate, each with its gap, and the wrench that a unit force there
 * puts on the plate, in the plate's own frame. */
#ifndef FINGERFEM_OBJECTS_H
#define FINGERFEM_OBJECTS_H
#include "segment.h"

typedef struct {
    int count;
    int names[FINGERFEM_MOST_CONTACTS];     /* of the points, the same wherever the plate is */
    double gaps[FINGERFEM_MOST_CONTACTS];   /* [m], negative inside the object */
    double wrenches[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH]; /* n and p x n, of a unit force along the normal n */
    double changes[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH][FINGERFEM_WRENCH]; /* of these, by the plate's motion */
} objects_contacts;

/* The contacts of an object moved by d [m] with a plate whose centre, (3) [m], and rotation, (3, 3), are given; those
 * with the least gaps if there are more. */
void objects_find(const fingerfem_object *object, const double *half_lengths, double d, const double *centre,
                  const double *rotation, objects_contacts *found);
#endif

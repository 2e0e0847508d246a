/* A plate whose section has an outline. */
#ifndef FINGERFEM_PLATE_AROUND_H
#define FINGERFEM_PLATE_AROUND_H
#include "contact.h"

/* Add the contacts of an object at d with such a plate, as `objects_find` does of a box. */
void plate_find_around(const fingerfem_segment *segment, const fingerfem_object *object, double d, int number, const chain_body *body,
                       objects_contacts *all);
#endif

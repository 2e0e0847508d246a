/* Where rigid objects may touch a plate: points of the plate, each with its gap, and the wrench that a unit force there
 * puts on the plate, in the plate's own frame. */
#ifndef FINGERFEM_OBJECTS_H
#define FINGERFEM_OBJECTS_H
#include "segment.h"

/* Contacts that may be: of an object which the plate sees at s [m], with its axis a. */
typedef struct {
    int count;
    double s[3], a[3], half_lengths[3];
    int names[FINGERFEM_MOST_CONTACTS];                         /* of the points, the same wherever the plate is */
    double gaps[FINGERFEM_MOST_CONTACTS];                       /* [m], negative inside the object */
    double points[FINGERFEM_MOST_CONTACTS][3];                  /* p [m] */
    double wrenches[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH]; /* n and p x n, of a unit force along the normal n */
} objects_contacts;

/* The contacts of an object moved by d [m] with a plate whose centre, (3) [m], and rotation, (3, 3), are given; those
 * with the least gaps if there are more. */
void objects_find(const fingerfem_object *object, const double *half_lengths, double d, const double *centre,
                  const double *rotation, objects_contacts *found);

/* How the wrench of contact k changes as the plate moves by v, t: (6, 6). */
void objects_change(const fingerfem_object *object, const objects_contacts *contacts, int k,
                    double (*change)[FINGERFEM_WRENCH]);
/* Distance of a point of space, (3) [m], from an object moved by d [m]; negative inside. */
double objects_distance(const fingerfem_object *object, double d, const double *place);
#endif

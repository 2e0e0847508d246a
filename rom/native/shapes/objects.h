/* Possible contacts of rigid objects with a plate: points of the plate, each with its gap, and the wrench that a unit force there
 * puts on the plate, in the plate's own frame. */
#ifndef FINGERFEM_OBJECTS_H
#define FINGERFEM_OBJECTS_H
#include "objects_contacts.h"

/* Add the contacts of an object moved by d [m] with a plate whose centre, (3) [m], and rotation, (3, 3), are given. Those
 * with the least gaps are kept if there are too many. */
void objects_find(const fingerfem_object *object, const double *half_lengths, double d, int plate, const double *centre,
                  const double *rotation, objects_contacts *found);

/* The feature of an object at d that is nearest to a point p of a plate, and the normal n there, out of the object, as the plate sees
 * them. Returns the gap [m]. */
double objects_feature_at(const fingerfem_object *object, double d, const double *centre, const double *rotation, const double *p,
                          objects_feature *feature, double *n);

/* Change of the normal n as the point before a feature, at a distance [m] from it, moves by v, (3). */
void objects_normal_change(const objects_feature *feature, double distance, const double *n, const double *v, double *found);

/* n . dt/dl of the tangent t along an outline: with the curvature, and the normal n out of an object [1/m]. */
static inline double objects_border_bend(const border_point *border, const double *n)
{
    return border->bend * (n[2] * border->tangent[0] - n[1] * border->tangent[1]);
}

/* Derivatives of the wrench of contact k by motions of the plate, v, t: (6, 6). */
void objects_change(const fingerfem_object *object, const objects_contacts *contacts, int k,
                    double (*change)[FINGERFEM_WRENCH]);

/* Changes of p and n at contact k as the plate moves by the m-th of v, t. */
void objects_change_with(const fingerfem_object *object, const objects_contacts *contacts, int k, int m, double *dp,
                         double *dn);

/* Distance of a point of space, (3) [m], from an object moved by d [m]; negative inside. With the normal there, out of the
 * object, (3). */
double objects_distance(const fingerfem_object *object, double d, const double *place, double *normal);

/* The largest d [m] at which an object is as near to a point of space, (3) [m], as `margin` [m], if that is above `least`; else
 * `least`. */
double objects_reach(const fingerfem_object *object, const double *place, double margin, double least);

#endif

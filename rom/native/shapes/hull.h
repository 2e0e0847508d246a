/* Convex hulls of points, rounded by a radius: boxes, and convex meshes. */
#ifndef FINGERFEM_HULL_H
#define FINGERFEM_HULL_H
#include "objects_contacts.h"

/* The contacts of a hull that stands at `place`, (3) [m], from the plate's centre, along the axes of space. */
void hull_find(const fingerfem_object *object, const double *place, const double *rotation, objects_contacts *found);

/* The feature of a hull, at the same place, that is nearest to a point p of the plate, and the unit vector n from there to the point, all
 * as the plate sees it. Returns the distance of the point from the rounded hull [m]. */
double hull_feature(const fingerfem_object *object, const double *place, const double *rotation, const double *p, objects_feature *feature,
                    double *n);

/* Distance of a point, (3) [m], given from the hull's place; negative inside. With the normal there, (3). */
double hull_distance(const fingerfem_object *object, const double *point, double *normal);
#endif

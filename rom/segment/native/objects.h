/* Where rigid objects may touch a plate: points of the plate, each with its gap, and the wrench that a unit force there
 * puts on the plate, in the plate's own frame. */
#ifndef FINGERFEM_OBJECTS_H
#define FINGERFEM_OBJECTS_H
#include "segment.h"

/* Names of contacts: the plate's corners, its edges, and from POINTS on what stands out of an object. */
enum { OBJECTS_CORNERS = 8, OBJECTS_POINTS = 20 };

/* The feature of an object that a contact is with, seen from the plate: a face through s with outward normal a, a point s,
 * a line through s along a with a corner of the plate, or with an edge of it. All unit vectors. */
typedef enum { OBJECTS_FACE, OBJECTS_POINT, OBJECTS_LINE, OBJECTS_EDGES } objects_kind;
typedef struct {
    objects_kind kind;
    double s[3], a[3];
    int edge; /* the axis of the plate that its edge is along */
} objects_feature;

/* Contacts that may be. */
typedef struct {
    int count, plate; /* contacts are being found of this plate */
    double half_lengths[3];
    int plates[FINGERFEM_MOST_CONTACTS];                        /* of which plate */
    int names[FINGERFEM_MOST_CONTACTS];                         /* the same wherever the plate is */
    objects_feature features[FINGERFEM_MOST_CONTACTS];
    double gaps[FINGERFEM_MOST_CONTACTS];                       /* [m], negative inside the object */
    double points[FINGERFEM_MOST_CONTACTS][3];                  /* p [m] */
    double wrenches[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH]; /* n and p x n, of a unit force along the normal n */
} objects_contacts;

/* Add the contacts of an object moved by d [m] with a plate whose centre, (3) [m], and rotation, (3, 3), are given. Those
 * with the least gaps are kept if there are too many. */
void objects_find(const fingerfem_object *object, const double *half_lengths, double d, int plate, const double *centre,
                  const double *rotation, objects_contacts *found);

/* How the wrench of contact k changes as the plate moves by v, t: (6, 6). */
void objects_change(const fingerfem_object *object, const objects_contacts *contacts, int k,
                    double (*change)[FINGERFEM_WRENCH]);

/* Distance of a point of space, (3) [m], from an object moved by d [m]; negative inside. */
double objects_distance(const fingerfem_object *object, double d, const double *place);

/* How deep an object may lie in the free plate for its sides to be told apart [m]. */
double objects_shallow(const fingerfem_object *object, const double *half_lengths);

/* For shapes of several features. Note a contact at p with normal n, in place of that with the largest gap if there is no
 * room. */
void objects_note(objects_contacts *all, int name, const objects_feature *feature, double gap, const double *p,
                  const double *n);

/* A rounded point s: the plate's point nearest to it; if it is inside the plate, out through the nearest face. */
void objects_note_point(objects_contacts *all, int name, const double *s, double radius);

double objects_dot(const double *a, const double *b);
void objects_cross(const double *a, const double *b, double *out);

/* R^T v. */
void objects_turned_back(const double *rotation, const double *v, double *out);

void objects_corner(int k, const double *half_lengths, double *p);
#endif

/* Contacts that are being found: points of plates, the features of an object that they are with, and how they are noted. */
#ifndef FINGERFEM_OBJECTS_CONTACTS_H
#define FINGERFEM_OBJECTS_CONTACTS_H
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
    double points[FINGERFEM_MOST_CONTACTS][3];                  /* p, of a plate that is a box [m] */
    double bent[FINGERFEM_MOST_CONTACTS][3];                    /* how far it is off as the plate is none [m] */
    double wrenches[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH]; /* n and (p + bent) x n, of a unit force along the normal n */
} objects_contacts;

/* How deep an object may lie in the free plate for its sides to be told apart [m]. */
double objects_shallow(const fingerfem_object *object, const double *half_lengths);

/* For shapes of several features. Note a contact at p with normal n, in place of that with the largest gap if there is no
 * room. */
void objects_note(objects_contacts *all, int name, const objects_feature *feature, double gap, const double *p,
                  const double *n);

/* Contact j of some in place of contact k of others, but for how far that is off. */
void objects_copy(const objects_contacts *from, int j, objects_contacts *to, int k);

/* A rounded point s: the plate's point nearest to it; if it is inside the plate, out through the nearest face. */
void objects_note_point(objects_contacts *all, int name, const double *s, double radius);

double objects_dot(const double *a, const double *b);
void objects_cross(const double *a, const double *b, double *out);

/* R^T v. */
void objects_turned_back(const double *rotation, const double *v, double *out);

void objects_corner(int k, const double *half_lengths, double *p);
#endif

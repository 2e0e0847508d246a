/* Contacts that are being found: points of plates, the features of an object that they are with, and how they are noted. */
#ifndef FINGERFEM_OBJECTS_CONTACTS_H
#define FINGERFEM_OBJECTS_CONTACTS_H
#include "../segment.h"
#include "indentation.h"
#include "border.h"

#define OBJECTS_COMPLIANCE 1e-9 /* what a contact of a plate yields, for forces that are shared by a stiff plate to be unique [m/N] */

/* Names of contacts: the plate's corners, its edges, and from POINTS on what stands out of an object; of a plate with an outline, from
 * SIDE down, the side between its rims and points of these. */
enum { OBJECTS_CORNERS = 8, OBJECTS_POINTS = 20, OBJECTS_SIDE = -1 };

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
    int count, plate, slice, object; /* contacts are being found of this plate, or slice of rubber, with this object */
    double half_lengths[3];
    int plates[FINGERFEM_MOST_CONTACTS];                        /* of which plate, or slice */
    int objects[FINGERFEM_MOST_CONTACTS];                       /* with which object */
    int slices[FINGERFEM_MOST_CONTACTS];                        /* index of the slice among those that have contacts; -1 for a plate */
    int names[FINGERFEM_MOST_CONTACTS];                         /* the same wherever the plate is */
    double halves[FINGERFEM_MOST_CONTACTS][3];                  /* lengths of that [m] */
    objects_feature features[FINGERFEM_MOST_CONTACTS];
    double gaps[FINGERFEM_MOST_CONTACTS];                       /* [m], negative inside the object */
    double domes[FINGERFEM_MOST_CONTACTS];                      /* what gaps of slices grow by where they are solved for, see SLICE_DOME [m] */
    indentation_profile profiles[FINGERFEM_MOST_CONTACTS];      /* of a slice: how its gap grows away from the point */
    double shares[FINGERFEM_MOST_CONTACTS];                     /* of the slice that is pressed in; 1: all of it, or a plate [-] */
    double lifts[FINGERFEM_MOST_CONTACTS];                      /* what the gap grows by, as the slice is not as near as its closest point [m] */
    double material[FINGERFEM_MOST_CONTACTS][3];                /* of a slice: where p is in it, -1 to 1 [-] */
    border_point borders[FINGERFEM_MOST_CONTACTS];              /* of a point on an outline: where it is around that */
    double compliance[FINGERFEM_MOST_CONTACTS];                       /* what it yields by itself [m/N] */
    double points[FINGERFEM_MOST_CONTACTS][3];                  /* p, of a plate that is a box [m] */
    double bent[FINGERFEM_MOST_CONTACTS][3];                    /* how far it is off as the plate is none [m] */
    double wrenches[FINGERFEM_MOST_CONTACTS][FINGERFEM_WRENCH]; /* n and (p + bent) x n, of a unit force along the normal n */
} objects_contacts;

static inline double objects_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void objects_cross(const double *a, const double *b, double *out)
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* R^T v. */
static inline void objects_turned_back(const double *rotation, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) out[i] = rotation[i] * v[0] + rotation[3 + i] * v[1] + rotation[6 + i] * v[2];
}

/* The gap that is solved for: with the dome, and with what the linearised indentation adds [m]. */
static inline double objects_gap(const objects_contacts *contacts, int k) { return contacts->gaps[k] + contacts->domes[k] + contacts->lifts[k]; }

/* Largest depth of an object in the free plate at which its sides can be distinguished [m]. */
double objects_shallow(const fingerfem_object *object, const double *half_lengths);

/* For shapes of several features. Note a contact at p with normal n, in place of that with the largest gap if there is no
 * room. Returns its index, or -1. */
int objects_note(objects_contacts *all, int name, const objects_feature *feature, double gap, const double *p, const double *n);

/* Add a contact of a slice of rubber, as `objects_note`: where it is, the point and the normal in the slice's axes. Returns its index, or
 * -1 if there is no room. */
int objects_note_rubber(objects_contacts *all, int name, double gap, const double *material, double compliance, double dome,
                        const indentation_profile *profile, const double *p, const double *n);

/* Contact j of some in place of contact k of others, but for how far that is off. */
void objects_copy(const objects_contacts *from, int j, objects_contacts *to, int k);

/* A rounded point s: the plate's point nearest to it; if it is inside the plate, out through the nearest face. */
void objects_note_point(objects_contacts *all, int name, const double *s, double radius);

void objects_corner(int k, const double *half_lengths, double *p);
#endif

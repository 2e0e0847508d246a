/* The rubber of a chain before an object. */
#ifndef FINGERFEM_RUBBER_H
#define FINGERFEM_RUBBER_H
#include "contact.h"

enum { EDGES = OUTLINE_CORNERS };

/* A point of the free finger that an object touches first, in the frame of a plate that carries it: p [m], the wrench of a
 * unit force along the normal there, and how p changes with the tensions, (tensions, 3). */
typedef struct {
    const chain_body *plate;
    double p[3], wrench[W], bends[3 * TENSIONS_MOST];
    double off; /* how well the surface is known there, beside the plates' place [m] */
} touched_point;

/* The largest d [m] at which object j touches the rubber of the free plates, if that is above `least`, with the point;
 * else `least`. Contacts are spoilt. */
double rubber_reach(const contact_problem *problem, int j, placed *free, double least, touched_point *first);

/* Corners of all knots of a segment's rubber, (knots, 4, 3) [m], seen from its plate, where the rod has been placed
 * last, by `rod_under` or, if `free`, by `rod_free`; they lie in the rod's work. */
double *rubber_points(const rod_state *rod, const rod_end *clamp, int free);

/* Half the side of a chain's largest section [m]. */
double rubber_half(const fingerfem_chain *chain);

static inline const fingerfem_outline *rubber_outline(const fingerfem_segment *segment, int element)
{
    return segment->outline[segment->law_of[element]];
}

/* Parts of that: how many knots an element has; the corners of a section without warping, `size` times as large as the
 * plate's, `along` its x axis from a place, and those of an element's knots `first` to `last` - 1,
 * seen from its distal section. */
int rubber_knots(const fingerfem_segment *segment, int element);
void rubber_flat(const fingerfem_segment *segment, double size, double along, const double *place, const double *rotation,
                 double *corners);
void rubber_corners(const rod_state *rod, int element, int free, int first, int last, double *corners);

/* Coefficients of an element's outline at the rod's tensions, contracted at the first call. */
const double *rubber_contracted(const rod_state *rod, int element);

/* Corners of an element's knots where it is pressed, from the monomials of the tensions, or, from their derivatives by one, how
 * they change; there is room for them in the rod's work behind those of all knots. */
void rubber_shape(const rod_state *rod, int element, const double *monomials, double *corners);

/* The element of a segment's knot: -1 for the plate's face, and the number of elements for the clamp's section; `number` is the
 * knot's index in its element. And a point of a section: the sum of its corners, (4, 3), each with a weight. */
int rubber_element_of(const fingerfem_segment *segment, int knot, int *number);
void rubber_point_of(const double *weights, const double *corners, double *found);

/* Motion by the tensions, (tensions, 3), of a point of a free slice at coordinates `at`, in the frame of its plate. */
void rubber_moves(const chain_rods *map, const chain_state *free, const rubber_slice *slice, const double *at, double *found);

/* Error of the surface at contact k of a slice [m]. */
double rubber_off(const contact_problem *problem, const placed *at, int k);

/* Points that a plate sees, (count, 3), in space, where its centre and rotation are; in place. */
void rubber_in_space(const double *centre, const double *rotation, int count, double *points);

/* Corners of the rubber's cross-section at one of its places, from those of the knots. */
void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3]);
#endif

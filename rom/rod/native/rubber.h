/* The rubber of a chain before an object. */
#ifndef FINGERFEM_RUBBER_H
#define FINGERFEM_RUBBER_H
#include "contact.h"

enum { EDGES = OUTLINE_CORNERS };

/* A point of the free finger that an object touches first, in the frame of a plate that carries it: p [m], the wrench of a
 * unit force along the normal there, and how p changes with the tensions, (tensions, 3). */
typedef struct {
    const chain_plate *plate;
    double p[3], wrench[W], bends[3 * TENSIONS_MOST];
} touched_point;

/* The largest d [m] at which the object touches the rubber of the free plates, if that is above `least`, with the point;
 * else `least`. */
double rubber_reach(const contact_problem *problem, const chain_state *free, double least, touched_point *first);

/* Corners of all stations of a segment's rubber, (stations, 4, 3) [m], seen from its plate, where the rod has been placed
 * last, by `rod_under` or, if `free`, by `rod_free`; they lie in the rod's work. */
double *rubber_points(const rod_state *rod, const rod_end *clamp, int free);

/* Points that a plate sees, (count, 3), in space, where its centre and rotation are; in place. */
void rubber_in_space(const double *centre, const double *rotation, int count, double *points);

/* Corners of the rubber's cross-section at one of its places, from those of the stations. */
void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*corners)[3]);
#endif

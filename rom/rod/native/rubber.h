/* The rubber of a chain before an object. */
#ifndef FINGERFEM_RUBBER_H
#define FINGERFEM_RUBBER_H
#include "contact.h"

#define EDGES 4

/* A point of the free finger that an object touches first, in the frame of a plate that carries it: p [m], the wrench of a
 * unit force along the normal there, and how p changes with the tensions, (tensions, 3). */
typedef struct {
    const chain_plate *plate;
    double p[3], wrench[W], bends[3 * TENSIONS_MOST];
} touched_point;

/* The largest d [m] at which the object touches the rubber of the free plates, if that is above `least`, with the point;
 * else `least`. */
double rubber_reach(const contact_problem *problem, const chain_state *free, double least, touched_point *first);

/* Points of the rubber in the plate's frame, (skin_numbers) [m]; `work` is for skin_terms. Coefficients are single, sums
 * double: else the same point would differ by some nanometres from processor to processor. */
void rubber_points(const fingerfem_segment *segment, const double *inputs, double *work, double *found);

/* Corners of the rubber's section at one of the places between its stations, from its points; seen from the plate. */
void rubber_between(const fingerfem_segment *segment, const double *points, int place, double (*seen)[3]);

/* A corner of the section where the first segment's rubber begins. */
void rubber_begin(const fingerfem_chain *chain, int edge, double *corner);
#endif

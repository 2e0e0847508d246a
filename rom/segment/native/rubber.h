/* The rubber of a chain before an object. */
#ifndef FINGERFEM_RUBBER_H
#define FINGERFEM_RUBBER_H
#include "contact.h"

/* A point of the free finger that an object touches first, in the frame of a plate that carries it: p [m], the wrench of a
 * unit force along the normal there, and how p changes with the tensions, (tensions, 3). */
typedef struct {
    const chain_plate *plate;
    double p[3], wrench[W], bends[3 * MAP_MOST_TENSIONS];
} touched_point;

/* The largest d [m] at which the object touches the rubber of the free plates, if that is above `least`, with the point;
 * else `least`. */
double rubber_reach(const contact_problem *problem, const chain_state *free, double least, touched_point *first);
#endif

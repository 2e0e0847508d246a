/* The outline of an element: corners of a few of its cross-sections, its knots, by the tensions and the wrench that its
 * distal section carries, seen from that one's frame. */
#ifndef FINGERFEM_OUTLINE_H
#define FINGERFEM_OUTLINE_H
#include "tensions.h"

enum { OUTLINE_CORNERS = 4, OUTLINE_KNOT = 3 * OUTLINE_CORNERS /* numbers of a knot */ };

/* Numbers of memory for the corners of all knots of a segment, and for an outline's own, its products and its contracted coefficients; and
 * for these alone. */
int outline_work(const fingerfem_segment *segment);
int outline_contracted(const fingerfem_segment *segment);

/* Coefficients of the wrench's products, (products, numbers), from the monomials of the tensions, or, from their derivatives by one, how
 * these change. */
void outline_contract(const fingerfem_outline *outline, const double *monomials, double *contracted);

/* Corners of the knots, (numbers), from contracted coefficients and a wrench, (6), beyond whose trained box they go on linearly; of these at
 * least numbers `first` to `last` - 1. `work` holds the products of the wrench. Coefficients are single, sums double: else the same point
 * would differ by some nanometres from processor to processor. */
void outline_under(const fingerfem_outline *outline, const double *contracted, const double *wrench, int first, int last, double *work,
                   double *corners);

/* The same without a wrench; with the monomials' derivatives by a tension, the derivatives. */
void outline_free(const fingerfem_outline *outline, const double *monomials, double *corners);
#endif

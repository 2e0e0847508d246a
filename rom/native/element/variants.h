/* Variants of the elements of a rod: by how much their poses deviate, which makes the estimated errors of an answer. */
#ifndef FINGERFEM_VARIANTS_H
#define FINGERFEM_VARIANTS_H
#include <stddef.h>
#include "tensions.h"

/* Numbers of memory that deviations of the elements of a segment need to be evaluated in. */
int variants_work(const fingerfem_segment *segment);

/* Deviations of an element's pose, (count, FINGERFEM_POSE), from the monomials of its tensions, under its wrench, (6), or, beyond the
 * trained box, the nearest wrench in it. */
void variants_at(const fingerfem_variants *variants, const double *monomials, const double *wrench, double *work, double *found);

/* The same of a law that several elements share: contracted by the tensions once, then under the wrench of each. `work` is the same for
 * both. */
void variants_contract(const fingerfem_variants *variants, const double *monomials, double *work);
void variants_under(const fingerfem_variants *variants, const double *wrench, double *work, double *found);
#endif

/* Estimated errors of the answers of a touched chain: what the variants of its elements change, by the same response that makes
 * derivatives. */
#ifndef FINGERFEM_TOUCH_ERRORS_H
#define FINGERFEM_TOUCH_ERRORS_H
#include "answer.h"

/* Estimated error of the touch distance of object j, of free plates whose motions by the variants are known. A point of the
 * rubber that touches first counts as the plate's; what is known of the surface there is added. */
double touch_distance_error(const contact_problem *problem, int j, const touched_point *first);

/* Estimated errors of the tip and of every object's force, (1 + count), of plates whose motions by the variants are known;
 * infinite if nothing is known of how they follow. The forces, (count) [N], and the derivatives are those of the answer. */
void report_errors(const contact_problem *problem, const contact_state *state, const double *forces, const double *jacobian,
                   double *errors);
#endif

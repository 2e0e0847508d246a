/* Faces that pressure in a chamber bulges, of which no contact is solved for: what comes near them is not inside. */
#ifndef FINGERFEM_BULGED_H
#define FINGERFEM_BULGED_H
#include "contact.h"

/* Bound of the depth of the faces over chambers in object j at d [m], as the bodies were placed last, free or under wrenches, by
 * tensions within their box; negative if they are away, -infinity without chambers. */
double bulged_depth(const contact_problem *problem, const chain_state *state, int free, int j, double d, const double *tensions);
#endif

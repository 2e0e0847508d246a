/* Reports of a finger besides an answer: the tip's orientation and the tendons' shortenings. */
#ifndef FINGERFEM_REPORTED_H
#define FINGERFEM_REPORTED_H
#include "contact.h"

/* Changes of wrenches on all plates, and of the plates in space, R^T dc and R^T dtheta, by an input, contact included. */
typedef struct {
    double wrench[CHAIN_WRENCH], motion[CHAIN_WRENCH];
} reported_change;

/* Rows and derivatives of a report at a state that has been solved, or, if `free`, of the free finger; `changes`, (tensions +
 * count), by tensions and the objects' d. */
void reported_rows(const contact_problem *problem, const contact_state *state, int free, const reported_change *changes,
                   const fingerfem_report *report);

/* Contacts that press at a solved state: places and normals in space, forces [N]. */
void report_pressing(const placed *at, const double *forces, fingerfem_pressing *found);
#endif

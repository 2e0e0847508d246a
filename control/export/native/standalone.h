/* The controllers without Python: a finger from a model alone, as a page in a browser has it. */
#ifndef CONTROL_STANDALONE_H
#define CONTROL_STANDALONE_H
#include "../../../rom/native/model.h"
#include "../../native/control.h"

/* Nodes of the atlas by tension, and by distance; and numbers of memory that a finger with it needs. */
int control_standalone_nodes(const fingerfem_model *model);
int control_standalone_size(const fingerfem_model *model);

/* Numbers of memory that a hold needs. */
int control_standalone_memory(const fingerfem_model *model);

/* Bytes of a finger, for a page whose language does not see the struct. */
int32_t control_standalone_finger_size(void);

/* A finger that has its atlas in such memory; there must be an obstacle. */
void control_standalone(const fingerfem_model *model, double *memory, control_finger *finger);

/* Hold, see control_hold, with the rules of control.problems.rules: tensions, (tensions), and what came of it, (3): residual
 * [N], estimated error [N], evaluations. Memory is of control_standalone_memory's size. Returns the outcome's
 * status; a distance or a force that cannot be is CONTROL_OUTSIDE, as of control.finger.Finger.hold. */
int control_standalone_hold(const control_finger *finger, const double *start, double target, double distance,
                            double tolerance, double *memory, double *tensions, double *report);
#endif

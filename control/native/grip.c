/* One period of a finger that grips: correct the distance by the measured force, then hold the force there. */
#include "workspace.h"

void control_grip(const control_finger *finger, const double *then, double felt, const double *present, double aim,
                  double distance, double gain, const control_rules *rules, double *memory, double *tensions,
                  control_outcome *outcome)
{
    double *own = memory + control_problem_size(finger, 1), expected = NAN;
    control_problem problem;
    control_problem_in(&problem, finger, 1, memory);
    /* the force expected at the distance so far [N] */
    if (isfinite(distance)) {
        control_ask(&problem, then, distance);
        expected = problem.out[FINGERFEM_FORCE];
    }
    /* contact was felt: correct the distance by a share of the difference */
    if (felt > 0.0) {
        control_locate_problem(&problem, 1, then, &felt, distance, rules, own, outcome);
        const double found = outcome->distance;
        distance = isfinite(distance) ? distance + gain * (found - distance) : found;
    }
    /* hold the force at that distance */
    outcome->status = CONTROL_GOING;
    if (isfinite(distance)) {
        control_hold_problem(&problem, present, aim, distance, rules, outcome);
    }
    outcome->distance = distance;
    outcome->expected = expected;
    control_copy(problem.best, tensions, problem.tensions);
}

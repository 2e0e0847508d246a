/* The FMU of a controller: contact force and distance in; tensions that hold the force out. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "standalone.h"
#include "../../../rom/export/fmu/native/fmu.h"

#define TOLERANCE 1e-6 /* of the contact force, as control.finger.Finger.hold has it [N] */

/* Inputs, of which tensions are those before the first step; and outputs behind the tensions. */
enum { FORCE = 0, DISTANCE = 1, START = 2 };
enum { RESIDUAL = 8, FORCE_ERROR = 9 };

typedef struct {
    control_finger finger;
    double *memory, atlas[]; /* of a solve, which leaves nothing in it */
} controller;

const int32_t fmu_kind = FMU_CONTROLLER;

int fmu_open(void **own)
{
    const int size = control_standalone_size(fmu_model), numbers = size + control_standalone_memory(fmu_model);
    controller *made = malloc(sizeof *made + (size_t)numbers * sizeof *made->atlas);
    if (made) {
        control_standalone(fmu_model, made->atlas, &made->finger);
        made->memory = made->atlas + size;
    }
    *own = made;
    return made != NULL;
}

void fmu_keep(fmu_state *state) { memcpy(state->kept, state->outputs, sizeof state->kept); }

/* The hold begins from the tensions of the last step, and where there is no answer stays there. */
void fmu_answer(void *own, fmu_state *state)
{
    const controller *known = own;
    const control_finger *finger = &known->finger;
    const double force = state->inputs[FORCE], d = state->inputs[DISTANCE];
    const double *before = state->stepped ? state->kept : state->inputs + START;
    const int n = fmu_model->parameters - 1;
    double start[FMU_MOST_INPUTS], report[3] = {DBL_MAX, DBL_MAX, 0.0}, *tensions = state->outputs;
    memset(state->outputs, 0, sizeof state->outputs);
    for (int j = 0; j < n; j++)
        start[j] = before[j] > finger->lower[j] ? fmin(before[j], finger->upper[j]) : finger->lower[j];
    state->status = CONTROL_OUTSIDE;
    if (d >= finger->nearest && d <= finger->farthest && force > 0.0 && isfinite(force))
        state->status = control_standalone_hold(finger, start, force, d, TOLERANCE, known->memory, tensions, report);
    for (int j = 0; j < n; j++)
        if (state->status == CONTROL_OUTSIDE || !isfinite(tensions[j])) tensions[j] = start[j];
    state->flag = state->status == CONTROL_CONVERGED;
    tensions[RESIDUAL] = state->status == CONTROL_OUTSIDE ? DBL_MAX : fmu_finite(report[0], DBL_MAX);
    tensions[FORCE_ERROR] = state->status == CONTROL_OUTSIDE ? DBL_MAX : fmu_finite(report[1], DBL_MAX);
}

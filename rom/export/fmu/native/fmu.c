/* Variables, time and states of an FMU, see fmu.h. */
#include "fmu.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUND_OFF 1e-9 /* of time, by which a last step may end late [-] */

double fmu_finite(double value, double instead)
{
    if (isnan(value)) return instead;
    return fmin(fmax(value, -DBL_MAX), DBL_MAX);
}

void fmu_reset(fmu_instance *fmu)
{
    memset(&fmu->state, 0, sizeof fmu->state);
    memcpy(fmu->state.inputs, fmu_starts, (size_t)fmu_inputs * sizeof *fmu_starts);
    fmu->stop = INFINITY;
}

int fmu_begin(fmu_instance *fmu, const char *token)
{
    if (!token || strcmp(token, fmu_token)) return 0;
    fmu_reset(fmu);
    fmu->own = NULL;
    return fmu_open(&fmu->own);
}

void fmu_end(fmu_instance *fmu) { free(fmu->own); }

int fmu_experiment(fmu_instance *fmu, double start, int has_stop, double stop)
{
    if (fmu->state.phase != FMU_INSTANTIATED || !isfinite(start) || (has_stop && !(stop >= start))) return FMU_ERROR;
    fmu->state.time = start;
    fmu->stop = has_stop ? stop : INFINITY;
    return FMU_OK;
}

/* Phases follow each other. */
int fmu_enter(fmu_instance *fmu, int phase)
{
    if (fmu->state.phase != phase - 1) return FMU_ERROR;
    fmu->state.phase = phase;
    return FMU_OK;
}

static void know(fmu_instance *fmu)
{
    if (!fmu->state.known) fmu_answer(fmu->own, &fmu->state);
    fmu->state.known = 1;
}

/* There is nothing that changes by itself: time passes, and the kind keeps what it needs. */
int fmu_step(fmu_instance *fmu, double from, double step)
{
    fmu_state *state = &fmu->state;
    if (state->phase != FMU_STEPPING || !isfinite(from) || !isfinite(step) || !(step > 0.0)) return FMU_ERROR;
    if (from + step > fmu->stop + ROUND_OFF * fmax(step, fabs(fmu->stop))) return FMU_ERROR;
    know(fmu);
    fmu_keep(state);
    state->stepped = 1;
    state->time = from + step;
    return FMU_OK;
}

/* Where a number is, and which of its kind; NULL if there is none. */
static double *number(fmu_instance *fmu, uint32_t reference)
{
    if (reference == FMU_TIME) return &fmu->state.time;
    if (reference < FMU_INPUTS + (uint32_t)fmu_inputs) return fmu->state.inputs + (reference - FMU_INPUTS);
    if (reference < FMU_OUTPUTS || reference >= FMU_OUTPUTS + FMU_MOST_OUTPUTS) return NULL;
    return fmu->state.outputs + (reference - FMU_OUTPUTS);
}

int fmu_get(fmu_instance *fmu, const uint32_t *references, size_t count, double *values)
{
    for (size_t i = 0; i < count; i++) {
        const double *found = number(fmu, references[i]);
        if (!found) return FMU_ERROR;
        if (references[i] >= FMU_OUTPUTS) know(fmu);
        values[i] = *found;
    }
    return FMU_OK;
}

int fmu_set(fmu_instance *fmu, const uint32_t *references, size_t count, const double *values)
{
    for (size_t i = 0; i < count; i++) {
        double *found = references[i] == FMU_TIME || references[i] >= FMU_OUTPUTS ? NULL : number(fmu, references[i]);
        if (!found) return FMU_ERROR;
        if (*found != values[i]) fmu->state.known = 0; /* also of what is no number */
        *found = values[i];
    }
    return FMU_OK;
}

int fmu_get_flag(fmu_instance *fmu, uint32_t reference, int32_t *value)
{
    if (reference != FMU_FLAG) return FMU_ERROR;
    know(fmu);
    *value = fmu->state.flag;
    return FMU_OK;
}

int fmu_get_status(fmu_instance *fmu, uint32_t reference, int32_t *value)
{
    if (reference != FMU_STATUS) return FMU_ERROR;
    know(fmu);
    *value = fmu->state.status;
    return FMU_OK;
}

int fmu_derivative(fmu_instance *fmu, const uint32_t *unknowns, size_t unknown_count, const uint32_t *knowns,
                   size_t known_count, const double *seed, double *sensitivity)
{
    know(fmu);
    for (size_t i = 0; i < unknown_count; i++) {
        const uint32_t row = unknowns[i] - FMU_OUTPUTS; /* what is less than it becomes large */
        if (row >= FMU_MOST_OUTPUTS) return FMU_ERROR;
        sensitivity[i] = 0.0;
        for (size_t k = 0; k < known_count; k++) {
            const uint32_t column = knowns[k] - FMU_INPUTS;
            if (column >= (uint32_t)fmu_inputs) return FMU_ERROR;
            sensitivity[i] += fmu->state.jacobian[(uint32_t)fmu_inputs * row + column] * seed[k];
        }
        sensitivity[i] = fmu_finite(sensitivity[i], 0.0);
    }
    return FMU_OK;
}

int fmu_read_state(const void *bytes, size_t size, void **state)
{
    if (!bytes || !state || size != sizeof(fmu_state)) return FMU_ERROR;
    if (!*state) *state = malloc(size);
    if (!*state) return FMU_ERROR;
    memcpy(*state, bytes, size);
    return FMU_OK;
}

int fmu_get_state(const fmu_instance *fmu, void **state) { return fmu_read_state(&fmu->state, sizeof fmu->state, state); }

int fmu_set_state(fmu_instance *fmu, const void *state)
{
    if (!state) return FMU_ERROR;
    memcpy(&fmu->state, state, sizeof fmu->state);
    return FMU_OK;
}

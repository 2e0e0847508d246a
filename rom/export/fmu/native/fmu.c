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
    fmu->state.stop = INFINITY;
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
    fmu->state.stop = has_stop ? stop : INFINITY;
    return FMU_OK;
}

/* Phases follow each other. */
int fmu_enter(fmu_instance *fmu, int phase)
{
    if (fmu->state.phase != phase - 1) return FMU_ERROR;
    fmu->state.phase = phase;
    return FMU_OK;
}

static void update_outputs(fmu_instance *fmu)
{
    if (!fmu->state.known) fmu_answer(fmu->own, &fmu->state);
    fmu->state.known = 1;
}

/* There is nothing that changes by itself: time passes, and the kind keeps what it needs. */
int fmu_step(fmu_instance *fmu, double from, double step)
{
    fmu_state *state = &fmu->state;
    if (state->phase != FMU_STEPPING || !isfinite(from) || !isfinite(step) || !(step > 0.0)) return FMU_ERROR;
    if (from + step > state->stop + ROUND_OFF * fmax(step, fabs(state->stop))) return FMU_ERROR;
    update_outputs(fmu);
    fmu_keep(state);
    state->stepped = 1;
    state->time = from + step;
    return FMU_OK;
}

/* Whether a reference is an output of a mask. */
static int is_output(uint32_t reference, uint32_t mask)
{
    const uint32_t row = reference - FMU_OUTPUTS; /* a smaller reference becomes a large number */
    return row < FMU_MOST_OUTPUTS && mask >> row & 1;
}

/* Address of a variable's number; NULL if it is no variable. */
static double *number(fmu_instance *fmu, uint32_t reference)
{
    if (reference == FMU_TIME) return fmu_shows_time ? &fmu->state.time : NULL;
    if (reference < FMU_INPUTS + (uint32_t)fmu_inputs) return fmu->state.inputs + (reference - FMU_INPUTS);
    return is_output(reference, fmu_outputs) ? fmu->state.outputs + (reference - FMU_OUTPUTS) : NULL;
}

int fmu_get(fmu_instance *fmu, const uint32_t *references, size_t count, double *values)
{
    for (size_t i = 0; i < count; i++) {
        const double *found = number(fmu, references[i]);
        if (!found) return FMU_ERROR;
        if (references[i] >= FMU_OUTPUTS) update_outputs(fmu);
        values[i] = *found;
    }
    return FMU_OK;
}

int fmu_set(fmu_instance *fmu, const uint32_t *references, size_t count, const double *values)
{
    const int phase = fmu->state.phase, changing = fmu_inputs - (phase < FMU_STEPPING ? 0 : fmu_parameters);
    for (size_t i = 0; i < count; i++) {
        const uint32_t reference = references[i];
        const int is_input = reference >= FMU_INPUTS && reference < FMU_INPUTS + (uint32_t)changing;
        double *found = is_input && phase < FMU_TERMINATED ? number(fmu, reference) : NULL;
        if (!found) return FMU_ERROR;
        if (*found != values[i]) fmu->state.known = 0; /* also of what is no number */
        *found = values[i];
    }
    return FMU_OK;
}

int fmu_get_flag(fmu_instance *fmu, uint32_t reference, int32_t *value)
{
    if (reference != FMU_FLAG) return FMU_ERROR;
    update_outputs(fmu);
    *value = fmu->state.flag;
    return FMU_OK;
}

int fmu_get_status(fmu_instance *fmu, uint32_t reference, int32_t *value)
{
    if (reference != FMU_STATUS) return FMU_ERROR;
    update_outputs(fmu);
    *value = fmu->state.status;
    return FMU_OK;
}

int fmu_derivative(fmu_instance *fmu, const uint32_t *unknowns, size_t unknown_count, const uint32_t *knowns,
                   size_t known_count, const double *seed, double *sensitivity)
{
    update_outputs(fmu);
    for (size_t i = 0; i < unknown_count; i++) {
        if (!is_output(unknowns[i], fmu_differentiable)) return FMU_ERROR;
        const uint32_t row = unknowns[i] - FMU_OUTPUTS;
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

/* FNV-1a of all but the hash itself: one byte that differs changes it. */
static uint64_t hash_of(const fmu_saved *saved)
{
    uint64_t found = 14695981039346656037ULL;
    const uint8_t *bytes = (const uint8_t *)saved;
    for (size_t i = 0; i < offsetof(fmu_saved, hash); i++) found = (found ^ bytes[i]) * 1099511628211ULL;
    return found;
}

static const char FORMAT[16] = "fingerfem state";

/* Why a state cannot be used here; NULL if it can. */
static const char *refusal(const fmu_saved *saved)
{
    if (memcmp(saved->format, FORMAT, sizeof FORMAT)) return "state must be one of fingerfem";
    if (saved->version != FMU_STATE_VERSION) return "state must be of this version of the format";
    if (saved->kind != fmu_kind) return "state must be of the same kind of FMU, a finger or a controller";
    if (strncmp(saved->token, fmu_token, FMU_TOKEN_SIZE))
        return "state must be of the same FMU: its model hash or version of FMI differs";
    return saved->hash == hash_of(saved) ? NULL : "state must be as it was written, but its hash differs";
}

int fmu_get_state(const fmu_instance *fmu, void **state)
{
    if (!state) return FMU_ERROR;
    if (!*state) *state = calloc(1, sizeof(fmu_saved));
    if (!*state) return FMU_ERROR;
    fmu_saved *saved = *state;
    memset(saved, 0, sizeof *saved);
    memcpy(saved->format, FORMAT, sizeof FORMAT);
    saved->version = FMU_STATE_VERSION;
    saved->kind = fmu_kind;
    strncpy(saved->token, fmu_token, FMU_TOKEN_SIZE - 1);
    memcpy(&saved->state, &fmu->state, sizeof fmu->state);
    saved->hash = hash_of(saved);
    return FMU_OK;
}

const char *fmu_set_state(fmu_instance *fmu, const void *state)
{
    const char *why = state ? refusal(state) : "state must be given";
    if (!why) memcpy(&fmu->state, &((const fmu_saved *)state)->state, sizeof fmu->state);
    return why;
}

const char *fmu_serialise(const void *state, void *bytes, size_t size)
{
    if (!state || !bytes || size != sizeof(fmu_saved)) return "state must have its own size";
    memcpy(bytes, state, size);
    return NULL;
}

const char *fmu_deserialise(const void *bytes, size_t size, void **state)
{
    fmu_saved saved;
    if (!bytes || !state || size != sizeof saved) return "state must have its own size";
    memcpy(&saved, bytes, size); /* bytes may lie anywhere */
    const char *why = refusal(&saved);
    if (why) return why;
    if (!*state) *state = malloc(size);
    if (!*state) return "there is no memory";
    memcpy(*state, &saved, size);
    return NULL;
}

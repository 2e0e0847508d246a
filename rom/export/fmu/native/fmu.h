/* A finger as a Functional Mock-up Unit: what both versions of FMI, and its two kinds, the model and the controller, share.
 *
 * fmu2.c or fmu3.c speaks the standard's language, fmu.c keeps variables and time, fmu_model.c or fmu_controller.c answers,
 * and numbers.c, which is generated, holds the trained model as constants. */
#ifndef FINGERFEM_FMU_H
#define FINGERFEM_FMU_H
#include <stddef.h>
#include <stdint.h>
#include "../../../native/model.h"

#ifdef _WIN32
#define FMU_EXPORT __declspec(dllexport)
#else
#define FMU_EXPORT __attribute__((visibility("default")))
#endif

enum { FMU_MOST_INPUTS = 10, FMU_MOST_OUTPUTS = 24 };

/* Value references: numbers from these on; whether the answer is to be relied on; and the status that says why not. */
enum { FMU_TIME = 0, FMU_INPUTS = 1, FMU_OUTPUTS = 101, FMU_FLAG = 201, FMU_STATUS = 202 };

/* Status that functions of both versions return. */
enum { FMU_OK = 0, FMU_WARNING = 1, FMU_DISCARD = 2, FMU_ERROR = 3 };

enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_STEPPING, FMU_TERMINATED };

/* All that changes. It has no addresses, so that a copy is all there is to keep. */
typedef struct {
    double stop; /* no step may end later [s] */
    double time, inputs[FMU_MOST_INPUTS], outputs[FMU_MOST_OUTPUTS];
    double jacobian[FMU_MOST_OUTPUTS * FMU_MOST_INPUTS]; /* of outputs by inputs, where the kind has derivatives */
    double kept[FMU_MOST_INPUTS];                        /* what a controller keeps from the last step */
    int32_t known, flag, status, phase, stepped;         /* known: the outputs are those of the inputs */
} fmu_state;

/* A state outside of an instance, as it is serialised too: whose it is, and a hash of all that comes before the hash. */
enum { FMU_STATE_VERSION = 2, FMU_TOKEN_SIZE = 40 };
enum { FMU_MODEL = 1, FMU_CONTROLLER = 2 };
typedef struct {
    char format[16];             /* "fingerfem state" */
    int32_t version, kind;       /* FMU_STATE_VERSION; FMU_MODEL or FMU_CONTROLLER */
    char token[FMU_TOKEN_SIZE];  /* hash of the model and of all sources */
    fmu_state state;
    uint64_t hash;
} fmu_saved;

typedef struct {
    fmu_state state;
    void *own; /* of the kind */
} fmu_instance;

/* Generated: the token of this FMU, the number of its inputs and where they start, and the model. The last inputs are
 * parameters, fixed after initialisation. Outputs that are variables, and those with derivatives, are bits of a mask. */
extern const char fmu_token[];
extern const int fmu_inputs, fmu_parameters;
extern const uint32_t fmu_outputs, fmu_differentiable;
extern const double fmu_starts[];
extern const fingerfem_model *const fmu_model;

/* The version of FMI: whether time is a variable. */
extern const int fmu_shows_time;

/* The kind: FMU_MODEL or FMU_CONTROLLER; what an instance needs, 0 if there is no memory for it; outputs, flag, status
 * and derivatives of a state's inputs, all of them finite; and what is kept from a step. */
extern const int32_t fmu_kind;
int fmu_open(void **own);
void fmu_answer(void *own, fmu_state *state);
void fmu_keep(fmu_state *state);

/* A number, or another one instead of what is none; infinity becomes the largest number. */
double fmu_finite(double value, double instead);

/* Begin an instance; returns 0 without memory, or if the token is another FMU's. */
int fmu_begin(fmu_instance *fmu, const char *token);
void fmu_end(fmu_instance *fmu);
void fmu_reset(fmu_instance *fmu);

/* All return FMU_OK or FMU_ERROR. */
int fmu_experiment(fmu_instance *fmu, double start, int has_stop, double stop);
int fmu_enter(fmu_instance *fmu, int phase);
int fmu_step(fmu_instance *fmu, double from, double step);
int fmu_get(fmu_instance *fmu, const uint32_t *references, size_t count, double *values);
int fmu_set(fmu_instance *fmu, const uint32_t *references, size_t count, const double *values);
int fmu_get_flag(fmu_instance *fmu, uint32_t reference, int32_t *value);
int fmu_get_status(fmu_instance *fmu, uint32_t reference, int32_t *value);
int fmu_derivative(fmu_instance *fmu, const uint32_t *unknowns, size_t unknown_count, const uint32_t *knowns,
                   size_t known_count, const double *seed, double *sensitivity);

/* States: made or written to, put back, and freed; or read from bytes. The last three return NULL or why not. */
int fmu_get_state(const fmu_instance *fmu, void **state);
const char *fmu_set_state(fmu_instance *fmu, const void *state);
const char *fmu_serialise(const void *state, void *bytes, size_t size);
const char *fmu_deserialise(const void *bytes, size_t size, void **state);
#endif

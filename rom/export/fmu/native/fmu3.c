/* FMI 3.0 for co-simulation, see fmu.h. Types and functions are those that the standard names. */
#include <stdbool.h>
#include <stdlib.h>
#include "fmu.h"

const int fmu_shows_time = 1;

typedef void (*logger)(void *environment, int status, const char *category, const char *message);

typedef struct {
    fmu_instance fmu;
    logger log;
    void *environment;
    bool logs;
} instance;

/* A status, with a message if it is an error. */
static int said(void *c, int status, const char *message)
{
    instance *own = c;
    if (status >= FMU_ERROR && own && own->logs && own->log) own->log(own->environment, status, "logStatusError", message);
    return status;
}

/* An error with its reason, or FMU_OK without one. */
static int unless(void *c, const char *reason) { return reason ? said(c, FMU_ERROR, reason) : FMU_OK; }

static fmu_instance *fmu_of(void *c) { return &((instance *)c)->fmu; }

FMU_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMU_EXPORT int fmi3SetDebugLogging(void *c, bool on, size_t count, const char *const categories[])
{
    (void)count, (void)categories;
    if (!c) return FMU_ERROR;
    ((instance *)c)->logs = on;
    return FMU_OK;
}

FMU_EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                             bool logs, bool events, bool early, const uint32_t between[],
                                             size_t between_count, void *environment, logger log, void (*update)(void))
{
    (void)name, (void)resources, (void)visible, (void)early, (void)between, (void)update;
    instance *own = events || between_count ? NULL : calloc(1, sizeof *own);
    if (own && fmu_begin(&own->fmu, token)) {
        own->log = log;
        own->environment = environment;
        own->logs = logs;
        return own;
    }
    free(own);
    if (log)
        log(environment, FMU_ERROR, "logStatusError",
            "must be instantiated with its own token, without event mode or intermediate variables, and have memory");
    return NULL;
}

FMU_EXPORT void fmi3FreeInstance(void *c)
{
    if (!c) return;
    fmu_end(fmu_of(c));
    free(c);
}

FMU_EXPORT int fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance, double start, bool has_stop,
                                           double stop)
{
    (void)has_tolerance, (void)tolerance;
    int status = c ? fmu_experiment(fmu_of(c), start, has_stop, stop) : FMU_ERROR;
    if (status == FMU_OK) status = fmu_enter(fmu_of(c), FMU_INITIALISING);
    return said(c, status, "must be initialised once, with a finite start time");
}

FMU_EXPORT int fmi3ExitInitializationMode(void *c)
{
    return c ? said(c, fmu_enter(fmu_of(c), FMU_STEPPING), "must be in initialization mode") : FMU_ERROR;
}

FMU_EXPORT int fmi3Terminate(void *c)
{
    return c ? said(c, fmu_enter(fmu_of(c), FMU_TERMINATED), "must be initialised to terminate") : FMU_ERROR;
}

FMU_EXPORT int fmi3Reset(void *c)
{
    if (!c) return FMU_ERROR;
    fmu_reset(fmu_of(c));
    return FMU_OK;
}

FMU_EXPORT int fmi3GetFloat64(void *c, const uint32_t references[], size_t count, double values[], size_t numbers)
{
    if (!c || numbers != count) return said(c, FMU_ERROR, "as many values as variables must be asked for");
    return said(c, fmu_get(fmu_of(c), references, count, values), "there is no such Float64");
}

FMU_EXPORT int fmi3SetFloat64(void *c, const uint32_t references[], size_t count, const double values[], size_t numbers)
{
    if (!c || numbers != count) return said(c, FMU_ERROR, "as many values as variables must be given");
    return said(c, fmu_set(fmu_of(c), references, count, values),
                "Float64 must be an input, or a parameter before the end of initialization");
}

/* Enumerations are of this type. */
FMU_EXPORT int fmi3GetInt64(void *c, const uint32_t references[], size_t count, int64_t values[], size_t numbers)
{
    int status = c && numbers == count ? FMU_OK : FMU_ERROR;
    for (size_t i = 0; i < count && status == FMU_OK; i++) {
        int32_t found = 0;
        status = fmu_get_status(fmu_of(c), references[i], &found);
        values[i] = found;
    }
    return said(c, status, "there is no such Int64 or Enumeration");
}

FMU_EXPORT int fmi3GetBoolean(void *c, const uint32_t references[], size_t count, bool values[], size_t numbers)
{
    int status = c && numbers == count ? FMU_OK : FMU_ERROR;
    for (size_t i = 0; i < count && status == FMU_OK; i++) {
        int32_t found = 0;
        status = fmu_get_flag(fmu_of(c), references[i], &found);
        values[i] = found != 0;
    }
    return said(c, status, "there is no such Boolean");
}

FMU_EXPORT int fmi3GetFMUState(void *c, void **state)
{
    return c ? said(c, fmu_get_state(fmu_of(c), state), "there is no memory") : FMU_ERROR;
}

FMU_EXPORT int fmi3SetFMUState(void *c, void *state)
{
    return c ? unless(c, fmu_set_state(fmu_of(c), state)) : FMU_ERROR;
}

FMU_EXPORT int fmi3FreeFMUState(void *c, void **state)
{
    (void)c;
    if (!state) return FMU_OK;
    free(*state);
    *state = NULL;
    return FMU_OK;
}

FMU_EXPORT int fmi3SerializedFMUStateSize(void *c, void *state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(fmu_saved);
    return FMU_OK;
}

FMU_EXPORT int fmi3SerializeFMUState(void *c, void *state, uint8_t bytes[], size_t size)
{
    return unless(c, fmu_serialise(state, bytes, size));
}

FMU_EXPORT int fmi3DeserializeFMUState(void *c, const uint8_t bytes[], size_t size, void **state)
{
    return unless(c, fmu_deserialise(bytes, size, state));
}

FMU_EXPORT int fmi3GetDirectionalDerivative(void *c, const uint32_t unknowns[], size_t unknown_count,
                                            const uint32_t knowns[], size_t known_count, const double seed[],
                                            size_t seeds, double sensitivity[], size_t sensitivities)
{
    if (!c || seeds != known_count || sensitivities != unknown_count)
        return said(c, FMU_ERROR, "as many numbers as variables must be given");
    return said(c, fmu_derivative(fmu_of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity),
                "derivatives must be declared, and of continuous Float64 outputs by inputs");
}

FMU_EXPORT int fmi3DoStep(void *c, double from, double step, bool no_return, bool *event, bool *terminate, bool *early,
                          double *reached)
{
    (void)no_return;
    if (!c) return FMU_ERROR;
    const int status = fmu_step(fmu_of(c), from, step);
    if (event) *event = false;
    if (terminate) *terminate = false;
    if (early) *early = false;
    if (reached) *reached = fmu_of(c)->state.time;
    return said(c, status, "step must be above 0 s and end by the stop time");
}

/* The rest of the standard's functions, which this FMU does not need: its model description says so. */
#define NONE(TYPE, GET, SET)                                                                                        \
    FMU_EXPORT int GET(void *c, const uint32_t references[], size_t count, TYPE values[], size_t numbers)           \
    {                                                                                                               \
        (void)references, (void)values, (void)numbers;                                                              \
        return said(c, count ? FMU_ERROR : FMU_OK, #GET ": there is no such variable");                             \
    }                                                                                                               \
    NONE_SET(TYPE, SET)
#define NONE_SET(TYPE, SET)                                                                                         \
    FMU_EXPORT int SET(void *c, const uint32_t references[], size_t count, TYPE const values[], size_t numbers)     \
    {                                                                                                               \
        (void)references, (void)values, (void)numbers;                                                              \
        return said(c, count ? FMU_ERROR : FMU_OK, #SET ": there is no such input");                                \
    }
NONE(float, fmi3GetFloat32, fmi3SetFloat32)
NONE(int8_t, fmi3GetInt8, fmi3SetInt8)
NONE(uint8_t, fmi3GetUInt8, fmi3SetUInt8)
NONE(int16_t, fmi3GetInt16, fmi3SetInt16)
NONE(uint16_t, fmi3GetUInt16, fmi3SetUInt16)
NONE(int32_t, fmi3GetInt32, fmi3SetInt32)
NONE(uint32_t, fmi3GetUInt32, fmi3SetUInt32)
NONE(uint64_t, fmi3GetUInt64, fmi3SetUInt64)
NONE(const char *, fmi3GetString, fmi3SetString)
NONE_SET(int64_t, fmi3SetInt64)
NONE_SET(bool, fmi3SetBoolean)

#define ABSENT(NAME, ...) \
    FMU_EXPORT int NAME(void *c, __VA_ARGS__) { return said(c, FMU_ERROR, #NAME ": is not supported"); }
#define ABSENT_MODE(NAME) \
    FMU_EXPORT int NAME(void *c) { return said(c, FMU_ERROR, #NAME ": is not supported"); }
#define SOME const uint32_t references[], size_t count
ABSENT(fmi3GetBinary, SOME, size_t sizes[], const uint8_t *values[], size_t numbers)
ABSENT(fmi3SetBinary, SOME, const size_t sizes[], const uint8_t *const values[], size_t numbers)
ABSENT(fmi3GetClock, SOME, bool values[])
ABSENT(fmi3SetClock, SOME, const bool values[])
ABSENT(fmi3GetNumberOfVariableDependencies, uint32_t reference, size_t *count)
ABSENT(fmi3GetVariableDependencies, uint32_t of, size_t own[], uint32_t by[], size_t theirs[], int kinds[], size_t count)
ABSENT(fmi3GetAdjointDerivative, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[],
       size_t known_count, const double seed[], size_t seeds, double sensitivity[], size_t sensitivities)
ABSENT(fmi3GetIntervalDecimal, SOME, double intervals[], int qualifiers[])
ABSENT(fmi3GetIntervalFraction, SOME, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
ABSENT(fmi3GetShiftDecimal, SOME, double shifts[])
ABSENT(fmi3GetShiftFraction, SOME, uint64_t counters[], uint64_t resolutions[])
ABSENT(fmi3SetIntervalDecimal, SOME, const double intervals[])
ABSENT(fmi3SetIntervalFraction, SOME, const uint64_t counters[], const uint64_t resolutions[])
ABSENT(fmi3SetShiftDecimal, SOME, const double shifts[])
ABSENT(fmi3SetShiftFraction, SOME, const uint64_t counters[], const uint64_t resolutions[])
ABSENT(fmi3UpdateDiscreteStates, bool *again, bool *end, bool *nominals, bool *values, bool *has_next, double *next)
ABSENT(fmi3CompletedIntegratorStep, bool no_return, bool *event, bool *end)
ABSENT(fmi3SetTime, double time)
ABSENT(fmi3SetContinuousStates, const double states[], size_t count)
ABSENT(fmi3GetContinuousStateDerivatives, double derivatives[], size_t count)
ABSENT(fmi3GetEventIndicators, double indicators[], size_t count)
ABSENT(fmi3GetContinuousStates, double states[], size_t count)
ABSENT(fmi3GetNominalsOfContinuousStates, double nominals[], size_t count)
ABSENT(fmi3GetNumberOfEventIndicators, size_t *count)
ABSENT(fmi3GetNumberOfContinuousStates, size_t *count)
ABSENT(fmi3GetOutputDerivatives, SOME, const int32_t orders[], double values[], size_t numbers)
ABSENT(fmi3ActivateModelPartition, uint32_t clock, double time)
ABSENT_MODE(fmi3EnterConfigurationMode)
ABSENT_MODE(fmi3ExitConfigurationMode)
ABSENT_MODE(fmi3EnterEventMode)
ABSENT_MODE(fmi3EvaluateDiscreteStates)
ABSENT_MODE(fmi3EnterContinuousTimeMode)
ABSENT_MODE(fmi3EnterStepMode)

FMU_EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                              bool logs, void *environment, logger log)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logs, (void)environment, (void)log;
    return NULL;
}

FMU_EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources,
                                                   bool visible, bool logs, void *environment, logger log,
                                                   void (*update)(void), void (*lock)(void), void (*unlock)(void))
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logs, (void)environment, (void)log;
    (void)update, (void)lock, (void)unlock;
    return NULL;
}

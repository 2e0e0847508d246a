/* FMI 2.0 for co-simulation, see fmu.h. Types and functions are those that the standard names. */
#include <stdlib.h>
#include <string.h>
#include "fmu.h"

const int fmu_shows_time = 0;

#define CO_SIMULATION 1         /* of the kinds that an FMU may be instantiated as */
#define LAST_SUCCESSFUL_TIME 2  /* of the statuses that may be asked for */

typedef void (*logger)(void *environment, const char *instance, int status, const char *category, const char *message, ...);

typedef struct {
    logger log;
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
} callbacks;

typedef struct {
    fmu_instance fmu;
    callbacks called;
    int logs;
    char name[]; /* of the instance */
} component;

static void log_error(const callbacks *called, const char *name, const char *message)
{
    if (called && called->log) called->log(called->environment, name, FMU_ERROR, "logStatusError", message);
}

/* A status, with a message if it is an error. */
static int said(void *c, int status, const char *message)
{
    component *own = c;
    if (status >= FMU_ERROR && own && own->logs) log_error(&own->called, own->name, message);
    return status;
}

/* An error with its reason, or FMU_OK without one. */
static int unless(void *c, const char *reason) { return reason ? said(c, FMU_ERROR, reason) : FMU_OK; }

static fmu_instance *fmu_of(void *c) { return &((component *)c)->fmu; }

FMU_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
FMU_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMU_EXPORT int fmi2SetDebugLogging(void *c, int on, size_t count, const char *const categories[])
{
    (void)count, (void)categories;
    if (!c) return FMU_ERROR;
    ((component *)c)->logs = on;
    return FMU_OK;
}

FMU_EXPORT void *fmi2Instantiate(const char *name, int kind, const char *token, const char *resources,
                                 const callbacks *functions, int visible, int logs)
{
    (void)resources, (void)visible;
    const size_t length = name ? strlen(name) : 0;
    component *own = kind == CO_SIMULATION ? calloc(1, sizeof *own + length + 1) : NULL;
    if (own && fmu_begin(&own->fmu, token)) {
        if (functions) own->called = *functions;
        own->logs = logs;
        if (name) memcpy(own->name, name, length);
        return own;
    }
    free(own);
    log_error(functions, name ? name : "", "must be instantiated for co-simulation with its own GUID, and have memory");
    return NULL;
}

FMU_EXPORT void fmi2FreeInstance(void *c)
{
    if (!c) return;
    fmu_end(fmu_of(c));
    free(c);
}

FMU_EXPORT int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    (void)has_tolerance, (void)tolerance;
    return c ? said(c, fmu_experiment(fmu_of(c), start, has_stop, stop), "start and stop time must be finite") : FMU_ERROR;
}

FMU_EXPORT int fmi2EnterInitializationMode(void *c)
{
    return c ? said(c, fmu_enter(fmu_of(c), FMU_INITIALISING), "must be initialised once") : FMU_ERROR;
}

FMU_EXPORT int fmi2ExitInitializationMode(void *c)
{
    return c ? said(c, fmu_enter(fmu_of(c), FMU_STEPPING), "must be in initialization mode") : FMU_ERROR;
}

FMU_EXPORT int fmi2Terminate(void *c)
{
    return c ? said(c, fmu_enter(fmu_of(c), FMU_TERMINATED), "must be initialised to terminate") : FMU_ERROR;
}

FMU_EXPORT int fmi2Reset(void *c)
{
    if (!c) return FMU_ERROR;
    fmu_reset(fmu_of(c));
    return FMU_OK;
}

FMU_EXPORT int fmi2GetReal(void *c, const uint32_t references[], size_t count, double values[])
{
    return c ? said(c, fmu_get(fmu_of(c), references, count, values), "there is no such Real") : FMU_ERROR;
}

FMU_EXPORT int fmi2SetReal(void *c, const uint32_t references[], size_t count, const double values[])
{
    if (!c) return FMU_ERROR;
    return said(c, fmu_set(fmu_of(c), references, count, values),
                "Real must be an input, or a parameter before the end of initialization");
}

FMU_EXPORT int fmi2GetInteger(void *c, const uint32_t references[], size_t count, int values[])
{
    int status = c ? FMU_OK : FMU_ERROR;
    for (size_t i = 0; i < count && status == FMU_OK; i++) status = fmu_get_status(fmu_of(c), references[i], values + i);
    return said(c, status, "there is no such Integer or Enumeration");
}

FMU_EXPORT int fmi2GetBoolean(void *c, const uint32_t references[], size_t count, int values[])
{
    int status = c ? FMU_OK : FMU_ERROR;
    for (size_t i = 0; i < count && status == FMU_OK; i++) status = fmu_get_flag(fmu_of(c), references[i], values + i);
    return said(c, status, "there is no such Boolean");
}

/* Variables of other types do not exist. */
#define NONE(NAME, TYPE)                                                                     \
    FMU_EXPORT int NAME(void *c, const uint32_t references[], size_t count, TYPE values[])   \
    {                                                                                        \
        (void)references, (void)values;                                                      \
        return said(c, count ? FMU_ERROR : FMU_OK, #NAME ": there is no such variable");     \
    }
NONE(fmi2GetString, const char *)
NONE(fmi2SetInteger, const int)
NONE(fmi2SetBoolean, const int)
NONE(fmi2SetString, const char *const)

FMU_EXPORT int fmi2GetFMUstate(void *c, void **state)
{
    return c ? said(c, fmu_get_state(fmu_of(c), state), "there is no memory") : FMU_ERROR;
}

FMU_EXPORT int fmi2SetFMUstate(void *c, void *state)
{
    return c ? unless(c, fmu_set_state(fmu_of(c), state)) : FMU_ERROR;
}

FMU_EXPORT int fmi2FreeFMUstate(void *c, void **state)
{
    (void)c;
    if (!state) return FMU_OK;
    free(*state);
    *state = NULL;
    return FMU_OK;
}

FMU_EXPORT int fmi2SerializedFMUstateSize(void *c, void *state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(fmu_saved);
    return FMU_OK;
}

FMU_EXPORT int fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size)
{
    return unless(c, fmu_serialise(state, bytes, size));
}

FMU_EXPORT int fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state)
{
    return unless(c, fmu_deserialise(bytes, size, state));
}

FMU_EXPORT int fmi2GetDirectionalDerivative(void *c, const uint32_t unknowns[], size_t unknown_count,
                                            const uint32_t knowns[], size_t known_count, const double seed[],
                                            double sensitivity[])
{
    if (!c) return FMU_ERROR;
    return said(c, fmu_derivative(fmu_of(c), unknowns, unknown_count, knowns, known_count, seed, sensitivity),
                "derivatives must be declared, and of continuous Real outputs by inputs");
}

FMU_EXPORT int fmi2DoStep(void *c, double from, double step, int no_return)
{
    (void)no_return;
    return c ? said(c, fmu_step(fmu_of(c), from, step), "step must be above 0 s and end by the stop time") : FMU_ERROR;
}

/* Steps end at once, and inputs are constant over them. */
FMU_EXPORT int fmi2CancelStep(void *c) { return said(c, FMU_ERROR, "no step is pending"); }

#define DERIVATIVES(NAME, TYPE)                                                                                  \
    FMU_EXPORT int NAME(void *c, const uint32_t references[], size_t count, const int orders[], TYPE values[])   \
    {                                                                                                            \
        (void)references, (void)orders, (void)values;                                                            \
        return said(c, count ? FMU_ERROR : FMU_OK, #NAME ": derivatives by time are not known");                 \
    }
DERIVATIVES(fmi2SetRealInputDerivatives, const double)
DERIVATIVES(fmi2GetRealOutputDerivatives, double)

#define NO_STATUS(NAME, TYPE)                                                            \
    FMU_EXPORT int NAME(void *c, int of, TYPE *value)                                    \
    {                                                                                    \
        (void)of, (void)value;                                                           \
        return said(c, FMU_DISCARD, "");                                                 \
    }
NO_STATUS(fmi2GetStatus, int)
NO_STATUS(fmi2GetIntegerStatus, int)
NO_STATUS(fmi2GetBooleanStatus, int)
NO_STATUS(fmi2GetStringStatus, const char *)

FMU_EXPORT int fmi2GetRealStatus(void *c, int of, double *value)
{
    if (!c || of != LAST_SUCCESSFUL_TIME) return FMU_DISCARD;
    *value = fmu_of(c)->state.time;
    return FMU_OK;
}

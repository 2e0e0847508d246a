/* A model without Python, for a page in a browser and an FMU: a finger before an object, or a separated model. */
#ifndef FINGERFEM_MODEL_H
#define FINGERFEM_MODEL_H
#include "separated/kernel.h"
#include "segment.h"

enum { FINGERFEM_MOST_ROWS = 6, FINGERFEM_MOST_ERRORS = 4 };

/* Why an answer is not to be relied on. */
enum { FINGERFEM_INSIDE = 0, FINGERFEM_NO_EQUILIBRIUM = 1, FINGERFEM_BEYOND = 2 };

/* A separated model's estimated errors, see rom.separated.model.Errors. */
typedef struct {
    double tip, touch_distance, margin; /* [m] */
    int32_t columns;
    const double *rates; /* (cells^parameters, columns) */
} fingerfem_errors;

typedef struct {
    int32_t parameters, sections;       /* tensions and d; and how many sections its surface has, 0 if it has none */
    const fingerfem_touching *touching; /* of a finger of elements, or NULL */
    const fingerfem_kernel *kernel;     /* of a separated model, or NULL, as its errors */
    const fingerfem_errors *errors;
} fingerfem_model;

/* Numbers of memory that the functions below need: `memory`, which they spoil. */
int32_t fingerfem_model_memory(const fingerfem_model *model);

/* The answer at a point, (parameters): out, (FINGERFEM_MOST_ROWS), see kernel.h, its estimated errors of tip, contact
 * force, touch distance and pad pressure, (FINGERFEM_MOST_ERRORS), and derivatives, (rows, parameters). What a model does
 * not have is NaN. Returns whether it is to be relied on. The loads, (fingerfem_chain_loads), are where the solve begins and end. The report is
 * computed unless it is NULL; a separated model has none, and leaves it. */
int fingerfem_model_evaluate(const fingerfem_model *model, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report);

/* The surface at a point that was evaluated, under its loads: (sections, 4, 3) [m]. */
int fingerfem_model_sections(const fingerfem_model *model, const double *point, const double *loads, double *memory,
                             double *corners);
#endif

/* A model without Python: what a page in a browser and an FMU ask of a surrogate, or of a segment before an object. */
#ifndef FINGERFEM_MODEL_H
#define FINGERFEM_MODEL_H
#include "../../native/kernel.h"
#include "../../rod/native/segment.h"

enum { FINGERFEM_MOST_ROWS = 6, FINGERFEM_MOST_ERRORS = 4 };

/* Why an answer is not to be relied on. */
enum { FINGERFEM_INSIDE = 0, FINGERFEM_NO_EQUILIBRIUM = 1, FINGERFEM_BEYOND = 2 };

/* A surrogate's estimated errors, see rom.components.Errors; mesh has its shares of tip, touch distance, contact force and,
 * of that, by place, and of the pad's pressure likewise, (6); NULL if they are not known. */
typedef struct {
    double tip, touch_distance, margin; /* [m] */
    int32_t columns;
    const double *rates; /* (cells, columns) */
    const double *mesh;
} fingerfem_errors;

/* The finger's four long edges in a surrogate's field: stations along them, at rest, (stations, 4, 3) [m], and how their
 * POD modes move them, (12 stations, modes), by amounts that are forms of `tables`, as those of a kernel. */
typedef struct {
    int32_t stations, free_modes, contact_modes;
    const fingerfem_tables *tables;
    const double *rest;
    const float *free_basis, *contact_basis;
} fingerfem_edges;

typedef struct {
    int32_t parameters, sections;       /* tensions and d; and how many sections its surface has, 0 if it is not known */
    const fingerfem_touching *touching; /* of a segment or several, or NULL */
    const fingerfem_kernel *kernel;     /* of a surrogate, or NULL, as its errors and, where it has no field, its edges */
    const fingerfem_errors *errors;
    const fingerfem_edges *edges;
} fingerfem_model;

/* Numbers of memory that the functions below need: `memory`, which they spoil. */
int32_t fingerfem_model_memory(const fingerfem_model *model);

/* All that is told at a point, (parameters): out, (FINGERFEM_MOST_ROWS), see kernel.h, its estimated errors of tip, contact
 * force, touch distance and pad pressure, (FINGERFEM_MOST_ERRORS), and derivatives, (rows, parameters). What is not known
 * is NaN. Returns whether it is to be relied on. The loads, (fingerfem_chain_loads), are where the solve begins and end. The report is
 * computed unless it is NULL; a surrogate has none, and leaves it. */
int fingerfem_model_tell(const fingerfem_model *model, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report);

/* The surface at a point that was evaluated, under its loads: (sections, 4, 3) [m]. */
int fingerfem_model_sections(const fingerfem_model *model, const double *point, const double *loads, double *memory,
                             double *corners);
#endif

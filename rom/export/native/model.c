#include "model.h"
#include <math.h>
#include <string.h>
#include "../../native/evaluation.h"

#define PAST 1e-6 /* how far past touch contact's stiffness is asked for where nothing touches yet [m] */

int32_t fingerfem_model_memory(const fingerfem_model *model)
{
    if (model->touching) return fingerfem_chain_memory(model->touching->chain);
    const fingerfem_edges *edges = model->edges;
    int size = fingerfem_forms_memory(&model->kernel->tables);
    if (!edges) return size;
    const int own = fingerfem_forms_memory(edges->tables);
    return (size > own ? size : own) + model->kernel->tables.most_components + edges->tables->most_components;
}

static int tell_touching(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report)
{
    int32_t inside;
    const int evaluations = fingerfem_tell(touching, point, memory, loads, out, jacobian, errors, &inside, report);
    if (evaluations <= 0) return FINGERFEM_NO_EQUILIBRIUM;
    return inside ? FINGERFEM_INSIDE : FINGERFEM_BEYOND;
}

/* How much a row of an answer changes if the finger stands off by a shift [m], see rom.fit.mesh_error. */
static double place_error(const fingerfem_kernel *kernel, const double *point, const double *out, int row, double shift,
                          double *memory)
{
    const int p = kernel->parameters;
    const double gap = point[p - 1] - out[FINGERFEM_TOUCH];
    double past[FINGERFEM_MOST_PARAMETERS], slope;
    if (!(gap < shift)) return 0.0;
    memcpy(past, point, (size_t)p * sizeof *past);
    past[p - 1] = fmin(past[p - 1], out[FINGERFEM_TOUCH] - PAST);
    fingerfem_slopes(kernel, 1, past, row, memory, &slope);
    return (shift - fmax(gap, 0.0)) * fabs(slope);
}

static void surrogate_errors(const fingerfem_kernel *kernel, const fingerfem_errors *known, const double *point,
                             const double *out, double *memory, double *errors)
{
    double contact[FINGERFEM_MOST_ERRORS] = {0.0};
    const double *mesh = known->mesh, way = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    fingerfem_contact_errors(kernel, known->rates, known->columns, known->margin, 1, point, out + FINGERFEM_TOUCH, contact);
    errors[0] = known->tip + contact[0] + (mesh ? mesh[0] * way : 0.0);
    errors[1] = contact[1];
    errors[2] = known->touch_distance + (mesh ? mesh[1] * way : 0.0);
    if (mesh && kernel->has_obstacle)
        errors[1] += mesh[2] * out[FINGERFEM_FORCE] + place_error(kernel, point, out, FINGERFEM_FORCE, mesh[3] * way, memory);
    if (!kernel->has_pad) return;
    errors[3] = contact[3];
    if (mesh) errors[3] += mesh[4] * out[FINGERFEM_PAD] + place_error(kernel, point, out, FINGERFEM_PAD, mesh[5] * way, memory);
}

int fingerfem_model_tell(const fingerfem_model *model, const double *point, double *memory, double *loads, double *out,
                         double *errors, double *jacobian, const fingerfem_report *report)
{
    out[FINGERFEM_PAD] = errors[3] = NAN;
    if (model->touching) return tell_touching(model->touching, point, memory, loads, out, errors, jacobian, report);
    const int inside = fingerfem_answer(model->kernel, point, memory, out, jacobian);
    surrogate_errors(model->kernel, model->errors, point, out, memory, errors);
    return inside ? FINGERFEM_INSIDE : FINGERFEM_BEYOND;
}

/* Move the edges by a form's amounts, which are written to memory, times a size. */
static void add_modes(const fingerfem_edges *edges, int form, const double *at, const float *basis, int modes, double size,
                      double *memory, double *corners)
{
    double *amounts = memory;
    fingerfem_form(edges->tables, form, 1, at, amounts + edges->tables->most_components, amounts, NULL);
    for (int i = 0; i < 12 * edges->stations; i++)
        for (int k = 0; k < modes; k++) corners[i] += size * amounts[k] * basis[modes * i + k];
}

/* As rom.surrogate.Surrogate.displacement, of the edges alone. */
static void move_edges(const fingerfem_kernel *kernel, const fingerfem_edges *edges, const double *point, double *memory,
                       double *corners)
{
    const int p = kernel->parameters, last = p - 1;
    double held[FINGERFEM_MOST_PARAMETERS], coordinates[FINGERFEM_MOST_PARAMETERS], out[FINGERFEM_MOST_ROWS], *free = memory;
    double *work = memory + kernel->tables.most_components;
    uint8_t inside;
    int32_t regime;
    for (int j = 0; j < p; j++) held[j] = fmin(fmax(kernel->lower[j], point[j]), kernel->upper[j]); /* NaN: the lower */
    memcpy(corners, edges->rest, 12 * (size_t)edges->stations * sizeof *corners);
    add_modes(edges, 0, held, edges->free_basis, edges->free_modes, 1.0, work, corners);
    fingerfem_answers(kernel, 1, point, work, out, &inside, &regime);
    if (regime < 0) return;
    fingerfem_form(&kernel->tables, 0, 1, held, work, free, NULL);
    const double height = free[FINGERFEM_HEIGHTS + kernel->corners[regime]], path = height - held[last];
    memcpy(coordinates, held, sizeof coordinates);
    coordinates[last] = path / (height - kernel->nearest + kernel->softening);
    add_modes(edges, 1 + regime, coordinates, edges->contact_basis, edges->contact_modes, kernel->begins[regime] ? path : 1.0,
              work, corners);
}

int fingerfem_model_sections(const fingerfem_model *model, const double *point, const double *loads, double *memory,
                             double *corners)
{
    if (!model->sections) return 0;
    if (model->touching) return fingerfem_chain_sections(model->touching->chain, point, loads, memory, corners);
    move_edges(model->kernel, model->edges, point, memory, corners);
    return 1;
}

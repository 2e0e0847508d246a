/* The compiled answer at many points, values alone; and what it may be off, see evaluation.h. */
#include <math.h>
#include <stddef.h>
#include "evaluation.c"

/* Add what contact does to an answer's values. */
static void add_contact_values(const fingerfem_kernel *kernel, int regime, const double *point, double height,
                               double *products, double *out)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int form = 1 + regime;
    const double size = kernel->begins[regime] ? height - point[kernel->parameters - 1] : 1.0;
    double coordinates[FINGERFEM_MOST_PARAMETERS];
    fingerfem_coordinates(kernel, point, height, coordinates);
    fingerfem_products(tables, form, coordinates, products);
    for (int j = 0; j < fingerfem_components(tables, form); j++) {
        const int row = fingerfem_row(kernel, regime, j);
        if (row >= 0) out[row] += size * fingerfem_component(tables, form, j, products);
    }
    fingerfem_never_pull(kernel, out);
}

void fingerfem_answers(const fingerfem_kernel *kernel, int count, const double *points, double *memory, double *out,
                       uint8_t *inside, int32_t *regimes)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, corners = fingerfem_components(tables, 0) - FINGERFEM_HEIGHTS;
    const int rows = FINGERFEM_PAD + kernel->has_pad;
    double held[FINGERFEM_MOST_PARAMETERS], *products = memory, *heights = memory + fingerfem_terms(tables, 0);
    double *work = heights + (corners > 0 ? corners : 0);
    for (int i = 0; i < count; i++, points += p, out += rows) {
        regimes[i] = -1;
        inside[i] = (uint8_t)fingerfem_hold_tensions(kernel, points, held);
        fingerfem_products(tables, 0, held, products);
        fingerfem_free_answer(kernel, products, out);
        if (!kernel->has_obstacle) continue;
        for (int j = 0; j < corners; j++) heights[j] = fingerfem_component(tables, 0, FINGERFEM_HEIGHTS + j, products);
        const double touch_distance = out[FINGERFEM_TOUCH] = heights[fingerfem_leading(heights, corners)];
        inside[i] &= (uint8_t)fingerfem_hold_distance(kernel, points, touch_distance, held);
        if (!(held[p - 1] < touch_distance)) continue;
        inside[i] &= (uint8_t)fingerfem_is_known(kernel, held, touch_distance);
        regimes[i] = fingerfem_regime(kernel, held, heights, touch_distance, work);
        add_contact_values(kernel, regimes[i], held, heights[kernel->corners[regimes[i]]], work, out);
    }
}

void fingerfem_slopes(const fingerfem_kernel *kernel, int count, const double *points, int row, double *memory,
                      double *slopes)
{
    enum { ROWS = FINGERFEM_PAD + 1 };
    const int p = kernel->parameters;
    double out[ROWS], jacobian[ROWS * FINGERFEM_MOST_PARAMETERS];
    for (int i = 0; i < count; i++, points += p) {
        fingerfem_answer(kernel, points, memory, out, jacobian);
        slopes[i] = jacobian[p * row + p - 1];
    }
}

void fingerfem_contact_error(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                             const double *point, double touch_distance, double *found)
{
    const double path = kernel->has_obstacle ? touch_distance - point[kernel->parameters - 1] : 0.0;
    const int cell = path > 0.0 ? fingerfem_lookup_cell(kernel, point, touch_distance) : 0;
    for (int i = 0; i < columns; i++) found[i] = path > 0.0 ? rates[columns * cell + i] * (path + margin) : 0.0;
}

void fingerfem_contact_errors(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                              int count, const double *points, const double *touch_distances, double *found)
{
    const int p = kernel->parameters;
    double held[FINGERFEM_MOST_PARAMETERS];
    for (int i = 0; i < count; i++, points += p, found += columns) {
        fingerfem_hold_tensions(kernel, points, held);
        fingerfem_hold_distance(kernel, points, touch_distances[i], held);
        fingerfem_contact_error(kernel, rates, columns, margin, held, touch_distances[i], found);
    }
}

void fingerfem_form(const fingerfem_tables *tables, int form, int count, const double *points, double *memory,
                    double *values, double *gradients)
{
    const int axes = fingerfem_axes(tables, form), terms = fingerfem_terms(tables, form);
    const int m = fingerfem_components(tables, form);
    double *products = memory, *slopes = products + terms, *work = slopes + axes * terms;
    for (int i = 0; i < count; i++, points += axes, values += m) {
        if (gradients)
            fingerfem_products_and_slopes(tables, form, points, work, products, slopes);
        else
            fingerfem_products(tables, form, points, products);
        for (int j = 0; j < m; j++) values[j] = fingerfem_component(tables, form, j, products);
        for (int j = 0; j < m && gradients; j++, gradients += axes)
            fingerfem_gradient(tables, form, j, slopes, gradients);
    }
}

/* The compiled answer at many points, values alone; and its estimated errors, see evaluation.h. */
#include <math.h>
#include <stddef.h>
#include "evaluation.c"

void fingerfem_answers(const fingerfem_kernel *kernel, int count, const double *points, double *memory, double *out,
                       uint8_t *inside)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, d = p - 1, rows = FINGERFEM_PAD + kernel->has_pad;
    double held[FINGERFEM_MOST_PARAMETERS], *products = memory;
    for (int i = 0; i < count; i++, points += p, out += rows) {
        /* free answer u_0 and D */
        inside[i] = (uint8_t)fingerfem_hold_tensions(kernel, points, held);
        fingerfem_products(tables, FINGERFEM_FREE_FORM, held, products);
        fingerfem_free_answer(kernel, products, out);
        const double touch = out[FINGERFEM_TOUCH];
        /* before touch, the free answer stands */
        inside[i] &= (uint8_t)fingerfem_hold_distance(kernel, points, touch, held);
        if (!(held[d] < touch)) continue;
        /* past touch: u = u_0 + path v(F, s), with path = D - d, s = path / (D - d_min) */
        inside[i] &= (uint8_t)(kernel->answered[fingerfem_cell(kernel, held, touch)] != 0);
        const double path = touch - held[d];
        held[d] = path / fingerfem_whole_path(kernel, touch);
        fingerfem_products(tables, FINGERFEM_CONTACT_FORM, held, products);
        for (int j = 0; j < fingerfem_components(tables, FINGERFEM_CONTACT_FORM); j++)
            out[fingerfem_row(j)] += path * fingerfem_component(tables, FINGERFEM_CONTACT_FORM, j, products);
        fingerfem_never_pull(kernel, out);
    }
}

void fingerfem_contact_error(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                             const double *point, double touch_distance, double *found)
{
    /* error = rate of the cell times (D - d + margin), 0 where that is negative */
    const double length = touch_distance - point[kernel->parameters - 1] + margin;
    const double *rate = rates + columns * (length > 0.0 ? fingerfem_cell(kernel, point, touch_distance) : 0);
    for (int i = 0; i < columns; i++) found[i] = length > 0.0 ? rate[i] * length : 0.0;
}

void fingerfem_contact_errors(const fingerfem_kernel *kernel, const double *rates, int columns, double margin,
                              int count, const double *points, const double *touch_distances, double *found)
{
    const int p = kernel->parameters;
    double held[FINGERFEM_MOST_PARAMETERS];
    /* errors at the nearest point of the box */
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
        /* products of the terms, and slopes if they are asked for */
        if (gradients)
            fingerfem_products_and_slopes(tables, form, points, work, products, slopes);
        else
            fingerfem_products(tables, form, points, products);
        /* values and gradients of all components */
        for (int j = 0; j < m; j++) values[j] = fingerfem_component(tables, form, j, products);
        for (int j = 0; j < m && gradients; j++, gradients += axes)
            fingerfem_gradient(tables, form, j, slopes, gradients);
    }
}

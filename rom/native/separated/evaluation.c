/* The compiled answer of a separated model, see evaluation.h. An exported header has this text in it. */
#include <math.h>
#include <stddef.h>
#include "evaluation.h"
#ifndef FINGERFEM_API
#define FINGERFEM_API
#endif

/* What a form's row says: how many axes, terms and components, and where its modes are in data. */
static inline int fingerfem_axes(const fingerfem_tables *tables, int form)
{
    return tables->forms[FINGERFEM_ROW * form + FINGERFEM_AXES];
}
static inline int fingerfem_terms(const fingerfem_tables *tables, int form)
{
    return tables->forms[FINGERFEM_ROW * form + FINGERFEM_TERMS];
}
static inline int fingerfem_components(const fingerfem_tables *tables, int form)
{
    return tables->forms[FINGERFEM_ROW * form + FINGERFEM_COMPONENTS];
}
static inline int fingerfem_modes(const fingerfem_tables *tables, int form)
{
    return tables->forms[FINGERFEM_ROW * form + FINGERFEM_MODES];
}

/* Where x lies on an axis: its interval's pieces, how far along it is (an interval beyond the ends at most), and how
 * that changes with x. NaN goes to the lower end. */
static inline const double *fingerfem_pieces(const fingerfem_tables *tables, int form, int axis, double x, double *along,
                                             double *rate)
{
    const int at = 2 * (tables->most_axes * form + axis);
    const double last = tables->axes[at], per_unit = tables->scales[at + 1];
    const double wanted = (x - tables->scales[at]) * per_unit;
    const double held = wanted > -1.0 ? (wanted < last + 1.0 ? wanted : last + 1.0) : -1.0;
    const int interval = (int)(held < 0.0 ? 0.0 : held > last - 1.0 ? last - 1.0 : held);
    *along = held - interval;
    *rate = wanted == held ? per_unit : 0.0;
    return tables->data + tables->axes[at + 1] + (ptrdiff_t)4 * fingerfem_terms(tables, form) * interval;
}

FINGERFEM_API int32_t fingerfem_forms_memory(const fingerfem_tables *tables)
{
    return FINGERFEM_FORMS_MEMORY(tables->most_axes, tables->most_terms, tables->most_components);
}

/* Products, (terms), of a form's one-dimensional functions at x. */
static inline void fingerfem_products(const fingerfem_tables *tables, int form, const double *x, double *restrict whole)
{
    const int axes = fingerfem_axes(tables, form), terms = fingerfem_terms(tables, form);
    for (int k = 0; k < terms; k++) whole[k] = 1.0;
    for (int a = 0; a < axes; a++) {
        double t, rate;
        const double *restrict c = fingerfem_pieces(tables, form, a, x[a], &t, &rate);
        for (int k = 0; k < terms; k++)
            whole[k] *= c[k] + t * (c[terms + k] + t * (c[2 * terms + k] + t * c[3 * terms + k]));
    }
}

/* The same with their derivatives by every axis, slopes (axes, terms): products of all before an axis, then of all
 * behind it. Works in (1 + axes) terms numbers. */
static inline void fingerfem_products_and_slopes(const fingerfem_tables *tables, int form, const double *x,
                                                 double *restrict work, double *restrict whole, double *restrict slopes)
{
    const int axes = fingerfem_axes(tables, form), terms = fingerfem_terms(tables, form);
    double *restrict behind = work, *values = work + terms;
    for (int k = 0; k < terms; k++) whole[k] = behind[k] = 1.0;
    for (int a = 0; a < axes; a++) {
        double t, rate;
        const double *restrict c = fingerfem_pieces(tables, form, a, x[a], &t, &rate);
        double *restrict value = values + a * terms, *restrict slope = slopes + a * terms;
        for (int k = 0; k < terms; k++) {
            const double c1 = c[terms + k], c2 = c[2 * terms + k], c3 = c[3 * terms + k];
            value[k] = c[k] + t * (c1 + t * (c2 + t * c3));
            slope[k] = whole[k] * rate * (c1 + t * (2.0 * c2 + t * 3.0 * c3));
            whole[k] *= value[k];
        }
    }
    for (int a = axes - 1; a >= 0; a--) {
        double *restrict value = values + a * terms, *restrict slope = slopes + a * terms;
        for (int k = 0; k < terms; k++) {
            slope[k] *= behind[k];
            behind[k] *= value[k];
        }
    }
}

/* Component j of a form: its modes weighted by the terms' products, or by their slopes. */
static inline double fingerfem_component(const fingerfem_tables *tables, int form, int j, const double *restrict weights)
{
    const int terms = fingerfem_terms(tables, form);
    const double *restrict modes = tables->data + fingerfem_modes(tables, form) + (ptrdiff_t)j * terms;
    double found = 0.0;
    for (int k = 0; k < terms; k++) found += weights[k] * modes[k];
    return found;
}

static inline void fingerfem_gradient(const fingerfem_tables *tables, int form, int j, const double *slopes,
                                      double *gradient)
{
    const int axes = fingerfem_axes(tables, form), terms = fingerfem_terms(tables, form);
    for (int a = 0; a < axes; a++) gradient[a] = fingerfem_component(tables, form, j, slopes + a * terms);
}

/* Hold a point's tensions to the sampled box; whether they are inside. NaN goes to the lower end. */
static inline int fingerfem_hold_tensions(const fingerfem_kernel *kernel, const double *point, double *held)
{
    const int d = kernel->parameters - 1;
    int inside = 1;
    for (int j = 0; j < d; j++) {
        held[j] = point[j];
        if (point[j] >= kernel->lower[j] && point[j] <= kernel->upper[j]) continue;
        inside = 0;
        held[j] = point[j] > kernel->upper[j] ? kernel->upper[j] : kernel->lower[j];
    }
    held[d] = point[d];
    return inside;
}

/* Hold the distance of an object that is touched to the box; whether it is inside, or infinite, which is no object. */
static inline int fingerfem_hold_distance(const fingerfem_kernel *kernel, const double *point, double touch_distance,
                                          double *held)
{
    const int d = kernel->parameters - 1;
    if (point[d] >= kernel->lower[d] && point[d] <= kernel->upper[d]) return 1;
    if (point[d] >= touch_distance) return point[d] == INFINITY;
    held[d] = point[d] > kernel->upper[d] ? kernel->upper[d] : kernel->lower[d];
    return 0;
}

/* The contact path [m] to the nearest object: its share, s, is the last coordinate, see rom/separated/tabulated.py. */
static inline double fingerfem_whole_path(const fingerfem_kernel *kernel, double touch_distance)
{
    return touch_distance - kernel->lower[kernel->parameters - 1];
}

/* Cell of a point: even in the tensions and in s, which is 0 before contact. */
static inline int fingerfem_cell(const fingerfem_kernel *kernel, const double *point, double touch_distance)
{
    const int d = kernel->parameters - 1, cells = kernel->cells;
    const double path = touch_distance - point[d];
    int found = 0;
    for (int j = 0; j <= d; j++) {
        double t = j < d ? (point[j] - kernel->lower[j]) / (kernel->upper[j] - kernel->lower[j])
                         : path > 0.0 ? path / fingerfem_whole_path(kernel, touch_distance) : 0.0;
        t *= cells;
        found = found * cells + (int)(t > 0.0 ? (t < cells - 1.0 ? t : cells - 1.0) : 0.0);
    }
    return found;
}

/* An object never pulls: a form may swing below zero just after touch. */
static inline void fingerfem_never_pull(const fingerfem_kernel *kernel, double *out)
{
    if (out[FINGERFEM_FORCE] < 0.0) out[FINGERFEM_FORCE] = 0.0;
    if (kernel->has_pad && out[FINGERFEM_PAD] < 0.0) out[FINGERFEM_PAD] = 0.0;
}

/* Row of an answer that component j of the contact form adds to: tip and force, then the pad's pressure. */
static inline int fingerfem_row(int j)
{
    return j <= FINGERFEM_FORCE ? FINGERFEM_TIP + j : FINGERFEM_PAD;
}

/* Add to an answer and its derivatives what contact adds: u = u_0 + p v(F, s), with p = D - d and s = p / (D - d_min). */
static inline void fingerfem_add_contact(const fingerfem_kernel *kernel, const double *point, double *memory, double *out,
                                         double *jacobian)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, d = p - 1, form = FINGERFEM_CONTACT_FORM, terms = fingerfem_terms(tables, form);
    const double touch = out[FINGERFEM_TOUCH], path = touch - point[d], whole = fingerfem_whole_path(kernel, touch);
    const double *rising = jacobian + p * FINGERFEM_TOUCH; /* dD/dF */
    double coordinates[FINGERFEM_MOST_PARAMETERS], gradient[FINGERFEM_MOST_PARAMETERS];
    double *products = memory, *slopes = products + terms, *work = slopes + p * terms;
    for (int j = 0; j < d; j++) coordinates[j] = point[j];
    coordinates[d] = path / whole;
    fingerfem_products_and_slopes(tables, form, coordinates, work, products, slopes);
    for (int j = 0; j < fingerfem_components(tables, form); j++) {
        const int row = fingerfem_row(j);
        const double value = fingerfem_component(tables, form, j, products);
        fingerfem_gradient(tables, form, j, slopes, gradient);
        const double by_path = gradient[d] / whole; /* dv/ds ds/dp */
        double *own = jacobian + p * row;
        out[row] += path * value;
        for (int k = 0; k < d; k++)
            own[k] += path * (gradient[k] + by_path * (1.0 - coordinates[d]) * rising[k]) + value * rising[k];
        own[d] -= path * by_path + value;
    }
    fingerfem_never_pull(kernel, out);
}

/* The answer without contact, from the products of the free form. */
static inline void fingerfem_free_answer(const fingerfem_kernel *kernel, const double *products, double *out)
{
    for (int i = 0; i < FINGERFEM_FREE_TOUCH; i++)
        out[FINGERFEM_TIP + i] = fingerfem_component(&kernel->tables, FINGERFEM_FREE_FORM, i, products);
    out[FINGERFEM_FORCE] = 0.0;
    out[FINGERFEM_TOUCH] = fingerfem_component(&kernel->tables, FINGERFEM_FREE_FORM, FINGERFEM_FREE_TOUCH, products);
    if (kernel->has_pad) out[FINGERFEM_PAD] = 0.0;
}

FINGERFEM_API int fingerfem_answer(const fingerfem_kernel *kernel, const double *point, double *memory, double *out,
                                   double *jacobian)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, d = p - 1, form = FINGERFEM_FREE_FORM, terms = fingerfem_terms(tables, form);
    const int rows = FINGERFEM_PAD + kernel->has_pad;
    double held[FINGERFEM_MOST_PARAMETERS], *products = memory, *slopes = products + terms, *work = slopes + d * terms;
    int inside = fingerfem_hold_tensions(kernel, point, held);
    for (int j = 0; j < rows * p; j++) jacobian[j] = 0.0;
    fingerfem_products_and_slopes(tables, form, held, work, products, slopes);
    fingerfem_free_answer(kernel, products, out);
    for (int i = 0; i < FINGERFEM_FREE_TOUCH; i++)
        fingerfem_gradient(tables, form, i, slopes, jacobian + p * (FINGERFEM_TIP + i));
    fingerfem_gradient(tables, form, FINGERFEM_FREE_TOUCH, slopes, jacobian + p * FINGERFEM_TOUCH);
    const double touch = out[FINGERFEM_TOUCH];
    inside &= fingerfem_hold_distance(kernel, point, touch, held);
    if (held[d] < touch) {
        inside &= kernel->answered[fingerfem_cell(kernel, held, touch)] != 0;
        fingerfem_add_contact(kernel, held, memory, out, jacobian);
    }
    for (int j = 0; j < p && !inside; j++)
        if (held[j] != point[j])
            for (int i = 0; i < rows; i++) jacobian[p * i + j] = 0.0;
    return inside;
}

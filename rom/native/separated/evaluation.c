/* The compiled answer of a separated model, see evaluation.h. Exported headers contain this text. */
#include <math.h>
#include <stddef.h>
#include "evaluation.h"
#ifndef FINGERFEM_API
#define FINGERFEM_API
#endif

/* Columns of a form's row: numbers of axes, terms and components, and where its modes begin in data. */
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

/* Cubic pieces of the interval of an axis where x lies; its coordinate `along` in the interval, 0 to 1, or up to 1
 * beyond an end of the axis; and the derivative `rate` of that by x. NaN goes to the lower end. */
static inline const double *fingerfem_pieces(const fingerfem_tables *tables, int form, int axis, double x, double *along,
                                             double *rate)
{
    /* x in intervals from the lower end, clamped to one interval beyond the ends */
    const int at = 2 * (tables->most_axes * form + axis);
    const double last = tables->axes[at], per_unit = tables->scales[at + 1];
    const double wanted = (x - tables->scales[at]) * per_unit;
    const double held = wanted > -1.0 ? (wanted < last + 1.0 ? wanted : last + 1.0) : -1.0;
    /* interval, coordinate in it, and d along / dx, 0 where x is clamped */
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
    /* product over the axes of the cubics c_0 + t (c_1 + t (c_2 + t c_3)) */
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
    /* forwards: values G_a, and slopes (prod_{b<a} G_b) dG_a/dx_a */
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
    /* backwards: slopes times prod_{b>a} G_b */
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

/* Gradient of component j by the axes, from the terms' slopes. */
static inline void fingerfem_gradient(const fingerfem_tables *tables, int form, int j, const double *slopes,
                                      double *gradient)
{
    const int axes = fingerfem_axes(tables, form), terms = fingerfem_terms(tables, form);
    for (int a = 0; a < axes; a++) gradient[a] = fingerfem_component(tables, form, j, slopes + a * terms);
}

/* Clamp a point's tensions to the sampled box; returns whether they were inside. NaN goes to the lower end. */
static inline int fingerfem_hold_tensions(const fingerfem_kernel *kernel, const double *point, double *held)
{
    const int d = kernel->parameters - 1;
    int inside = 1;
    /* inside: as given; outside: the nearer wall */
    for (int j = 0; j < d; j++) {
        held[j] = point[j];
        if (point[j] >= kernel->lower[j] && point[j] <= kernel->upper[j]) continue;
        inside = 0;
        held[j] = point[j] > kernel->upper[j] ? kernel->upper[j] : kernel->lower[j];
    }
    held[d] = point[d];
    return inside;
}

/* Clamp d to the box if the object is touched; returns whether it was inside, or infinite, which is no object. */
static inline int fingerfem_hold_distance(const fingerfem_kernel *kernel, const double *point, double touch_distance,
                                          double *held)
{
    const int d = kernel->parameters - 1;
    /* inside the box; free, so that d does not matter; or clamped */
    if (point[d] >= kernel->lower[d] && point[d] <= kernel->upper[d]) return 1;
    if (point[d] >= touch_distance) return point[d] == INFINITY;
    held[d] = point[d] > kernel->upper[d] ? kernel->upper[d] : kernel->lower[d];
    return 0;
}

/* The path from touch to the nearest distance, D - d_min [m]. The last coordinate s is the share of it, see
 * rom/separated/tabulated.py. */
static inline double fingerfem_whole_path(const fingerfem_kernel *kernel, double touch_distance)
{
    return touch_distance - kernel->lower[kernel->parameters - 1];
}

/* Number of a point's cell, of an even grid in the tensions and in s, which is 0 before contact. */
static inline int fingerfem_cell(const fingerfem_kernel *kernel, const double *point, double touch_distance)
{
    const int d = kernel->parameters - 1, cells = kernel->cells;
    const double path = touch_distance - point[d];
    int found = 0;
    /* coordinates t = (F - lower) / (upper - lower) and s; cells row by row, clamped to the grid */
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

/* Add what contact adds to an answer and its derivatives: u = u_0 + path v(F, s), with path = D - d and
 * s = path / (D - d_min). */
static inline void fingerfem_add_contact(const fingerfem_kernel *kernel, const double *point, double *memory, double *out,
                                         double *jacobian)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, d = p - 1, form = FINGERFEM_CONTACT_FORM, terms = fingerfem_terms(tables, form);
    /* path = D - d, whole = D - d_min, and dD/dF from the free answer */
    const double touch = out[FINGERFEM_TOUCH], path = touch - point[d], whole = fingerfem_whole_path(kernel, touch);
    const double *rising = jacobian + p * FINGERFEM_TOUCH; /* dD/dF */
    double coordinates[FINGERFEM_MOST_PARAMETERS], gradient[FINGERFEM_MOST_PARAMETERS];
    double *products = memory, *slopes = products + terms, *work = slopes + p * terms;
    /* products and slopes of the contact form at (F, s) */
    for (int j = 0; j < d; j++) coordinates[j] = point[j];
    coordinates[d] = path / whole;
    fingerfem_products_and_slopes(tables, form, coordinates, work, products, slopes);
    /* component v of the contact form, with its gradient by (F, s) */
    for (int j = 0; j < fingerfem_components(tables, form); j++) {
        const int row = fingerfem_row(j);
        const double value = fingerfem_component(tables, form, j, products);
        fingerfem_gradient(tables, form, j, slopes, gradient);
        /* du = path dv + v dpath, where ds/dd = -1 / whole and ds/dD = (1 - s) / whole */
        const double by_path = gradient[d] / whole;
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
    /* free answer u_0, D and their derivatives by the tensions */
    int inside = fingerfem_hold_tensions(kernel, point, held);
    for (int j = 0; j < rows * p; j++) jacobian[j] = 0.0;
    fingerfem_products_and_slopes(tables, form, held, work, products, slopes);
    fingerfem_free_answer(kernel, products, out);
    for (int i = 0; i < FINGERFEM_FREE_TOUCH; i++)
        fingerfem_gradient(tables, form, i, slopes, jacobian + p * (FINGERFEM_TIP + i));
    fingerfem_gradient(tables, form, FINGERFEM_FREE_TOUCH, slopes, jacobian + p * FINGERFEM_TOUCH);
    /* past touch: what contact adds, and whether the samples support it */
    const double touch = out[FINGERFEM_TOUCH];
    inside &= fingerfem_hold_distance(kernel, point, touch, held);
    if (held[d] < touch) {
        inside &= kernel->answered[fingerfem_cell(kernel, held, touch)] != 0;
        fingerfem_add_contact(kernel, held, memory, out, jacobian);
    }
    /* derivatives across walls of the box are 0 */
    for (int j = 0; j < p && !inside; j++)
        if (held[j] != point[j])
            for (int i = 0; i < rows; i++) jacobian[p * i + j] = 0.0;
    return inside;
}

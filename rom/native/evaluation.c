/* The compiled answer of a surrogate, see evaluation.h. An exported header has this text in it (rom/c_header.py). */
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

/* How far x lies outside the box of a form, by more than an interval, as a share of the box. */
static inline double fingerfem_outside(const fingerfem_tables *tables, int form, const double *x)
{
    double found = 0.0;
    for (int a = 0; a < fingerfem_axes(tables, form); a++) {
        const int at = 2 * (tables->most_axes * form + a);
        const double last = tables->axes[at], t = (x[a] - tables->scales[at]) * tables->scales[at + 1];
        if ((-1.0 - t) / last > found) found = (-1.0 - t) / last;
        if ((t - last - 1.0) / last > found) found = (t - last - 1.0) / last;
    }
    return found;
}

/* Hold a point's tensions to the trained box; whether they are inside. NaN goes to the lower end. */
static inline int fingerfem_hold_tensions(const fingerfem_kernel *kernel, const double *point, double *held)
{
    const int tensions = kernel->parameters - kernel->has_obstacle;
    int inside = 1;
    for (int j = 0; j < kernel->parameters; j++) held[j] = point[j];
    for (int j = 0; j < tensions; j++)
        if (!(point[j] >= kernel->lower[j] && point[j] <= kernel->upper[j])) {
            inside = 0;
            held[j] = point[j] > kernel->upper[j] ? kernel->upper[j] : kernel->lower[j];
        }
    return inside;
}

/* Hold the distance of a plane that is touched to the box; whether it is inside, or infinite, which is no plane. */
static inline int fingerfem_hold_distance(const fingerfem_kernel *kernel, const double *point, double touch_distance,
                                          double *held)
{
    const int d = kernel->parameters - 1;
    if (point[d] >= kernel->lower[d] && point[d] <= kernel->upper[d]) return 1;
    if (point[d] >= touch_distance) return point[d] == INFINITY;
    held[d] = point[d] > kernel->upper[d] ? kernel->upper[d] : kernel->lower[d];
    return 0;
}

/* The largest of the free form's touch heights: which corner leads. */
static inline int fingerfem_leading(const double *heights, int count)
{
    int leading = 0;
    for (int j = 1; j < count; j++)
        if (heights[j] > heights[leading]) leading = j;
    return leading;
}

/* Cell of the regime lookup of a point in contact: even in the tensions and in the contact path. */
static inline int fingerfem_lookup_cell(const fingerfem_kernel *kernel, const double *point, double touch_distance)
{
    const int d = kernel->parameters - 1, cells = kernel->lookup_cells;
    int found = 0;
    for (int j = 0; j <= d; j++) {
        double t = j < d ? (point[j] - kernel->lower[j]) / (kernel->upper[j] - kernel->lower[j])
                         : (touch_distance - point[d]) / (touch_distance - kernel->nearest + kernel->softening);
        t *= cells;
        found = found * cells + (int)(t > 0.0 ? (t < cells - 1.0 ? t : cells - 1.0) : 0.0);
    }
    return found;
}

/* Whether anything is known at a point in contact. */
static inline int fingerfem_is_known(const fingerfem_kernel *kernel, const double *point, double touch_distance)
{
    return kernel->possible[fingerfem_lookup_cell(kernel, point, touch_distance)] != 0;
}

/* Contact-aligned coordinates, (parameters), of a corner with this touch height, see rom/fit/contact_coordinates.py. */
static inline void fingerfem_coordinates(const fingerfem_kernel *kernel, const double *point, double height,
                                         double *coordinates)
{
    const int d = kernel->parameters - 1;
    for (int j = 0; j < d; j++) coordinates[j] = point[j];
    coordinates[d] = (height - point[d]) / (height - kernel->nearest + kernel->softening);
}

/* Whether a regime would begin at a corner that does not touch yet. */
static inline int fingerfem_too_early(const fingerfem_kernel *kernel, int regime, const double *point,
                                      const double *heights)
{
    return kernel->begins[regime] && heights[kernel->corners[regime]] <= point[kernel->parameters - 1];
}

/* How well the conditions of a regime hold at a point: the least of them over its size, and not outside its box; not at
 * all where it would begin too early or the plane would pull. */
static inline double fingerfem_holds(const fingerfem_kernel *kernel, int regime, const double *point,
                                     const double *heights, double *whole)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int form = 1 + regime, components = fingerfem_components(tables, form);
    const int conditions = components - FINGERFEM_CONDITIONS - kernel->has_pad;
    if (fingerfem_too_early(kernel, regime, point, heights)) return -INFINITY;
    double coordinates[FINGERFEM_MOST_PARAMETERS];
    fingerfem_coordinates(kernel, point, heights[kernel->corners[regime]], coordinates);
    double worst = -fingerfem_outside(tables, form, coordinates);
    fingerfem_products(tables, form, coordinates, whole);
    if (fingerfem_component(tables, form, FINGERFEM_FORCE, whole) < 0.0) return -INFINITY;
    for (int j = 0; j < conditions; j++) {
        const double size = kernel->sizes[kernel->most_conditions * regime + j];
        const double own = fingerfem_component(tables, form, FINGERFEM_CONDITIONS + j, whole) / size;
        if (own < worst) worst = own;
    }
    return worst;
}

/* Regime at a point in contact: the one of the lookup if all its conditions hold, or no other is possible; else the
 * first possible one whose do; if none has, the one that fails least. Where the lookup's would begin too early, any is
 * possible. */
static inline int fingerfem_regime(const fingerfem_kernel *kernel, const double *point, const double *heights,
                                   double touch_distance, double *memory)
{
    const int cell = fingerfem_lookup_cell(kernel, point, touch_distance), first = kernel->lookup[cell];
    const int any = fingerfem_too_early(kernel, first, point, heights);
    const uint64_t one = 1, possible = any ? ~(uint64_t)0 : kernel->possible[cell];
    if (possible == one << first) return first;
    int best = first;
    double least = fingerfem_holds(kernel, first, point, heights, memory);
    for (int r = 0; r < kernel->regimes && least < 0.0; r++) {
        if (r == first || !(possible >> r & one)) continue;
        const double own = fingerfem_holds(kernel, r, point, heights, memory);
        if (own > least) {
            best = r;
            least = own;
        }
    }
    return best;
}

/* Row of an answer that component j of a regime's form adds to, or -1: tip and force first, the pad's pressure last. */
static inline int fingerfem_row(const fingerfem_kernel *kernel, int regime, int j)
{
    if (j < FINGERFEM_CONDITIONS) return FINGERFEM_TIP + j;
    const int last = fingerfem_components(&kernel->tables, 1 + regime) - 1;
    return kernel->has_pad && j == last ? FINGERFEM_PAD : -1;
}

/* A plane never pulls: a fit may swing below zero just after touch. */
static inline void fingerfem_never_pull(const fingerfem_kernel *kernel, double *out)
{
    if (out[FINGERFEM_FORCE] < 0.0) out[FINGERFEM_FORCE] = 0.0;
    if (kernel->has_pad && out[FINGERFEM_PAD] < 0.0) out[FINGERFEM_PAD] = 0.0;
}

/* Add what contact does to an answer and its derivatives; rising are a regime's touch height's, (tensions). */
static inline void fingerfem_add_contact(const fingerfem_kernel *kernel, int regime, const double *point, double height,
                                         const double *rising, double *memory, double *out, double *jacobian)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, d = p - 1, form = 1 + regime, terms = fingerfem_terms(tables, form);
    const double path = height - point[d], whole_path = height - kernel->nearest + kernel->softening;
    const double share = path / whole_path, size = kernel->begins[regime] ? path : 1.0;
    const double growth = kernel->begins[regime] ? 1.0 : 0.0;
    double coordinates[FINGERFEM_MOST_PARAMETERS], gradient[FINGERFEM_MOST_PARAMETERS];
    double *products = memory, *slopes = products + terms, *work = slopes + p * terms;
    fingerfem_coordinates(kernel, point, height, coordinates);
    fingerfem_products_and_slopes(tables, form, coordinates, work, products, slopes);
    for (int j = 0; j < fingerfem_components(tables, form); j++) {
        const int row = fingerfem_row(kernel, regime, j);
        if (row < 0) continue;
        const double value = fingerfem_component(tables, form, j, products);
        fingerfem_gradient(tables, form, j, slopes, gradient);
        const double by_path = gradient[d] / whole_path;
        double *own = jacobian + p * row;
        out[row] += size * value;
        for (int k = 0; k < d; k++)
            own[k] += size * (gradient[k] + by_path * (1.0 - share) * rising[k]) + growth * value * rising[k];
        own[d] -= size * by_path + growth * value;
    }
    fingerfem_never_pull(kernel, out);
}

/* The answer without contact: rows that are not known are NaN. */
static inline void fingerfem_free_answer(const fingerfem_kernel *kernel, const double *products, double *out)
{
    for (int i = 0; i < FINGERFEM_HEIGHTS; i++)
        out[FINGERFEM_TIP + i] = fingerfem_component(&kernel->tables, 0, i, products);
    out[FINGERFEM_FORCE] = 0.0;
    out[FINGERFEM_TOUCH] = NAN;
    if (kernel->has_pad) out[FINGERFEM_PAD] = 0.0;
}

FINGERFEM_API int fingerfem_answer(const fingerfem_kernel *kernel, const double *point, double *memory, double *out,
                                   double *jacobian)
{
    const fingerfem_tables *tables = &kernel->tables;
    const int p = kernel->parameters, terms = fingerfem_terms(tables, 0);
    const int corners = fingerfem_components(tables, 0) - FINGERFEM_HEIGHTS;
    const int rows = FINGERFEM_PAD + kernel->has_pad;
    double held[FINGERFEM_MOST_PARAMETERS], rising[FINGERFEM_MOST_PARAMETERS], *products = memory, *slopes = memory + terms;
    double *heights = slopes + fingerfem_axes(tables, 0) * terms, *work = heights + (corners > 0 ? corners : 0);
    int inside = fingerfem_hold_tensions(kernel, point, held);
    for (int j = 0; j < rows * p; j++) jacobian[j] = 0.0;
    fingerfem_products_and_slopes(tables, 0, held, work, products, slopes);
    fingerfem_free_answer(kernel, products, out);
    for (int i = 0; i < FINGERFEM_HEIGHTS; i++)
        fingerfem_gradient(tables, 0, i, slopes, jacobian + p * (FINGERFEM_TIP + i));
    if (kernel->has_obstacle) {
        for (int j = 0; j < corners; j++) heights[j] = fingerfem_component(tables, 0, FINGERFEM_HEIGHTS + j, products);
        const int leading = fingerfem_leading(heights, corners);
        out[FINGERFEM_TOUCH] = heights[leading];
        fingerfem_gradient(tables, 0, FINGERFEM_HEIGHTS + leading, slopes, jacobian + p * FINGERFEM_TOUCH);
        inside &= fingerfem_hold_distance(kernel, point, heights[leading], held);
        if (held[p - 1] < heights[leading]) {
            inside &= fingerfem_is_known(kernel, held, heights[leading]);
            const int regime = fingerfem_regime(kernel, held, heights, heights[leading], work);
            const int corner = kernel->corners[regime];
            fingerfem_gradient(tables, 0, FINGERFEM_HEIGHTS + corner, slopes, rising);
            fingerfem_add_contact(kernel, regime, held, heights[corner], rising, work, out, jacobian);
        }
    }
    for (int j = 0; j < p && !inside; j++)
        if (held[j] != point[j])
            for (int i = 0; i < rows; i++) jacobian[p * i + j] = 0.0;
    return inside;
}

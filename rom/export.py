"""A model as one C99 header: tip, contact force, touch distance and their derivatives, without allocation.

The same tables and loops as rom.tables and rom.kernel, whose functions its functions are named after.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from rom.surrogate import ModelError, Surrogate

PER_LINE = 4  # numbers


def header(model: Surrogate, name: str = "finger") -> str:
    """The text of a header whose names begin with `name`.

    Raises:
        ModelError: the name is no C identifier.
    """
    if not re.fullmatch(r"[A-Za-z]\w*", name):
        raise ModelError(f"name must be a C identifier, got {name}")
    kernel = model.kernel
    tables = kernel.tables
    axes = tables.axes.shape[1]
    regimes = len(model.regimes)
    parts = [
        PREAMBLE.format(
            title=re.sub(r"[^\w .,:()-]", " ", str(model.scene["name"])),
            parameters="\n".join(
                f"      {one['name']} [{one['unit']}] from {one['lower']:g} to {one['upper']:g}"
                for one in model.parameters
            ),
            fingerprint=model.provenance["fingerprint"],
        ),
        f"#define @_PARAMETERS {len(model.parameters)}",
        f"#define @_TENSIONS {len(model.parameters) - model.has_obstacle}",
        f"#define @_OBSTACLE {int(model.has_obstacle)}",
        f"#define @_AXES {axes}",
        f"#define @_FORMS {len(tables.forms)}",
        f"#define @_TERMS {int(tables.forms[:, 1].max())}",
        f"#define @_COMPONENTS {int(tables.forms[:, 2].max())}",
        f"#define @_REGIMES {max(regimes, 1)}",
        f"#define @_CONDITIONS {max(kernel.sizes.shape[1] if regimes else 0, 1)}",
        f"#define @_PAD {int(kernel.has_pad)} /* the pad's pressure is among the forms, but not answered here */",
        f"#define @_CELLS {kernel.cells}",
        _array("double", "data", tables.data),
        _array("int", "form", tables.forms),
        _array("int", "axis", tables.axes),
        _array("double", "scale", tables.scales),
        _array("double", "lower", kernel.lower),
        _array("double", "upper", kernel.upper),
    ]
    if model.has_obstacle:
        parts += [
            _array("int", "corner", kernel.corners),
            _array("int", "begins", kernel.begins.astype(int)),
            _array("double", "size", kernel.sizes if kernel.sizes.size else np.ones((regimes, 1))),
            _array("unsigned char", "map", kernel.map),
            _array("unsigned long long", "near", kernel.near, "ULL"),
            f"static const double @_nearest = {float(kernel.way[0])!r}, @_soft = {float(kernel.way[1])!r};",
        ]
    text = "\n".join([*parts, FORMS, CONTACT if model.has_obstacle else "", ANSWER])
    return text.replace("@", name).replace("$GUARD", f"{name.upper()}_H")


def export(model: Surrogate, path: Path) -> None:
    """Write the header; its names begin with the file's name."""
    path.write_text(header(model, path.stem))


def _array(kind: str, name: str, values: np.ndarray, suffix: str = "") -> str:
    flat = [f"{float(x)!r}" if kind == "double" else f"{int(x)}{suffix}" for x in values.ravel()]
    lines = [", ".join(flat[k : k + PER_LINE]) for k in range(0, len(flat), PER_LINE)]
    return f"static const {kind} @_{name}[{max(len(flat), 1)}] = {{\n" + ",\n".join(lines or ["0"]) + "};"


PREAMBLE = """/* {title}: a fingerfem surrogate as C99. Written by python3 -m rom export.

   int @_answer(const double point[@_PARAMETERS], double out[5], double jacobian[5 * @_PARAMETERS]);

   point:
{parameters}
   out: tip displacement x, y, z [m], contact force [N], touch distance [m] (NAN without an obstacle).
   jacobian: their derivatives by the parameters, row by row.
   It returns 1 if the point is inside the trained box, 0 if not: the answer is then that of the nearest point inside,
   and derivatives across its walls are 0. A plane that is not touched may stand anywhere. It allocates nothing, keeps
   no state and calls no library. Trained on scene {fingerprint}.
*/
#ifndef $GUARD
#define $GUARD
#include <math.h>
"""

FORMS = """
/* Products of form f's one-dimensional functions at x, and their derivatives by every axis. */
static inline void @_products(int f, const double *x, double *whole, double slopes[][@_TERMS])
{
    const int axes = @_form[4 * f], terms = @_form[4 * f + 1];
    for (int k = 0; k < terms; k++) {
        whole[k] = 1.0;
        for (int a = 0; a < axes; a++) slopes[a][k] = 1.0;
    }
    for (int a = 0; a < axes; a++) {
        const int at = 2 * (@_AXES * f + a);
        const double last = (double)@_axis[at], rate = @_scale[at + 1];
        const double raw = (x[a] - @_scale[at]) * rate;
        const int within = raw >= -1.0 && raw <= last + 1.0;
        double t = raw < -1.0 ? -1.0 : raw > last + 1.0 ? last + 1.0 : raw;
        const double low = t < 0.0 ? 0.0 : t > last - 1.0 ? last - 1.0 : t;
        const int i = (int)low;
        const double *c = @_data + @_axis[at + 1] + 4 * terms * i;
        t -= (double)i;
        for (int k = 0; k < terms; k++) {
            const double c0 = c[k], c1 = c[terms + k], c2 = c[2 * terms + k], c3 = c[3 * terms + k];
            const double value = c0 + t * (c1 + t * (c2 + t * c3));
            slopes[a][k] *= within ? (c1 + t * (2 * c2 + t * 3 * c3)) * rate : 0.0;
            whole[k] *= value;
            for (int b = 0; b < axes; b++) if (b != a) slopes[b][k] *= value;
        }
    }
}

/* Component j of form f's modes, weighted by terms and added up. */
static inline double @_weighted(int f, const double *weights, int j)
{
    const int terms = @_form[4 * f + 1];
    const double *modes = @_data + @_form[4 * f + 3] + j * terms;
    double found = 0.0;
    for (int k = 0; k < terms; k++) found += weights[k] * modes[k];
    return found;
}
"""

CONTACT = """
/* How far x lies outside the box of form f, by more than an interval, as a share of the box. */
static inline double @_outside(int f, const double *x)
{
    double found = 0.0;
    for (int a = 0; a < @_form[4 * f]; a++) {
        const int at = 2 * (@_AXES * f + a);
        const double last = (double)@_axis[at], t = (x[a] - @_scale[at]) * @_scale[at + 1];
        if ((-1.0 - t) / last > found) found = (-1.0 - t) / last;
        if ((t - last - 1.0) / last > found) found = (t - last - 1.0) / last;
    }
    return found;
}

/* Values of regime r's form, its products and their slopes; returns how much its conditions fail, 0 if they hold. */
static inline double @_try(int r, const double *point, const double *heights, double *value, double *whole,
                           double slopes[][@_TERMS])
{
    const double height = heights[@_corner[r]];
    double where[@_PARAMETERS], worst;
    for (int j = 0; j < @_TENSIONS; j++) where[j] = point[j];
    where[@_TENSIONS] = (height - point[@_TENSIONS]) / (height - @_nearest + @_soft);
    @_products(1 + r, where, whole, slopes);
    worst = -@_outside(1 + r, where);
    for (int j = 0; j < @_form[4 * (1 + r) + 2] - @_PAD; j++) {
        value[j] = @_weighted(1 + r, whole, j);
        if (j > 3 && value[j] / @_size[@_CONDITIONS * r + j - 4] < worst)
            worst = value[j] / @_size[@_CONDITIONS * r + j - 4];
    }
    return worst;
}

/* Cell of the map in which a point in contact lies. */
static inline int @_cell(const double *point, double touch)
{
    int found = 0;
    for (int j = 0; j < @_PARAMETERS; j++) {
        double t = j < @_TENSIONS ? (point[j] - @_lower[j]) / (@_upper[j] - @_lower[j])
                                  : (touch - point[j]) / (touch - @_nearest + @_soft);
        t *= @_CELLS;
        t = t < 0.0 ? 0.0 : t > @_CELLS - 1.0 ? @_CELLS - 1.0 : t;
        found = found * @_CELLS + (int)t;
    }
    return found;
}

/* Add what contact does to outputs and derivatives. */
static inline void @_add(const double *point, const double *heights, double rising[][@_TENSIONS], double *out,
                         double *jacobian)
{
    const int cell = @_cell(point, out[4]), first = @_map[cell];
    double value[@_COMPONENTS], whole[@_TERMS], slopes[@_AXES][@_TERMS];
    int best = first;
    double least = @_try(first, point, heights, value, whole, slopes);
    for (int r = 0; r < @_REGIMES && least < 0.0; r++) {
        if (r == first || !(@_near[cell] >> r & 1ULL)) continue;
        const double held = @_try(r, point, heights, value, whole, slopes);
        if (held > least) { best = r; least = held; }
    }
    (void)@_try(best, point, heights, value, whole, slopes);
    const int corner = @_corner[best], begins = @_begins[best];
    const double past = heights[corner] - point[@_TENSIONS], full = heights[corner] - @_nearest + @_soft;
    const double s = past / full, size = begins ? past : 1.0, grows = begins ? 1.0 : 0.0;
    for (int i = 0; i < 4; i++) {
        double *row = jacobian + @_PARAMETERS * i;
        const double by_s = @_weighted(1 + best, slopes[@_TENSIONS], i) / full;
        out[i] += size * value[i];
        for (int k = 0; k < @_TENSIONS; k++)
            row[k] += size * (@_weighted(1 + best, slopes[k], i) + by_s * (1.0 - s) * rising[corner][k])
                      + grows * value[i] * rising[corner][k];
        row[@_TENSIONS] -= size * by_s + grows * value[i];
    }
    if (out[3] < 0.0) out[3] = 0.0;
}
"""

ANSWER = """
static inline int @_answer(const double point[@_PARAMETERS], double out[5], double jacobian[5 * @_PARAMETERS])
{
    double held[@_PARAMETERS], whole[@_TERMS], slopes[@_AXES][@_TERMS];
    int inside = 1;
    for (int j = 0; j < @_PARAMETERS; j++) held[j] = point[j];
    for (int j = 0; j < @_TENSIONS; j++)
        if (!(point[j] >= @_lower[j] && point[j] <= @_upper[j])) {
            inside = 0;
            held[j] = point[j] > @_upper[j] ? @_upper[j] : @_lower[j];
        }
    for (int j = 0; j < 5 * @_PARAMETERS; j++) jacobian[j] = 0.0;
    @_products(0, held, whole, slopes);
    for (int i = 0; i < 3; i++) {
        out[i] = @_weighted(0, whole, i);
        for (int k = 0; k < @_TENSIONS; k++) jacobian[@_PARAMETERS * i + k] = @_weighted(0, slopes[k], i);
    }
    out[3] = 0.0;
    out[4] = NAN;
#if @_OBSTACLE
    {
        const int d = @_TENSIONS, count = @_form[2] - 3;
        double heights[@_COMPONENTS], rising[@_COMPONENTS][@_TENSIONS];
        int first = 0;
        for (int j = 0; j < count; j++) {
            heights[j] = @_weighted(0, whole, 3 + j);
            for (int k = 0; k < @_TENSIONS; k++) rising[j][k] = @_weighted(0, slopes[k], 3 + j);
            if (heights[j] > heights[first]) first = j;
        }
        out[4] = heights[first];
        for (int k = 0; k < @_TENSIONS; k++) jacobian[@_PARAMETERS * 4 + k] = rising[first][k];
        if (!(point[d] >= out[4]) && !(point[d] >= @_lower[d] && point[d] <= @_upper[d])) {
            inside = 0;
            held[d] = point[d] > @_upper[d] ? @_upper[d] : @_lower[d];
        }
        if (held[d] < out[4]) @_add(held, heights, rising, out, jacobian);
    }
#endif
    if (!inside)
        for (int j = 0; j < @_PARAMETERS; j++)
            if (held[j] != point[j])
                for (int i = 0; i < 5; i++) jacobian[@_PARAMETERS * i + j] = 0.0;
    return inside;
}
#endif
"""

"""The compiled answer: separated forms, contact regimes and their coordinates, as plain arrays and plain loops.

rom.export writes the same in C: what changes here changes there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from rom.separated import Separated

TIP, FORCE, TOUCH = 0, 3, 4  # where they are among the outputs
OUTPUTS = 5
WALK = 6  # regimes tried at most for one answer


class Tables(NamedTuple):
    """Separated forms, one after another."""

    data: np.ndarray  # pieces of all axes and modes of all forms
    forms: np.ndarray  # (forms, 4): axes, terms, outputs, where its modes are in `data`
    axes: np.ndarray  # (forms, axes, 2): intervals, where their pieces are in `data`
    scales: np.ndarray  # (forms, axes, 2): lower end, intervals per unit


class Kernel(NamedTuple):
    """What the compiled answer reads.

    Form 0 is the free one: tip [m], then heights [m] of what may touch first. Form 1 + r is that of regime r: what
    contact adds to the tip [m], contact force [N] (both per way past the corner [1/m] where the regime begins at touch),
    then the regime's conditions, which hold while they are positive.
    """

    tables: Tables
    lower: np.ndarray  # of the trained box
    upper: np.ndarray
    has_obstacle: bool
    corners: np.ndarray  # (regimes,): which height is the regime's own
    begins: np.ndarray  # (regimes,): whether the regime begins at touch
    targets: np.ndarray  # (regimes, most conditions): regime that follows where one fails; -1 for none
    sizes: np.ndarray  # (regimes, most conditions): what each is large or small against
    map: np.ndarray  # regime to begin with, by cell, flat
    near: np.ndarray  # regimes that are possible there, by cell, a bit each
    cells: int  # of the map along every parameter
    way: np.ndarray  # nearest distance and softening of the coordinate [m]


def tables(forms: Sequence[Separated]) -> Tables:
    """Forms as plain arrays."""
    axes = max(len(form.factors) for form in forms)
    parts: list[np.ndarray] = []
    heads, spans, scales = np.zeros((len(forms), 4), np.int64), np.zeros((len(forms), axes, 2), np.int64), None
    scales = np.ones((len(forms), axes, 2))
    offset = 0
    for f, form in enumerate(forms):
        for a, pieces in enumerate(form.pieces):
            spans[f, a] = len(pieces), offset
            scales[f, a] = form.lower[a], len(pieces) / (form.upper[a] - form.lower[a])
            parts.append(pieces.ravel())
            offset += pieces.size
        heads[f] = len(form.factors), form.terms, len(form.modes), offset
        parts.append(np.ascontiguousarray(form.modes.T).ravel())
        offset += form.modes.size
    return Tables(np.concatenate(parts), heads, spans, scales)


@njit(cache=True)
def evaluate(tables: Tables, f: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value, shape (m,), and gradient, shape (m, axes), of form f at x, shape (axes,).

    Outside an axis the end pieces go on for one interval, and then stay: whoever calls decides what lies inside.
    """
    axes, terms, m, at = tables.forms[f, 0], tables.forms[f, 1], tables.forms[f, 2], tables.forms[f, 3]
    g = np.empty((axes, terms))
    dg = np.empty((axes, terms))
    for a in range(axes):
        t = (x[a] - tables.scales[f, a, 0]) * tables.scales[f, a, 1]
        last = float(tables.axes[f, a, 0])
        slope = tables.scales[f, a, 1] if -1.0 <= t <= last + 1.0 else 0.0
        t = min(max(t, -1.0), last + 1.0)
        i = int(min(max(t, 0.0), last - 1.0))
        t -= i
        c = tables.axes[f, a, 1] + 4 * terms * i
        for k in range(terms):
            c0, c1 = tables.data[c + k], tables.data[c + terms + k]
            c2, c3 = tables.data[c + 2 * terms + k], tables.data[c + 3 * terms + k]
            g[a, k] = c0 + t * (c1 + t * (c2 + t * c3))
            dg[a, k] = (c1 + t * (2 * c2 + t * 3 * c3)) * slope
    value = np.zeros(m)
    gradient = np.zeros((m, axes))
    weights = np.empty(axes)
    for k in range(terms):
        whole = 1.0
        for a in range(axes):
            whole *= g[a, k]
            weights[a] = dg[a, k]
            for b in range(axes):
                if b != a:
                    weights[a] *= g[b, k]
        for j in range(m):
            mode = tables.data[at + k * m + j]
            value[j] += whole * mode
            for a in range(axes):
                gradient[j, a] += weights[a] * mode
    return value, gradient


@njit(cache=True)
def cell(kernel: Kernel, point: np.ndarray, touch_distance: float) -> int:
    """Cell of the map in which a point in contact lies: even in the tensions and in the way past the touch distance."""
    p, found = len(point), 0
    for j in range(p):
        if j < p - 1:
            t = (point[j] - kernel.lower[j]) / (kernel.upper[j] - kernel.lower[j])
        else:
            t = (touch_distance - point[j]) / (touch_distance - kernel.way[0] + kernel.way[1])
        found = found * kernel.cells + int(min(max(t * kernel.cells, 0.0), kernel.cells - 1.0))
    return found


@njit(cache=True)
def cells_of(kernel: Kernel, points: np.ndarray, touch_distances: np.ndarray) -> np.ndarray:
    """Cells of many points, shape (n,)."""
    found = np.empty(len(points), np.int64)
    for i in range(len(points)):
        found[i] = cell(kernel, points[i], touch_distances[i])
    return found


@njit(cache=True)
def coordinates(kernel: Kernel, r: int, point: np.ndarray, height: float) -> np.ndarray:
    """Contact-aligned coordinates of regime r, whose corner has this height in free space, see rom.chart."""
    moved = point.copy()
    p = len(point)
    moved[p - 1] = (height - point[p - 1]) / (height - kernel.way[0] + kernel.way[1])
    return moved


@njit(cache=True)
def regime_at(
    kernel: Kernel, point: np.ndarray, free: np.ndarray, touch_distance: float
) -> tuple[int, np.ndarray, np.ndarray]:
    """Regime at a point in contact, and value and gradient of its form there.

    From the regime that the map says, it goes on to the next while a condition fails, the worst first, but to none twice
    and only to those that the map knows nearby.
    """
    place = cell(kernel, point, touch_distance)
    r, near = kernel.map[place], kernel.near[place]
    before = np.zeros(len(kernel.corners), np.bool_)
    value, gradient = evaluate(kernel.tables, 1 + r, coordinates(kernel, r, point, free[3 + kernel.corners[r]]))
    for _ in range(WALK):
        before[r] = True
        worst, follows = 0.0, -1
        for j in range(len(value) - 4):
            target = kernel.targets[r, j]
            if target >= 0 and value[4 + j] < worst * kernel.sizes[r, j] and not before[target] and near >> target & 1:
                worst, follows = value[4 + j] / kernel.sizes[r, j], target
        if follows < 0:
            break
        r = follows
        value, gradient = evaluate(kernel.tables, 1 + r, coordinates(kernel, r, point, free[3 + kernel.corners[r]]))
    return r, value, gradient


@njit(cache=True)
def answer(kernel: Kernel, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool, int]:
    """Outputs, shape (5,), their derivatives by the parameters, shape (5, p), whether inside, and the regime (-1: free).

    A point outside is moved to the nearest inside; derivatives across a wall are then zero.
    """
    p = len(point)
    tensions = p - 1 if kernel.has_obstacle else p
    inside, r = True, -1
    held = point.copy()
    for j in range(tensions):
        if not (kernel.lower[j] <= point[j] <= kernel.upper[j]):
            inside = False
            held[j] = kernel.upper[j] if point[j] > kernel.upper[j] else kernel.lower[j]  # nan goes low
    free, rising = evaluate(kernel.tables, 0, held[:tensions])
    out = np.zeros(OUTPUTS)
    jacobian = np.zeros((OUTPUTS, p))
    out[:3] = free[:3]
    jacobian[:3, :tensions] = rising[:3]
    out[TOUCH] = np.nan
    if kernel.has_obstacle:
        first = 3
        for j in range(4, len(free)):
            if free[j] > free[first]:
                first = j
        out[TOUCH] = free[first]
        jacobian[TOUCH, :tensions] = rising[first]
        if not point[p - 1] >= out[TOUCH]:  # a plane that is not touched may stand anywhere: the free answer is exact
            if not (kernel.lower[p - 1] <= point[p - 1] <= kernel.upper[p - 1]):
                inside = False
                held[p - 1] = kernel.upper[p - 1] if point[p - 1] > kernel.upper[p - 1] else kernel.lower[p - 1]
            if held[p - 1] < out[TOUCH]:
                r = _contact(kernel, held, free, rising, out, jacobian)
    if not inside:
        for j in range(p):
            if held[j] != point[j]:
                jacobian[:, j] = 0.0
    return out, jacobian, inside, r


@njit(cache=True)
def _contact(
    kernel: Kernel, point: np.ndarray, free: np.ndarray, rising: np.ndarray, out: np.ndarray, jacobian: np.ndarray
) -> int:
    """Add what contact does at a point that touches; returns the regime."""
    p = len(point)
    r, value, gradient = regime_at(kernel, point, free, out[TOUCH])
    corner = 3 + kernel.corners[r]
    height = free[corner]
    past, whole = height - point[p - 1], height - kernel.way[0] + kernel.way[1]
    s = past / whole
    for i in range(4):
        size = past if kernel.begins[r] else 1.0
        out[TIP + i] += size * value[i]
        by_s = gradient[i, p - 1] / whole
        for k in range(p - 1):
            jacobian[i, k] += size * (gradient[i, k] + by_s * (1.0 - s) * rising[corner, k])
            if kernel.begins[r]:
                jacobian[i, k] += value[i] * rising[corner, k]
        jacobian[i, p - 1] -= size * by_s
        if kernel.begins[r]:
            jacobian[i, p - 1] -= value[i]
    if out[FORCE] < 0.0:  # a fit may swing below zero just after touch; a plane never pulls
        out[FORCE] = 0.0
    return r


@njit(cache=True)
def answers(kernel: Kernel, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Outputs, shape (n, 5), whether inside, shape (n,), and regimes, shape (n,), of points, shape (n, p)."""
    out = np.empty((len(points), OUTPUTS))
    inside = np.empty(len(points), np.bool_)
    regimes = np.empty(len(points), np.int64)
    for i in range(len(points)):
        out[i], _, inside[i], regimes[i] = answer(kernel, points[i])
    return out, inside, regimes

"""The compiled answer: separated forms, contact regimes and their coordinates, as plain arrays and plain loops.

rom.export writes the same in C: what changes here changes there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom.compiled import compiled
from rom.tables import (
    Tables,
    outside,
    room_for,
    write_gradient,
    write_products_and_slopes,
    write_values,
    write_weighted,
)

TIP, FORCE, TOUCH, PAD = 0, 3, 4, 5  # where they are among the outputs; the pad only where a model knows it


class Kernel(NamedTuple):
    """What the compiled answer reads.

    Form 0 is the free one: tip [m], then heights [m] of what may touch first. Form 1 + r is that of regime r: what
    contact adds to the tip [m], contact force [N], then the regime's conditions, which hold while they are positive,
    then the pad's pressure [Pa] if the model knows it. All but conditions are per way past the corner [1/m] where the
    regime begins at touch.
    """

    tables: Tables
    lower: np.ndarray  # of the trained box
    upper: np.ndarray
    has_obstacle: bool
    has_pad: bool
    corners: np.ndarray  # (regimes,): which height is the regime's own
    begins: np.ndarray  # (regimes,): whether the regime begins at touch
    sizes: np.ndarray  # (regimes, most conditions): what each is large or small against
    map: np.ndarray  # regime to begin with, by cell, flat
    near: np.ndarray  # other regimes that are possible there, by cell, a bit each
    cells: int  # of the map along every parameter
    way: np.ndarray  # nearest distance and softening of the coordinate [m]


class Workspace(NamedTuple):
    """Room that the compiled answer writes into: nothing is allocated from one point to the next."""

    held: np.ndarray  # the point, held to the box, shape (p,)
    where: np.ndarray  # the same in a regime's coordinates, shape (p,)
    products: tuple[np.ndarray, np.ndarray, np.ndarray]  # see rom.tables.room_for
    free: np.ndarray  # values of the free form, shape (3 + heights,)
    rising: np.ndarray  # derivatives of one of them by the tensions, shape (tensions,)
    turning: np.ndarray  # derivatives of a regime's form by its coordinates, shape (p,)
    added: np.ndarray  # of the form of the regime that holds, shape (most outputs,)
    tried: np.ndarray  # of a regime that is tried, of the same shape


@compiled
def outputs(kernel: Kernel) -> int:
    """Number of the outputs."""
    return 6 if kernel.has_pad else 5


@compiled(allocates=True)
def workspace(kernel: Kernel) -> Workspace:
    """Room for one kernel."""
    p, forms = len(kernel.lower), kernel.tables.forms
    free, added = forms[0, 2], max(forms[:, 2].max(), 4)
    return Workspace(
        np.empty(p),
        np.empty(p),
        room_for(kernel.tables),
        np.empty(free),
        np.empty(forms[0, 0]),
        np.empty(p),
        np.empty(added),
        np.empty(added),
    )


@compiled
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


@compiled
def to_coordinates(kernel: Kernel, point: np.ndarray, height: float, where: np.ndarray) -> None:
    """Write contact-aligned coordinates into `where`, of a corner with this height in free space, see rom.chart."""
    d = len(point) - 1
    for j in range(d):
        where[j] = point[j]
    where[d] = (height - point[d]) / (height - kernel.way[0] + kernel.way[1])


@compiled(allocates=True)
def coordinates(kernel: Kernel, point: np.ndarray, height: float) -> np.ndarray:
    """Those coordinates, shape (p,)."""
    where = np.empty(len(point))
    to_coordinates(kernel, point, height, where)
    return where


@compiled
def regime_at(kernel: Kernel, point: np.ndarray, touch_distance: float, room: Workspace) -> int:
    """Regime at a point in contact; `room.free` has the heights there, `room.added` is given the values of its form.

    It is the one that the map says, if all its conditions hold; else the first of those nearby whose do. If none has
    all its conditions, in its own box, it is the one that fails least.
    """
    place = cell(kernel, point, touch_distance)
    r, near = kernel.map[place], kernel.near[place]
    if near == np.uint64(1) << np.uint64(r):  # no other is possible: its conditions need not be known
        to_coordinates(kernel, point, room.free[3 + kernel.corners[r]], room.where)
        some = len(room.added) if kernel.has_pad else 4
        write_values(kernel.tables, 1 + r, room.where, room.products[0], room.added[:some])
        return r
    best, least = r, -np.inf
    for k in range(-1, len(kernel.corners)):
        other = r if k < 0 else k
        if k == r or (k >= 0 and not near & (np.uint64(1) << np.uint64(k))):
            continue
        to_coordinates(kernel, point, room.free[3 + kernel.corners[other]], room.where)
        write_values(kernel.tables, 1 + other, room.where, room.products[0], room.tried)
        worst = -outside(kernel.tables, 1 + other, room.where)
        for j in range(kernel.tables.forms[1 + other, 2] - 4 - kernel.has_pad):
            worst = min(worst, room.tried[4 + j] / kernel.sizes[other, j])
        if worst > least:
            best, least = other, worst
            for j in range(len(room.added)):
                room.added[j] = room.tried[j]
        if worst >= 0.0:
            break
    return best


@compiled(allocates=True)
def answer(kernel: Kernel, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Outputs, shape (m,), their derivatives by the parameters, shape (m, p), and whether the point is inside.

    The m = 5 outputs are tip, contact force and touch distance; a sixth is the pad's pressure, if the model knows it.

    A point outside is moved to the nearest inside; derivatives across a wall are then zero.
    """
    m = outputs(kernel)
    out, jacobian = np.empty(m), np.empty((m, len(point)))
    return out, jacobian, write_answer_and_jacobian(kernel, point, workspace(kernel), out, jacobian)


@compiled
def write_answer_and_jacobian(
    kernel: Kernel, point: np.ndarray, room: Workspace, out: np.ndarray, jacobian: np.ndarray
) -> bool:
    """Write outputs and derivatives; whether the point is inside."""
    p, held, free, rising, tables = len(point), room.held, room.free, room.rising, kernel.tables
    whole, own, slopes = room.products
    inside = hold_tensions(kernel, point, held)
    write_products_and_slopes(tables, 0, held, whole, own, slopes)
    write_weighted(tables, 0, whole, free)
    jacobian[:] = 0.0
    for i in range(3):
        out[TIP + i] = free[i]
        write_gradient(tables, 0, slopes, i, jacobian[TIP + i])
    out[FORCE], out[TOUCH], out[-1] = 0.0, np.nan, 0.0 if kernel.has_pad else np.nan
    if kernel.has_obstacle:
        first = 3 + leading(free)
        out[TOUCH] = free[first]
        write_gradient(tables, 0, slopes, first, jacobian[TOUCH])
        inside = hold_distance(kernel, point, held, out[TOUCH]) and inside
        if held[p - 1] < out[TOUCH]:
            r = regime_at(kernel, held, out[TOUCH], room)
            write_gradient(tables, 0, slopes, 3 + kernel.corners[r], rising)
            _add(kernel, r, room, out, jacobian)
    if not inside:
        for j in range(p):
            if held[j] != point[j]:
                jacobian[:, j] = 0.0
    return inside


@compiled
def leading(free: np.ndarray) -> int:
    """Which height leads."""
    first = 0
    for j in range(1, len(free) - 3):
        if free[3 + j] > free[3 + first]:
            first = j
    return first


@compiled
def hold_tensions(kernel: Kernel, point: np.ndarray, held: np.ndarray) -> bool:
    """Write the point with its tensions held to the box into `held`; whether they are inside."""
    inside = True
    for j in range(len(point)):
        held[j] = point[j]
        if kernel.has_obstacle and j == len(point) - 1:
            break
        if not (kernel.lower[j] <= point[j] <= kernel.upper[j]):
            inside = False
            held[j] = kernel.upper[j] if point[j] > kernel.upper[j] else kernel.lower[j]  # nan goes low
    return inside


@compiled
def hold_distance(kernel: Kernel, point: np.ndarray, held: np.ndarray, touch_distance: float) -> bool:
    """Hold the plane's distance to the box, in `held`; a plane that is not touched may stand anywhere."""
    d = len(point) - 1
    if point[d] >= touch_distance or kernel.lower[d] <= point[d] <= kernel.upper[d]:
        return True
    held[d] = kernel.upper[d] if point[d] > kernel.upper[d] else kernel.lower[d]
    return False


@compiled
def _add(kernel: Kernel, r: int, room: Workspace, out: np.ndarray, jacobian: np.ndarray) -> None:
    """Add what contact does, in regime r, to outputs and derivatives."""
    point, added, turned, turning, (products, own, slopes) = (
        room.held,
        room.added,
        room.rising,
        room.turning,
        room.products,
    )
    p, height = len(point), room.free[3 + kernel.corners[r]]
    past, whole = height - point[p - 1], height - kernel.way[0] + kernel.way[1]
    s = past / whole
    size = past if kernel.begins[r] else 1.0
    grows = 1.0 if kernel.begins[r] else 0.0
    to_coordinates(kernel, point, height, room.where)
    write_products_and_slopes(kernel.tables, 1 + r, room.where, products, own, slopes)
    for j in range(5 if kernel.has_pad else 4):
        i, own_row = (j, j) if j < 4 else (PAD, kernel.tables.forms[1 + r, 2] - 1)
        out[i] += size * added[own_row]
        write_gradient(kernel.tables, 1 + r, slopes, own_row, turning)
        by_s = turning[p - 1] / whole
        for k in range(p - 1):
            jacobian[i, k] += size * (turning[k] + by_s * (1.0 - s) * turned[k]) + grows * added[own_row] * turned[k]
        jacobian[i, p - 1] -= size * by_s + grows * added[own_row]
    out[FORCE] = max(out[FORCE], 0.0)  # a fit may swing below zero just after touch; a plane never pulls
    if kernel.has_pad:
        out[PAD] = max(out[PAD], 0.0)

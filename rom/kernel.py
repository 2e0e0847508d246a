"""The compiled answer: separated forms, contact regimes and their coordinates, as plain arrays and plain loops.

rom.export writes the same in C: what changes here changes there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from rom.tables import (
    Tables,
    outside,
    room_for,
    weighted,
    write_products_and_slopes,
    write_values,
    write_values_and_gradients,
)

TIP, FORCE, TOUCH = 0, 3, 4  # where they are among the outputs
OUTPUTS = 5
BLOCK = 64  # points of a batch that are worked on together


class Kernel(NamedTuple):
    """What the compiled answer reads.

    Form 0 is the free one: tip [m], then heights [m] of what may touch first. Form 1 + r is that of regime r: what
    contact adds to the tip [m], contact force [N] (both per way past the corner [1/m] where the regime begins at
    touch), then the regime's conditions, which hold while they are positive.
    """

    tables: Tables
    lower: np.ndarray  # of the trained box
    upper: np.ndarray
    has_obstacle: bool
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
    rising: np.ndarray  # their derivatives by the tensions, shape (3 + heights, tensions)
    added: np.ndarray  # of the form of the regime that holds, shape (4 + most conditions,)
    tried: np.ndarray  # of a regime that is tried, of the same shape


@njit(cache=True)
def workspace(kernel: Kernel) -> Workspace:
    """Room for one kernel."""
    p, forms = len(kernel.lower), kernel.tables.forms
    free, added = forms[0, 2], 4 + kernel.sizes.shape[1]
    return Workspace(
        np.empty(p),
        np.empty(p),
        room_for(kernel.tables),
        np.empty(free),
        np.empty((free, forms[0, 0])),
        np.empty(added),
        np.empty(added),
    )


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
def to_coordinates(kernel: Kernel, point: np.ndarray, height: float, where: np.ndarray) -> None:
    """Write contact-aligned coordinates into `where`, of a corner with this height in free space, see rom.chart."""
    d = len(point) - 1
    for j in range(d):
        where[j] = point[j]
    where[d] = (height - point[d]) / (height - kernel.way[0] + kernel.way[1])


@njit(cache=True)
def coordinates(kernel: Kernel, point: np.ndarray, height: float) -> np.ndarray:
    """Those coordinates, shape (p,)."""
    where = np.empty(len(point))
    to_coordinates(kernel, point, height, where)
    return where


@njit(cache=True)
def regime_at(kernel: Kernel, point: np.ndarray, touch_distance: float, room: Workspace) -> int:
    """Regime at a point in contact; `room.free` has the heights there, `room.added` is given the values of its form.

    It is the one that the map says, if all its conditions hold; else the first of those nearby whose do. If none has
    all its conditions, in its own box, it is the one that fails least.
    """
    place = cell(kernel, point, touch_distance)
    r, near = kernel.map[place], kernel.near[place]
    if near == np.uint64(1) << np.uint64(r):  # no other is possible: its conditions need not be known
        to_coordinates(kernel, point, room.free[3 + kernel.corners[r]], room.where)
        write_values(kernel.tables, 1 + r, room.where, room.products[0], room.added[:4])
        return r
    best, least = r, -np.inf
    for k in range(-1, len(kernel.corners)):
        other = r if k < 0 else k
        if k == r or (k >= 0 and not near & (np.uint64(1) << np.uint64(k))):
            continue
        to_coordinates(kernel, point, room.free[3 + kernel.corners[other]], room.where)
        write_values(kernel.tables, 1 + other, room.where, room.products[0], room.tried)
        worst = -outside(kernel.tables, 1 + other, room.where)
        for j in range(kernel.tables.forms[1 + other, 2] - 4):
            worst = min(worst, room.tried[4 + j] / kernel.sizes[other, j])
        if worst > least:
            best, least = other, worst
            for j in range(len(room.added)):
                room.added[j] = room.tried[j]
        if worst >= 0.0:
            break
    return best


@njit(cache=True)
def answer(kernel: Kernel, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Outputs, shape (5,), their derivatives by the parameters, shape (5, p), and whether the point is inside.

    A point outside is moved to the nearest inside; derivatives across a wall are then zero.
    """
    out, jacobian = np.empty(OUTPUTS), np.empty((OUTPUTS, len(point)))
    return out, jacobian, write_answer_and_jacobian(kernel, point, workspace(kernel), out, jacobian)


@njit(cache=True)
def write_answer_and_jacobian(
    kernel: Kernel, point: np.ndarray, room: Workspace, out: np.ndarray, jacobian: np.ndarray
) -> bool:
    """Write outputs and derivatives; whether the point is inside."""
    p, held, free = len(point), room.held, room.free
    tensions = p - 1 if kernel.has_obstacle else p
    inside = hold_tensions(kernel, point, held)
    write_values_and_gradients(kernel.tables, 0, held, room.products, free, room.rising)
    jacobian[:] = 0.0
    out[:3], out[FORCE], out[TOUCH] = free[:3], 0.0, np.nan
    jacobian[:3, :tensions] = room.rising[:3]
    if kernel.has_obstacle:
        first = 3 + leading(free)
        out[TOUCH] = free[first]
        jacobian[TOUCH, :tensions] = room.rising[first]
        inside = hold_distance(kernel, point, held, out[TOUCH]) and inside
        if held[p - 1] < out[TOUCH]:
            _add(kernel, regime_at(kernel, held, out[TOUCH], room), room, out, jacobian)
    if not inside:
        for j in range(p):
            if held[j] != point[j]:
                jacobian[:, j] = 0.0
    return inside


@njit(cache=True)
def _add_contact(kernel: Kernel, room: Workspace, out: np.ndarray) -> int:
    """Add what contact does to the outputs at room.held, where room.free are the free form's values; the regime."""
    r = regime_at(kernel, room.held, out[TOUCH], room)
    size = room.free[3 + kernel.corners[r]] - room.held[-1] if kernel.begins[r] else 1.0
    for i in range(4):
        out[TIP + i] += size * room.added[i]
    out[FORCE] = max(out[FORCE], 0.0)
    return r


@njit(cache=True)
def leading(free: np.ndarray) -> int:
    """Which height leads."""
    first = 0
    for j in range(1, len(free) - 3):
        if free[3 + j] > free[3 + first]:
            first = j
    return first


@njit(cache=True)
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


@njit(cache=True)
def hold_distance(kernel: Kernel, point: np.ndarray, held: np.ndarray, touch_distance: float) -> bool:
    """Hold the plane's distance to the box, in `held`; a plane that is not touched may stand anywhere."""
    d = len(point) - 1
    if point[d] >= touch_distance or kernel.lower[d] <= point[d] <= kernel.upper[d]:
        return True
    held[d] = kernel.upper[d] if point[d] > kernel.upper[d] else kernel.lower[d]
    return False


@njit(cache=True)
def _add(kernel: Kernel, r: int, room: Workspace, out: np.ndarray, jacobian: np.ndarray) -> None:
    """Add what contact does, in regime r, to outputs and derivatives."""
    point, added, (products, own, slopes) = room.held, room.added, room.products
    p, corner = len(point), 3 + kernel.corners[r]
    height, turned = room.free[corner], room.rising[corner]
    past, whole = height - point[p - 1], height - kernel.way[0] + kernel.way[1]
    s = past / whole
    size = past if kernel.begins[r] else 1.0
    grows = 1.0 if kernel.begins[r] else 0.0
    to_coordinates(kernel, point, height, room.where)
    write_products_and_slopes(kernel.tables, 1 + r, room.where, products, own, slopes)
    for i in range(4):
        out[TIP + i] += size * added[i]
        by_s = weighted(kernel.tables, 1 + r, slopes[p - 1], i) / whole
        for k in range(p - 1):
            by_tension = weighted(kernel.tables, 1 + r, slopes[k], i)
            jacobian[i, k] += size * (by_tension + by_s * (1.0 - s) * turned[k]) + grows * added[i] * turned[k]
        jacobian[i, p - 1] -= size * by_s + grows * added[i]
    if out[FORCE] < 0.0:  # a fit may swing below zero just after touch; a plane never pulls
        out[FORCE] = 0.0


@njit(cache=True)
def answers(kernel: Kernel, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Outputs, shape (n, 5), whether inside, shape (n,), and regimes, -1 without contact, of points, shape (n, p).

    Block by block first all as free, then those in contact: two loops that are short cost less than one that is long.
    """
    n, d = points.shape[0], points.shape[1] - 1
    out = np.empty((n, OUTPUTS))
    inside = np.empty(n, np.bool_)
    regimes = np.full(n, -1)
    room = workspace(kernel)
    tables, held, products = kernel.tables, room.held, room.products[0]
    free = np.empty((BLOCK, len(room.free)))
    for begin in range(0, n, BLOCK):
        end = min(begin + BLOCK, n)
        for i in range(begin, end):
            own = free[i - begin]
            inside[i] = hold_tensions(kernel, points[i], held)
            write_values(tables, 0, held, products, own)
            for k in range(3):
                out[i, TIP + k] = own[k]
            out[i, FORCE], out[i, TOUCH] = 0.0, np.nan
            if kernel.has_obstacle:
                out[i, TOUCH] = own[3 + leading(own)]
                inside[i] = hold_distance(kernel, points[i], held, out[i, TOUCH]) and inside[i]
                if held[d] < out[i, TOUCH]:
                    regimes[i] = 0
        for i in range(begin, end):
            if regimes[i] == 0:
                hold_tensions(kernel, points[i], held)
                hold_distance(kernel, points[i], held, out[i, TOUCH])
                room.free[:] = free[i - begin]
                regimes[i] = _add_contact(kernel, room, out[i])
    return out, inside, regimes

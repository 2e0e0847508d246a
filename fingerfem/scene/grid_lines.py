"""Grid lines that fit plates and channels at every resolution, so that refining the mesh refines the same finger."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.scene.tables import Geometry, GridOutline, Mesh, Tendon
from rom.dataset.grid import levels

FINE = 1000  # points between which sections of a tapered segment have one side
MORE = 40  # cells across that are tried where fewer do not fit
EQUAL = 1e-7  # of the side: positions that differ by less are meant to be equal [-]
THINNEST = 1000  # side over shortest cell along the axis
SLIVER = 50  # mean over thinnest cell at which a mesh is refused: contact stiffness goes with the thinnest


def subdivide(breakpoints: ArrayLike, cells: int, symmetric: bool = False) -> np.ndarray:
    """Grid lines that contain every breakpoint, with the given number of cells, as even as possible.

    Args:
        breakpoints: ascending positions [m], shape (n,).
        cells: number of cells between the first and the last.
        symmetric: keep the lines of symmetric breakpoints symmetric.

    Raises:
        ValueError: the number of cells cannot fit the breakpoints, or not symmetrically.
    """
    points = np.asarray(breakpoints, float)
    lengths = np.diff(points)
    n = len(lengths)
    count = np.ones(n, int)
    while count.sum() < cells:
        # Split the widest cells first; a mirrored pair together, the outermost of equals first.
        _, width = levels(lengths / count, 1e-9 * (points[-1] - points[0]))
        for i in np.lexsort((np.arange(n), -width)):
            pair = {int(i), n - 1 - int(i)} if symmetric else {int(i)}
            if count.sum() + len(pair) <= cells:
                count[list(pair)] += 1
                break
        else:
            break
    if count.sum() != cells:
        parity = ", and even to stay symmetric" if symmetric and n % 2 == 0 else ""
        raise ValueError(
            f"must fit {n} intervals between channels and plates (at least {n} cells{parity}), got {cells}"
        )
    starts = zip(points[:-1], points[1:], count, strict=True)
    return np.append(np.concatenate([np.linspace(a, b, k, endpoint=False) for a, b, k in starts]), points[-1])


def grid_lines(outline: GridOutline, mesh: Mesh, half: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grid lines along x, y and z, shapes (lines,) [m]; z begins at 0 where `half` the finger is modelled.

    Raises:
        ValueError: mesh.cells cannot hold the plates, the channels or the pad.
    """
    along, across = mesh.cells
    try:
        lines = [_graded(outline.geometry, *segment) for segment in _with_cells(_along(outline), along)]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    x = np.unique(np.concatenate(lines))
    if np.diff(x).min() < outline.geometry.side / THINNEST:
        raise ValueError(
            f"mesh.cells[0] must leave no cell shorter than 1/{THINNEST} of the side, "
            f"{outline.geometry.side / THINNEST:.3g} m, as a pad that ends beside a plate's face does, "
            f"got one of {np.diff(x).min():.3g} m"
        )
    # Longer cells lock in bending.
    share, of_side = (2 / 3, "two thirds of the side") if mesh.order == 1 else (1.0, "the side")
    sides = outline.geometry.side * outline.geometry.size_at((x[1:] + x[:-1]) / 2)
    worst = int(np.argmax(np.diff(x) / sides))
    longest = share * sides[worst]
    if np.diff(x)[worst] > longest * (1 + 1e-6):
        raise ValueError(
            f"mesh.cells[0] must leave no cell of order {mesh.order} longer than {of_side}, {longest:.3g} m, "
            f"or bending locks, got one of {np.diff(x)[worst]:.3g} m"
        )
    try:
        y, z = _across(outline, across)
    except ValueError as error:
        raise ValueError(f"mesh.cells[1] {error}") from None
    if z is None:
        return x, y, y
    return x, y, z if half else np.concatenate([-z[:0:-1], z])


def _with_cells(segments: list[list[float]], along: int) -> list[tuple[list[float], int]]:
    """Each segment's breakpoints [m] and cells: the longest has `along`, the others cells of nearly the same length."""
    lengths = [one[-1] - one[0] for one in segments]
    shares = [math.ceil(along * length / max(lengths) * (1 - EQUAL)) for length in lengths]
    return [(one, max(cells, min(along, len(one) - 1))) for one, cells in zip(segments, shares, strict=True)]


def _graded(geometry: Geometry, breakpoints: list[float], cells: int) -> np.ndarray:
    """Grid lines of a segment along x [m], as even over the sections' own sides as possible."""
    if not geometry.is_tapered:
        return subdivide(breakpoints, cells)
    x = np.union1d(np.linspace(breakpoints[0], breakpoints[-1], FINE), breakpoints)
    sides = np.append(0.0, np.cumsum(np.diff(x) / geometry.size_at((x[1:] + x[:-1]) / 2)))
    fixed = np.interp(breakpoints, x, sides)
    lines = subdivide(fixed, cells)
    found = np.interp(lines, sides, x)
    found[np.searchsorted(lines, fixed)] = breakpoints
    return found


def fitting(outline: GridOutline, across: int) -> int:
    """The fewest cells across, from the given number on, that fit channels and pad; that number if none does."""
    for cells in range(across, across + MORE):
        with contextlib.suppress(ValueError):
            _across(outline, cells)
            return cells
    return across


def _across(outline: GridOutline, cells: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Grid lines along y, and those along z from the axis on where they are not the same [m]."""
    if not outline.is_planar:
        # The same for both, so that mirrored pulls give mirrored states.
        y = subdivide(_both_sides(_edges(outline, 0, 1)), cells, symmetric=True)
        _no_slivers(y)
        return y, None
    y = subdivide(_both_sides(_edges(outline, 0)), cells, symmetric=True)
    half = subdivide(sorted({0.0, *_edges(outline, 1)}), (cells + 1) // 2)
    _no_slivers(y)
    _no_slivers(half)
    return y, half


def _no_slivers(lines: np.ndarray) -> None:
    thinnest, mean = np.diff(lines).min(), (lines[-1] - lines[0]) / (len(lines) - 1)
    if thinnest < mean / SLIVER:
        raise ValueError(
            f"must not be forced to cells thinner than 1/{SLIVER} of the mean, {mean:.3g} m, by channels and pad that "
            f"almost touch, got {thinnest:.3g} m"
        )


def _along(outline: GridOutline) -> list[list[float]]:
    """Per segment, what must lie on grid lines along x [m]."""
    ends = outline.plates
    pad = outline.pad
    segments = []
    for start, (inner, outer) in zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True):
        inside = [edge for edge in (pad.x if pad else []) if start < edge < outer]
        segments.append(_merged([start, inner, outer], inside, EQUAL * outline.geometry.side))
    return segments


def _merged(fixed: list[float], others: Iterable[float], equal: float) -> list[float]:
    """Ascending positions [m]: those that are fixed, and of the others what is farther than `equal` from these."""
    found = list(fixed)
    for other in others:
        if min(abs(other - one) for one in found) > equal:
            found.append(other)
    return sorted(found)


def _edges(outline: GridOutline, *axes: int) -> list[float]:
    """Distances from the axis, along y (0) or z (1) or both, that must lie on grid lines, ascending [m].

    The axis itself is one of them, 0, where a channel ends there.
    """
    half = outline.geometry.channel_width / 2
    edges = [abs(tendon.offset[axis] + side) for axis in axes for tendon in outline.tendons for side in (-half, half)]
    pad = outline.pad
    if 1 in axes and pad is not None and pad.width is not None:
        edges.append(pad.width / 2)
    equal = EQUAL * outline.geometry.side
    found = _merged([0.0, outline.geometry.side / 2], sorted(edges), equal)
    return found if min(edges) <= equal else found[1:]


def _both_sides(edges: list[float]) -> np.ndarray:
    return np.array([-edge for edge in reversed(edges) if edge > 0] + edges)


def in_column(geometry: Geometry, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the column of cells around a tendon's line."""
    offset, half = tendon.offset, geometry.channel_width / 2
    return (abs(x[1] - offset[0]) < half) & (abs(x[2] - offset[1]) < half)


def in_plate(outline: GridOutline, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in plate k, its faces included."""
    start, end = outline.plates[k]
    return (x[0] > start - outline.tolerance) & (x[0] < end + outline.tolerance)


def in_channel(outline: GridOutline, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the channel of a tendon; it ends before its plate."""
    return in_column(outline.geometry, tendon, x) & (x[0] < outline.plates[tendon.segment - 1][0])


def in_hole(outline: GridOutline, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the hole of a tendon in its plate."""
    start, end = outline.plates[tendon.segment - 1]
    return in_column(outline.geometry, tendon, x) & (x[0] > start) & (x[0] < end)


def tendon_cells(outline: GridOutline, tendon: Tendon, x: np.ndarray) -> tuple[np.ndarray, float]:
    """Cells with midpoints x, shape (3, n) [m], over which a tendon's tension is spread, and their whole measure.

    The measure of a channel is its area at the clamp [m^2], that of a hole its volume [m^3].
    """
    geometry = outline.geometry
    area = geometry.channel_width**2
    if tendon.path == "channel":
        return in_channel(outline, tendon, x), area
    return in_hole(outline, tendon, x), area * geometry.plate * float(geometry.sizes[tendon.segment - 1]) ** 3

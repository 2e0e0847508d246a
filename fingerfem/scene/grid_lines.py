"""Grid lines that fit plates and channels at every resolution, so that refining the mesh refines the same finger."""

from __future__ import annotations

import contextlib

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.scene.tables import Geometry, Mesh, Outline, Tendon

MORE = 40  # cells across that are tried where fewer do not fit
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
        for i in np.lexsort((np.arange(n), np.round(-lengths / count, 12))):
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


def grid_lines(outline: Outline, mesh: Mesh, half: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grid lines along x, y and z, shapes (lines,) [m]; z begins at 0 where `half` the finger is modelled.

    Raises:
        ValueError: mesh.cells cannot hold the plates, the channels or the pad.
    """
    along, across = mesh.cells
    try:
        lines = [subdivide(breakpoints, along) for breakpoints in _along(outline)]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    x = np.unique(np.concatenate(lines))
    # Longer cells lock in bending: docs/extremes.md.
    share, of_side = (2 / 3, "two thirds of the side") if mesh.order == 1 else (1.0, "the side")
    longest = share * outline.geometry.side
    if np.diff(x).max() > longest * (1 + 1e-6):
        raise ValueError(
            f"mesh.cells[0] must leave no cell of order {mesh.order} longer than {of_side}, {longest:.3g} m, "
            f"or bending locks, got one of {np.diff(x).max():.3g} m"
        )
    try:
        y, z = _across(outline, across)
    except ValueError as error:
        raise ValueError(f"mesh.cells[1] {error}") from None
    if z is None:
        return x, y, y
    return x, y, z if half else np.concatenate([-z[:0:-1], z])


def fitting(outline: Outline, across: int) -> int:
    """The fewest cells across, from the given number on, that fit channels and pad; that number if none does."""
    for cells in range(across, across + MORE):
        with contextlib.suppress(ValueError):
            _across(outline, cells)
            return cells
    return across


def _across(outline: Outline, cells: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Grid lines along y, and those along z from the axis on where they are not the same [m]."""
    if not outline.is_planar:
        # The same for both, so that mirrored pulls give mirrored states.
        y = subdivide(_both_sides(_edges(outline, 0) | _edges(outline, 1)), cells, symmetric=True)
        _no_slivers(y)
        return y, None
    y = subdivide(_both_sides(_edges(outline, 0)), cells, symmetric=True)
    half = subdivide([0.0, *sorted(_edges(outline, 1))], (cells + 1) // 2)
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


def _along(outline: Outline) -> list[list[float]]:
    """Per segment, what must lie on grid lines along x [m]."""
    ends = outline.plates
    pad = outline.pad
    segments = []
    for start, (inner, outer) in zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True):
        points = {start, inner, outer} | {edge for edge in (pad.x if pad else []) if start < edge < outer}
        segments.append(np.unique(_snap(outline.geometry.side, sorted(points))).tolist())
    return segments


def _snap(side: float, positions: ArrayLike) -> np.ndarray:
    """Positions [m] on a raster so fine that only round-off of what is meant to be equal is lost."""
    return np.round(np.asarray(positions, float) / side, 7) * side


def _edges(outline: Outline, axis: int) -> set[float]:
    """Positive distances from the axis, along y (0) or z (1), that must lie on grid lines [m]."""
    half = outline.geometry.channel_width / 2
    edges = {outline.geometry.side / 2}
    for tendon in outline.tendons:
        offset = abs(tendon.offset[axis])
        edges |= {abs(offset - half), offset + half}
    pad = outline.pad
    if axis == 1 and pad is not None and pad.width is not None:
        edges.add(pad.width / 2)
    return {edge for edge in _snap(outline.geometry.side, sorted(edges)).tolist() if edge > 0}


def _both_sides(edges: set[float]) -> np.ndarray:
    positive = sorted(edges)
    return np.array([-edge for edge in reversed(positive)] + positive)


def in_column(geometry: Geometry, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the column of cells around a tendon's line."""
    offset, half = tendon.offset, geometry.channel_width / 2
    return (abs(x[1] - offset[0]) < half) & (abs(x[2] - offset[1]) < half)


def in_channel(outline: Outline, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the channel of a tendon; it ends before its plate."""
    return in_column(outline.geometry, tendon, x) & (x[0] < outline.plates[tendon.segment - 1][0])


def in_hole(outline: Outline, tendon: Tendon, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the hole of a tendon in its plate."""
    start, end = outline.plates[tendon.segment - 1]
    return in_column(outline.geometry, tendon, x) & (x[0] > start) & (x[0] < end)

"""Grid lines that fit plates and channels at every resolution, so that refining the mesh refines the same finger."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fingerfem.scene import Scene


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


def plates(scene: Scene) -> list[tuple[float, float]]:
    """Where every segment's plate begins and ends along x [m]."""
    ends = np.cumsum(scene.geometry.segments)
    return [(float(end - scene.geometry.plate), float(end)) for end in ends]


def grid_lines(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grid lines along x, y and z [m]; z begins at 0 where half the finger is modelled.

    Raises:
        ValueError: mesh.cells cannot hold the plates, the channels or the pad.
    """
    along, across = scene.mesh.cells
    try:
        lines = [subdivide(breakpoints, along) for breakpoints in _along(scene)]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    x = np.unique(np.concatenate(lines))
    # Longer cells lock in bending: docs/extremes.md.
    share, of_side = (2 / 3, "two thirds of the side") if scene.mesh.order == 1 else (1.0, "the side")
    longest = share * scene.geometry.side
    if np.diff(x).max() > longest * (1 + 1e-6):
        raise ValueError(
            f"mesh.cells[0] must leave no cell of order {scene.mesh.order} longer than {of_side}, {longest:.3g} m, "
            f"or bending locks, got one of {np.diff(x).max():.3g} m"
        )
    try:
        y, half = _across(scene, across)
    except ValueError as error:
        raise ValueError(f"mesh.cells[1] {error}") from None
    if half is None:
        return x, y, y
    return x, y, half if scene.is_half else np.concatenate([-half[:0:-1], half])


def fitting(scene: Scene, across: int) -> int:
    """The fewest cells across, from the given number on, that fit channels and pad; that number if none does."""
    for cells in range(across, across + MORE):
        with contextlib.suppress(ValueError):
            _across(scene, cells)
            return cells
    return across


def _across(scene: Scene, cells: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Grid lines along y, and those along z from the axis on where they are not the same [m]."""
    if not scene.planar:
        # The same for both, so that mirrored pulls give mirrored states.
        y = subdivide(_both_sides(_edges(scene, 0) | _edges(scene, 1)), cells, symmetric=True)
        _no_slivers(y)
        return y, None
    y = subdivide(_both_sides(_edges(scene, 0)), cells, symmetric=True)
    half = subdivide([0.0, *sorted(_edges(scene, 1))], (cells + 1) // 2)
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


def _along(scene: Scene) -> list[list[float]]:
    """Per segment, what must lie on grid lines along x [m]."""
    ends = plates(scene)
    pad = scene.obstacle.pad if scene.obstacle else None
    segments = []
    for start, (inner, outer) in zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True):
        points = {start, inner, outer} | {edge for edge in (pad.x if pad else []) if start < edge < outer}
        segments.append(np.unique(_snap(scene, sorted(points))).tolist())
    return segments


def _snap(scene: Scene, positions: ArrayLike) -> np.ndarray:
    """Positions [m] on a raster so fine that only round-off of what is meant to be equal is lost."""
    return np.round(np.asarray(positions, float) / scene.geometry.side, 7) * scene.geometry.side


def _edges(scene: Scene, axis: int) -> set[float]:
    """Positive distances from the axis, along y (0) or z (1), that must lie on grid lines [m]."""
    half = scene.geometry.channel_width / 2
    edges = {scene.geometry.side / 2}
    for tendon in scene.tendons:
        offset = abs(tendon.offset[axis])
        edges |= {abs(offset - half), offset + half}
    pad = scene.obstacle.pad if scene.obstacle else None
    if axis == 1 and pad is not None and pad.width is not None:
        edges.add(pad.width / 2)
    return {edge for edge in _snap(scene, sorted(edges)).tolist() if edge > 0}


def _both_sides(edges: set[float]) -> np.ndarray:
    positive = sorted(edges)
    return np.array([-edge for edge in reversed(positive)] + positive)


def in_column(scene: Scene, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the column of cells around tendon k's line."""
    offset, half = scene.tendons[k].offset, scene.geometry.channel_width / 2
    return (abs(x[1] - offset[0]) < half) & (abs(x[2] - offset[1]) < half)


def in_channel(scene: Scene, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the channel of tendon k; it ends before its plate."""
    return in_column(scene, k, x) & (x[0] < plates(scene)[scene.tendons[k].segment - 1][0])


def in_hole(scene: Scene, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the hole of tendon k in its plate."""
    start, end = plates(scene)[scene.tendons[k].segment - 1]
    return in_column(scene, k, x) & (x[0] > start) & (x[0] < end)

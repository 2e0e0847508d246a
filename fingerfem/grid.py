"""Grid lines that fit plates and channels at every resolution, so that refining the mesh refines the same finger."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fingerfem.scene import Scene


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


def grid_lines(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Grid lines along x and across the section (the same for y and z) [m].

    Raises:
        ValueError: mesh.cells cannot hold the plates or the channels.
    """
    geometry, (along, across) = scene.geometry, scene.mesh.cells
    half = geometry.channel_width / 2
    edges = {geometry.side / 2}
    for tendon in scene.tendons:
        for offset in tendon.offset:
            edges |= {abs(abs(offset) - half), abs(offset) + half}
    positive = np.unique(np.round(sorted(edges), 9))
    section = np.unique(np.concatenate([-positive, positive]))
    try:
        lines = [subdivide([start, inner, outer], along) for start, (inner, outer) in _segments(scene)]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    try:
        y = subdivide(section, across, symmetric=True)
    except ValueError as error:
        raise ValueError(f"mesh.cells[1] {error}") from None
    return np.unique(np.round(np.concatenate(lines), 12)), y


def _segments(scene: Scene):
    ends = plates(scene)
    return list(zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True))


def in_channel(scene: Scene, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the channel of tendon k."""
    tendon, half = scene.tendons[k], scene.geometry.channel_width / 2
    end = plates(scene)[tendon.segment - 1][0]
    return (abs(x[1] - tendon.offset[0]) < half) & (abs(x[2] - tendon.offset[1]) < half) & (x[0] < end)

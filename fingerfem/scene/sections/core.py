"""The core of a circle's mesh: a square grid with bulging sides, on whose border the radial lines begin."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fingerfem.scene.sections.plane_mesh import oriented

QUARTER = math.pi / 2
BULGE = 0.5  # of the core's sides: 0 is a square, 1 a circle [-]
WIDEST = math.radians(22.5)  # angle between radial lines [rad]
MORE = 4  # cells along a side of the core that are tried where fewer do not fit


class Core(NamedTuple):
    """Points, shape (points, 2) [m]; quadrilaterals, shape (quads, 4); points around the border, shape (angles,)."""

    points: np.ndarray
    quads: np.ndarray
    border: np.ndarray


class Rule(NamedTuple):
    """Constraints on lines added to a side: symmetric ones stay so, channels keep the cells that others alike have."""

    keeps_symmetry: bool
    keeps_channels: bool


OF_MIRRORED = (Rule(True, True), Rule(True, False))  # the better first
OF_OTHERS = (Rule(True, True), Rule(False, True), Rule(False, False))


def parts(gap: float, spacing: float) -> int:
    """Into how many an angle between radial lines is divided, at a spacing that is wanted [rad]."""
    return max(1, math.floor(gap / spacing + 0.5 + 1e-6), math.ceil(gap / WIDEST * (1 - 1e-9)))


def radial_lines(
    angles: np.ndarray, spacing: float, in_channel: Callable[[float], bool], is_mirrored: bool
) -> np.ndarray:
    """Angles of radial lines around a core, as many at each of its sides [rad]: the section bends alike all around.

    Args:
        angles: that must be among them, ascending from the core's first corner over less than a turn [rad].
        spacing: between them, about [rad].
        in_channel: whether an angle lies within a channel.
        is_mirrored: whether they are their own mirror image in z = 0.

    Raises:
        ValueError: the sides of the core cannot have the same number of cells.
    """
    corners = angles[0] + QUARTER * np.arange(5)
    around = np.append(angles, corners[-1])
    sides = [around[(around > corners[k] - 1e-9) & (around < corners[k + 1] + 1e-9)] for k in range(4)]
    if is_mirrored:
        sides[2] = 2 * math.pi - sides[0][::-1]
    counts = [np.array([parts(gap, spacing) for gap in np.diff(side).tolist()]) for side in sides]
    frozen = [np.array([in_channel(at) for at in ((side[1:] + side[:-1]) / 2).tolist()]) for side in sides]
    most = max(int(count.sum()) for count in counts)
    for rule in OF_MIRRORED if is_mirrored else OF_OTHERS:
        for cells in range(most, most + MORE):
            own = zip(sides, counts, frozen, strict=True)
            filled = [_filled(side, count, cells, kept & rule.keeps_channels, rule) for side, count, kept in own]
            lines = [_divided(side, count) for side, count in zip(sides, filled, strict=True) if count is not None]
            if len(lines) < len(sides):
                continue
            if is_mirrored:
                lines[2] = 2 * math.pi - lines[0][::-1]
            return np.concatenate([line[:-1] for line in lines])
    raise ValueError(f"must fit the channels alike on all sides of the core, as more cells may do, got {most}")


def _filled(side: np.ndarray, counts: np.ndarray, cells: int, frozen: np.ndarray, rule: Rule) -> np.ndarray | None:
    """Cells of a side's gaps that sum up to a number, more in the widest that are not frozen; None if none do."""
    lengths, counts, n = np.diff(side), counts.copy(), len(counts)
    symmetric = rule.keeps_symmetry and bool(np.allclose(lengths, lengths[::-1], rtol=0, atol=1e-9))
    while counts.sum() < cells:
        widths = np.where(frozen, 0.0, np.round(lengths / counts, 9))
        for k in np.argsort(-widths, kind="stable"):
            pair = [k] if not symmetric or 2 * k == n - 1 else [k, n - 1 - k]
            if widths[k] > 0 and counts.sum() + len(pair) <= cells:
                counts[pair] += 1
                break
        else:
            return None
    return counts


def _divided(side: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """A side's lines with so many cells in its gaps."""
    gaps = [np.linspace(a, b, n, endpoint=False) for (a, b), n in zip(pairwise(side.tolist()), counts, strict=True)]
    return np.append(np.concatenate(gaps), side[-1])


def core_grid(angles: np.ndarray, corner: float, bulge: float = BULGE) -> Core:
    """The core whose corners have a distance `corner` [m] from the axis; as many radial lines begin at all its sides.

    Points within are those of Coons' patch between the four sides.
    """
    middle = (np.floor((angles - angles[0]) / QUARTER + 1e-9) + 0.5) * QUARTER + angles[0]
    radii = corner * ((1 - bulge) * math.cos(math.pi / 4) / np.cos(angles - middle) + bulge)
    around = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    cells = len(angles) // 4
    bottom, right, top, left = (np.arange(k * cells, (k + 1) * cells + 1) % len(angles) for k in range(4))
    top, left = top[::-1], left[::-1]
    u = np.mean([_shares(around[side]) for side in (bottom, top)], axis=0)[:, None, None]
    v = np.mean([_shares(around[side]) for side in (left, right)], axis=0)[None, :, None]
    grid = (1 - v) * around[bottom][:, None] + v * around[top][:, None]
    grid = grid + (1 - u) * around[left][None] + u * around[right][None]
    ends = around[[bottom[0], bottom[-1], top[0], top[-1]]]
    grid -= (1 - u) * (1 - v) * ends[0] + u * (1 - v) * ends[1] + (1 - u) * v * ends[2] + u * v * ends[3]
    numbers = np.arange(grid[..., 0].size).reshape(cells + 1, cells + 1)
    border = np.empty(len(angles), int)
    for side, along in ((bottom, numbers[:, 0]), (top, numbers[:, -1]), (left, numbers[0]), (right, numbers[-1])):
        border[side] = along
    points = grid.reshape(-1, 2)
    points[border] = around  # without round-off
    quads = np.stack([numbers[:-1, :-1], numbers[1:, :-1], numbers[:-1, 1:], numbers[1:, 1:]], axis=-1).reshape(-1, 4)
    return Core(points, oriented(quads, points), border)


def _shares(line: np.ndarray) -> np.ndarray:
    """Shares of a line's length up to its points, shape (points,) [-]."""
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    return np.asarray(lengths / lengths[-1])

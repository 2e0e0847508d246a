"""A bar of the finger's rubber and what its end is made to do; any Python with NumPy can import this module."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

LENGTH, SIDE = 0.05, 0.01  # of the bar, along x and across [m]
CELLS = 12, 4, 4
STEPS = 8  # of a motion, alike
STRETCH, TURN, TWIST = 0.2, np.deg2rad(90), np.deg2rad(90)  # of the length [-]; of the end [rad]
TOUCHING = 1e-9  # [m]: coordinates that differ by less are the same


@dataclass(frozen=True)
class Motion:
    """What is prescribed.

    Attributes:
        held: which displacements, shape (nodes, 3).
        at: displacements at a share of the motion, of which the held ones count, shape (nodes, 3) [m].
    """

    held: np.ndarray
    at: Callable[[float], np.ndarray]

    def path(self, steps: int = STEPS) -> np.ndarray:
        """Displacements at the end of every step, shape (steps, nodes, 3) [m]."""
        return np.array([self.at(k / steps) for k in range(1, steps + 1)])

    def begun(self, share: float) -> Motion:
        """Its first part."""
        return Motion(self.held, lambda part: self.at(share * part))


def ends(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which nodes, shape (nodes, 3) [m], are at the start and at the end."""
    return nodes[:, 0] < TOUCHING, nodes[:, 0] > LENGTH - TOUCHING


def motions(nodes: np.ndarray) -> dict[str, Motion]:
    """By name; both ends are held in all components, but for the free stretch, which has a closed form.

    Args:
        nodes: of the bar at rest, shape (nodes, 3) [m].
    """
    start, end = ends(nodes)
    clamped = np.repeat((start | end)[:, None], 3, axis=1)
    sliding = np.stack([start | end, nodes[:, 1] < TOUCHING, nodes[:, 2] < TOUCHING], axis=1)
    arms = (nodes - [LENGTH, SIDE / 2, SIDE / 2]) * end[:, None]  # from the end's centre [m]

    def stretched(share: float) -> np.ndarray:
        return np.outer(end, [share * STRETCH * LENGTH, 0, 0])

    def turned(share: float) -> np.ndarray:
        angle = share * TURN
        cosine, sine = np.cos(angle), np.sin(angle)
        centre = LENGTH * np.array([sine / angle - 1, (1 - cosine) / angle, 0])  # of a bar that is a circle's arc
        return np.outer(end, centre) + arms @ np.array([[cosine - 1, sine, 0], [-sine, cosine - 1, 0], [0, 0, 0]])

    def twisted(share: float) -> np.ndarray:
        cosine, sine = np.cos(share * TWIST), np.sin(share * TWIST)
        return arms @ np.array([[0, 0, 0], [0, cosine - 1, sine], [0, -sine, cosine - 1]])

    return {
        "free stretch": Motion(sliding, stretched),
        "stretch": Motion(clamped, stretched),
        "bending": Motion(clamped, turned),
        "twist": Motion(clamped, twisted),
    }


def block(counts: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """The bar cut into so many cells along x, y, z.

    Returns:
        nodes, shape (nodes, 3) [m]; the corners of the cells, x running fastest, then y, shape (cells, 8).
    """
    along = [np.linspace(0, size, count + 1) for size, count in zip((LENGTH, SIDE, SIDE), counts, strict=True)]
    nodes = np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)
    numbers = np.arange(len(nodes)).reshape([count + 1 for count in counts])
    i, j, k = counts
    corners = [numbers[a : a + i, b : b + j, c : c + k].ravel() for c in (0, 1) for b in (0, 1) for a in (0, 1)]
    return nodes, np.stack(corners, axis=1)

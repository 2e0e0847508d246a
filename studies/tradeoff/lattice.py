"""Fields of different meshes at the same points: each by its own shape functions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


class Lattice:
    """Points that fill a box, at which fields on any grid of nodes are read.

    Args:
        lower, upper: ends of the box [m], shapes (3,).
        counts: of the points along each axis.
    """

    def __init__(self, lower: np.ndarray, upper: np.ndarray, counts: tuple[int, int, int] = (25, 5, 5)):
        # Middles of even intervals: hardly ever a node of a mesh, where it would err less than elsewhere.
        ends = zip(lower, upper, counts, strict=True)
        self._axes = [low + (np.arange(count) + 0.5) / count * (high - low) for low, high, count in ends]

    def reader(self, nodes: np.ndarray, order: int) -> Callable[[np.ndarray], np.ndarray]:
        """What reads a field, shape (nodes, 3), as (points, 3).

        Args:
            nodes: at rest, sorted by x, then y, then z, on grid lines [m], shape (nodes, 3).
            order: of the Lagrange elements.
        """
        lines = [np.unique(np.round(nodes[:, a], 9)) for a in range(3)]
        shape = [len(line) for line in lines]
        assert np.prod(shape) == len(nodes), "nodes must fill a grid"
        weights = [lagrange(line, order, axis) for line, axis in zip(lines, self._axes, strict=True)]

        def read(field: np.ndarray) -> np.ndarray:
            whole = np.reshape(field, (*shape, 3))
            return np.einsum("ax,by,cz,xyzk->abck", *weights, whole, optimize=True).reshape(-1, 3)

        return read


def lagrange(lines: np.ndarray, order: int, points: np.ndarray) -> np.ndarray:
    """Values of the shape functions of nodes on a line, `order` intervals a cell, at points; shape (points, nodes)."""
    found = np.zeros((len(points), len(lines)))
    cells = np.clip(np.searchsorted(lines[::order], points, side="right") - 1, 0, (len(lines) - 1) // order - 1)
    for row, (point, cell) in enumerate(zip(points, cells, strict=True)):
        own = np.arange(order * cell, order * cell + order + 1)
        for i in own:
            others = lines[own[own != i]]
            found[row, i] = np.prod((point - others) / (lines[i] - others))
    return found

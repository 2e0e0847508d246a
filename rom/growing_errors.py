"""What a surrogate may be off in contact, which grows from touch on, in compiled code; see rom.error_map."""

from __future__ import annotations

import numpy as np

from rom.compiled import compiled
from rom.kernel import Kernel, cell, hold_distance, hold_tensions


@compiled
def write_growing_errors(
    kernel: Kernel, rates: np.ndarray, margin: float, point: np.ndarray, touch_distance: float, found: np.ndarray
) -> None:
    """Write what the errors of tip [m], contact force [N], displacement [m], pad pressure [Pa] grow by past touch.

    Args:
        kernel: without an obstacle nothing grows.
        rates: of the errors, see rom.parts.Errors.
        margin: likewise [m].
        point: held to the box, shape (p,).
        touch_distance: there [m].
        found: shape (k,), as the rates have columns.
    """
    past = touch_distance - point[len(point) - 1] if kernel.has_obstacle else 0.0
    rate = cell(kernel, point, touch_distance) if past > 0.0 else 0
    for i in range(len(found)):
        found[i] = rates[rate, i] * (past + margin) if past > 0.0 else 0.0


@compiled(allocates=True)
def growing_errors(
    kernel: Kernel, rates: np.ndarray, margin: float, points: np.ndarray, touch_distances: np.ndarray
) -> np.ndarray:
    """Those of points, shape (n, p), that may lie outside the box, shape (n, k)."""
    found, held = np.zeros((len(points), rates.shape[1])), np.empty(points.shape[1])
    for i in range(len(points)):
        hold_tensions(kernel, points[i], held)
        hold_distance(kernel, points[i], held, touch_distances[i])
        if not points[i, -1] >= touch_distances[i]:  # nan is held to the nearest plane
            write_growing_errors(kernel, rates, margin, held, touch_distances[i], found[i])
    return found

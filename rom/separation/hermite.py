"""One-dimensional nodal functions and their derivatives.

A nodal function is fixed by its values at nodes, or by its values and slopes; here every one is a piecewise cubic, so
that one evaluation serves all kinds. On interval i, with t = (x - nodes[i]) / (nodes[i + 1] - nodes[i]) in [0, 1], it
is c0 + c1 t + c2 t^2 + c3 t^3.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

KINDS = ("hermite", "cubic", "linear")


def coefficients(nodes: np.ndarray, values: np.ndarray, kind: str, slopes: np.ndarray | None = None) -> np.ndarray:
    """Piecewise cubic coefficients of nodal functions.

    Args:
        nodes: ascending positions, shape (n,).
        values: nodal values of r functions, shape (n, r).
        kind: "hermite" (values and slopes given, local, error O(h^4)), "cubic" (not-a-knot spline through the values,
            error O(h^4); linear with less than four nodes) or "linear" (error O(h^2), no overshoot).
        slopes: nodal derivatives, shape (n, r); for hermite.

    Returns:
        shape (n - 1, 4, r).

    Raises:
        ValueError: nodes, values, slopes or kind are not what they must be.
    """
    nodes, values = np.asarray(nodes, float), np.asarray(values, float)
    if nodes.ndim != 1 or len(nodes) < 2 or not np.all(np.diff(nodes) > 0):
        raise ValueError(f"nodes must ascend and be at least 2, got {nodes.tolist()}")
    if values.ndim != 2 or len(values) != len(nodes) or not np.isfinite(values).all():
        raise ValueError(f"values must be finite and of shape ({len(nodes)}, r), got {values.shape}")
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {kind}")
    if kind == "hermite" and (slopes is None or slopes.shape != values.shape or not np.isfinite(slopes).all()):
        raise ValueError(f"slopes must be finite and of shape {values.shape} for hermite functions")
    steps = np.diff(nodes)
    if kind == "hermite":
        powers = CubicHermiteSpline(nodes, values, slopes, axis=0).c[::-1]
    elif kind == "cubic" and len(nodes) >= 4:
        powers = CubicSpline(nodes, values, axis=0).c[::-1]
    else:
        powers = np.zeros((4, len(steps), values.shape[1]))
        powers[0], powers[1] = values[:-1], np.diff(values, axis=0) / steps[:, None]
    scales = steps ** np.arange(4)[:, None]
    return np.ascontiguousarray((powers * scales[..., None]).transpose(1, 0, 2))


def nodal_slopes(nodes: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """Derivatives at the nodes, shape (n, r), of piecewise cubics that have one there, shape (n - 1, 4, r)."""
    steps = np.diff(nodes)[:, None]
    left, last = pieces[:, 1] / steps, (pieces[-1, 1] + 2 * pieces[-1, 2] + 3 * pieces[-1, 3]) / steps[-1]
    return np.concatenate([left, last[None]])

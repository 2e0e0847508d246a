"""One-dimensional nodal functions and their derivatives.

A nodal function is fixed by its values at nodes; here every one is a piecewise cubic, so that one evaluation serves
linear interpolation and cubic splines alike. On interval i, with t = x - nodes[i], it is c0 + c1 t + c2 t^2 + c3 t^3.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

KINDS = ("cubic", "linear")


def coefficients(nodes: np.ndarray, values: np.ndarray, kind: str) -> np.ndarray:
    """Piecewise cubic coefficients of nodal functions.

    Args:
        nodes: ascending positions, shape (n,).
        values: nodal values of r functions, shape (n, r).
        kind: "cubic" (not-a-knot spline, error O(h^4)) or "linear" (error O(h^2), no overshoot).

    Returns:
        shape (n - 1, 4, r).

    Raises:
        ValueError: nodes, values or kind are not what they must be.
    """
    nodes, values = np.asarray(nodes, float), np.asarray(values, float)
    if nodes.ndim != 1 or len(nodes) < 2 or not np.all(np.diff(nodes) > 0):
        raise ValueError(f"nodes must ascend and be at least 2, got {nodes.tolist()}")
    if values.ndim != 2 or len(values) != len(nodes) or not np.isfinite(values).all():
        raise ValueError(f"values must be finite and of shape ({len(nodes)}, r), got {values.shape}")
    if kind == "cubic" and len(nodes) >= 4:
        return np.ascontiguousarray(CubicSpline(nodes, values, axis=0).c.transpose(1, 0, 2)[:, ::-1])
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {kind}")
    piecewise = np.zeros((len(nodes) - 1, 4, values.shape[1]))
    piecewise[:, 0] = values[:-1]
    piecewise[:, 1] = np.diff(values, axis=0) / np.diff(nodes)[:, None]
    return piecewise

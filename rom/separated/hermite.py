"""One-dimensional functions given by values and slopes at nodes: piecewise cubics.

On interval i, with t = (x - nodes[i]) / (nodes[i + 1] - nodes[i]) in [0, 1], one is c0 + c1 t + c2 t^2 + c3 t^3. It is
local and errs with the fourth power of the spacing.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline


def coefficients(nodes: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Coefficients c of r functions, shape (n - 1, 4, r).

    Args:
        nodes: ascending positions, shape (n,).
        values: nodal values, shape (n, r).
        slopes: nodal derivatives, shape (n, r).

    Raises:
        ValueError: nodes, values or slopes are not what they must be.
    """
    nodes, values, slopes = (np.asarray(one, float) for one in (nodes, values, slopes))
    if nodes.ndim != 1 or len(nodes) < 2 or not np.all(np.diff(nodes) > 0):
        raise ValueError(f"nodes must ascend and be at least 2, got {nodes.tolist()}")
    if values.ndim != 2 or len(values) != len(nodes) or not np.isfinite(values).all():
        raise ValueError(f"values must be finite and of shape ({len(nodes)}, r), got {values.shape}")
    if slopes.shape != values.shape or not np.isfinite(slopes).all():
        raise ValueError(f"slopes must be finite and of shape {values.shape}, got {slopes.shape}")
    powers = CubicHermiteSpline(nodes, values, slopes, axis=0).c[::-1]
    scales = np.diff(nodes) ** np.arange(4)[:, None]
    return np.ascontiguousarray((powers * scales[..., None]).transpose(1, 0, 2))

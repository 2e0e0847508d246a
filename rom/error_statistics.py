"""Errors of many states in few numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def mean_size(field: np.ndarray) -> float:
    """Root mean square over nodes, of shape (nodes, 3)."""
    return float(np.sqrt(np.mean(np.sum(field**2, axis=1))))


def norm(values: np.ndarray) -> np.ndarray:
    """Of vectors in rows, shape (n, m); shape (n,)."""
    return np.linalg.norm(values, axis=1)


def statistics(absolute: np.ndarray, size: np.ndarray, estimate: np.ndarray | None = None) -> dict[str, float]:
    """Of errors in a quantity's unit, its sizes, and what a model estimates its errors at, shapes (states,)."""
    if not absolute.size:
        return {"count": 0}
    relative = absolute / np.maximum(size, np.finfo(float).tiny)
    return {
        "count": len(relative),
        "median": float(np.median(relative)),
        "p95": float(np.percentile(relative, 95)),
        "max": float(relative.max()),
        "p95_absolute": float(np.percentile(absolute, 95)),
    } | ({} if estimate is None else {"coverage": float(np.mean(absolute <= estimate))})


def quantiles(errors: Sequence[float] | np.ndarray) -> dict[str, float]:
    """Median, 95th percentile and largest of relative errors, shape (n,) [-]; those that are nan do not count."""
    known = np.asarray(errors)[~np.isnan(errors)]
    half, most, largest = np.quantile(known, [0.5, 0.95, 1.0]) if known.size else (np.nan,) * 3
    return {"median": float(half), "p95": float(most), "max": float(largest), "count": int(known.size)}

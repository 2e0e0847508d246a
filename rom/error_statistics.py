"""Errors of many states in few numbers."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

PRESSED = 0.03  # share of the largest pad pressure above which its relative errors are counted
FELT = 0.1  # [N] above which relative errors of contact forces are counted
REST = 1e-9  # [m]: of displacements and touch distances, below which no relative error is counted


def mean_size(field: np.ndarray) -> float:
    """Root mean square over nodes, of shape (nodes, 3)."""
    return float(np.sqrt(np.mean(np.sum(field**2, axis=1))))


def norm(values: np.ndarray) -> np.ndarray:
    """Norms of vectors in rows, shape (n, m); shape (n,)."""
    return np.linalg.norm(values, axis=1)


def statistics(absolute: np.ndarray, size: np.ndarray, estimate: np.ndarray | None = None) -> dict[str, float]:
    """Statistics of errors in a quantity's unit, by its sizes and its estimated errors, shapes (states,)."""
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


def differences(answer: Any, true: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Errors of an answer at n points (`rom.answer.Answer`) by quantity in its unit, shapes (n,).

    Args:
        answer: the answer.
        true: by quantity; others than the answer's are left out.
    """
    pairs = {name: (getattr(answer, name, None), value) for name, value in true.items()}
    off = {name: np.asarray(own - value) for name, (own, value) in pairs.items() if own is not None}
    return {name: norm(error) if error.ndim > 1 else np.abs(error) for name, error in off.items()}


def compared(
    answer: Any, true: Mapping[str, np.ndarray], off: Mapping[str, np.ndarray], inside: np.ndarray
) -> dict[str, dict[str, Any]]:
    """Statistics of errors relative to the true values, by quantity, see `statistics`.

    Contact forces count above FELT, pad pressures above PRESSED, and all else above REST.

    Args:
        answer: at n points.
        true: values by quantity, shapes (n,) or (n, 3), or (n, nodes, 3).
        off: errors by quantity, shapes (n,).
        inside: which points count, shape (n,).
    """
    least = {"contact_force": FELT, "pad_pressure": PRESSED * np.max(true.get("pad_pressure", 0.0), initial=0.0)}
    sizes = {
        name: np.abs(true[name]) if true[name].ndim == 1 else norm(true[name]) for name in off if true[name].ndim < 3
    }
    sizes |= {name: np.array([mean_size(field) for field in true[name]]) for name in off if true[name].ndim == 3}
    counted = {name: inside & (size > least.get(name, REST)) for name, size in sizes.items()}
    return {
        name: statistics(off[name][own], sizes[name][own], answer.error[name][own]) for name, own in counted.items()
    }

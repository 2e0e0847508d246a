"""Coordinates of nodes on a grid: equal up to round-off where they mean the same, and then compared by tolerances."""

import numpy as np

SHARE = 1e-6  # of a cell, or of the section's side: far above round-off, far below the thinnest cell [-]
SINGLE = 2.5e-7  # of a coordinate: two that a model file rounded to single precision differ by less [-]


def levels(values: np.ndarray, tolerance: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Distinct values among some that are equal up to round-off.

    Rounding to decimals would not do: two values on both sides of a rounding limit differ however near they are.

    Args:
        values: shape (n,), such as one coordinate of nodes on a grid [m].
        tolerance: values that follow each other by no more are one; by default SHARE of the largest such step, which
            between coordinates of a grid is its largest cell, or SINGLE of the largest value.

    Returns:
        the smallest of each, ascending, shape (m,); and which of them every value is, shape (n,).
    """
    order = np.argsort(values)
    ascending = np.asarray(values, float)[order]
    steps = np.diff(ascending)
    if tolerance is None:
        tolerance = max(SHARE * steps.max(initial=0.0), SINGLE * np.abs(ascending).max(initial=0.0))
    begins = np.append(True, steps > tolerance)
    index = np.empty(len(order), int)
    index[order] = np.cumsum(begins) - 1
    return ascending[begins[: len(ascending)]], index

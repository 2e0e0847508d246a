"""Which products of Chebyshev polynomials a law has: of a weighted total degree, as its inputs matter unlike."""

from __future__ import annotations

import numpy as np


def index_set(weights: np.ndarray, degree: float) -> np.ndarray:
    """Degrees a of all products with sum_i weights_i a_i <= degree, shape (k, inputs)."""
    rows, left = [[]], [degree + 1e-9]  # type: list[list[int]], list[float]
    for weight in weights:
        grown = [
            ([*row, power], rest - power * weight)
            for row, rest in zip(rows, left, strict=True)
            for power in range(int(rest / weight) + 1)
        ]
        rows, left = [row for row, _ in grown], [rest for _, rest in grown]
    return np.array(sorted(map(tuple, rows)), int).reshape(-1, len(weights))


def chosen(powers: np.ndarray, weights: np.ndarray, degree: float) -> np.ndarray:
    """Positions of the products of a weighted total degree among powers, shape (k, inputs); shape (j,)."""
    return np.flatnonzero(powers @ weights <= degree + 1e-9)

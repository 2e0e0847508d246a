"""Which products of Chebyshev polynomials a map has: of a weighted total degree, as its variables matter unlike."""

from __future__ import annotations

from itertools import product
from math import comb

import numpy as np

PURE = 11  # highest degree up to which tensions alone are in it: the free finger is known best and asked for most
PURE_TERMS = 250  # most products of tensions alone


def pure_degree(tensions: int, highest: int = PURE, terms: int = PURE_TERMS) -> int:
    """The total degree up to which products of tensions alone are few enough."""
    return max(degree for degree in range(highest + 1) if comb(degree + tensions, tensions) <= max(terms, 1))


def index_set(weights: np.ndarray, degree: float, tensions: int, pure: int | None = None) -> np.ndarray:
    """Degrees a of all products with sum_i weights_i a_i <= degree, shape (k, variables), in the order of their kinds.

    Products of tensions alone are in it up to a total degree `pure`, `pure_degree` if None. Products of the same powers
    of the wrench, the last variables, follow each other: for given tensions they are one coefficient.
    """
    found = {tuple(row) for row in _below(np.asarray(weights, float), degree)}
    pure = pure_degree(tensions) if pure is None else pure
    wrench = (0,) * (len(weights) - tensions)
    found |= {row + wrench for row in product(range(pure + 1), repeat=tensions) if sum(row) <= pure}
    return np.array(sorted(found, key=lambda row: (sum(row[tensions:]), row[tensions:], row)), int)


def tensions_alone(powers: np.ndarray, tensions: int) -> int:
    """Number of products without a wrench among powers, shape (k, variables)."""
    return int((~powers[:, tensions:].any(axis=1)).sum())


def _below(weights: np.ndarray, degree: float) -> list[list[int]]:
    rows, left = [[]], [degree + 1e-9]  # type: list[list[int]], list[float]
    for weight in weights:
        grown = [
            ([*row, power], rest - power * weight)
            for row, rest in zip(rows, left, strict=True)
            for power in range(int(rest / weight) + 1)
        ]
        rows, left = [row for row, _ in grown], [rest for _, rest in grown]
    return rows

"""Products of a wrench's polynomials as products of the force times products of the moment, as compiled code sums them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np

NONE = (0, 0, 0)  # powers of the product that is 1


def _products(triples: Iterable[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Different ones, that of powers zero first, then those that stand in most groups."""
    counts = Counter(triples)
    return sorted({NONE, *counts}, key=lambda one: (one != NONE, -counts[one], sum(one), one))


def padded(powers: np.ndarray) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]], list[int]]:
    """Products of forces and of moments, of powers of shape (k, 6), and with how many of the latter each of the former goes.

    With the first ones: what is missing among them has coefficients of 0. Polynomials of a total degree miss nothing.
    """
    groups = {(tuple(row[:3]), tuple(row[3:])) for row in powers.tolist()}
    forces, moments = _products(a for a, _ in groups), _products(b for _, b in groups)
    place = {b: k for k, b in enumerate(moments)}
    most = Counter({a: 1 for a in forces})
    for a, b in groups:
        most[a] = max(most[a], 1 + place[b])
    return forces, moments, [most[a] for a in forces]

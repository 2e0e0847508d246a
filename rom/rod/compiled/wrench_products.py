"""Products of a wrench's polynomials as a product of the force times one of the moment, as compiled code sums them."""

from collections import Counter
from collections.abc import Iterable

import numpy as np

NONE = (0, 0, 0)  # powers of the product that is 1
Powers = tuple[int, ...]


def padded(powers: np.ndarray) -> tuple[list[Powers], list[Powers], list[int]]:
    """Products of the force and of the moment, and with how many of the latter each of the former goes.

    With the first ones: what is missing among them has coefficients of 0. Polynomials of a total degree miss nothing.

    Args:
        powers: of the wrench's polynomials, shape (k, 6).
    """
    groups = {(tuple(row[:3]), tuple(row[3:])) for row in powers.tolist()}
    moments = _ordered(b for _, b in groups)
    place = {b: k for k, b in enumerate(moments)}
    counts: dict[Powers, int] = {}
    for a, b in groups:
        counts[a] = max(counts.get(a, 1), 1 + place[b])
    forces = sorted(counts, key=lambda one: (-counts[one], sum(one), one))
    return forces, moments, [counts[a] for a in forces]


def _ordered(products: Iterable[Powers]) -> list[Powers]:
    """Different ones, that of powers zero first, then those that stand in most groups."""
    counts = Counter(products)
    return sorted({NONE, *counts}, key=lambda one: (one != NONE, -counts[one], sum(one), one))

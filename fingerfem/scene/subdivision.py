"""Positions that contain every breakpoint and are as even as possible."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from rom.dataset.grid import levels

EQUAL = 1e-7  # of the side: positions that differ by less are meant to be equal [-]
SLIVER = 50  # mean over thinnest cell at which a mesh is refused: contact stiffness goes with the thinnest


def subdivide(breakpoints: ArrayLike, cells: int, symmetric: bool = False) -> np.ndarray:
    """Grid lines that contain every breakpoint, with the given number of cells, as even as possible.

    Args:
        breakpoints: ascending positions [m], shape (n,).
        cells: number of cells between the first and the last.
        symmetric: keep the lines of symmetric breakpoints symmetric.

    Raises:
        ValueError: the number of cells cannot fit the breakpoints, or not symmetrically.
    """
    points = np.asarray(breakpoints, float)
    lengths = np.diff(points)
    n = len(lengths)
    count = np.ones(n, int)
    while count.sum() < cells:
        # Split the widest cells first; a mirrored pair together, the outermost of equals first.
        _, width = levels(lengths / count, 1e-9 * (points[-1] - points[0]))
        for i in np.lexsort((np.arange(n), -width)):
            pair = {int(i), n - 1 - int(i)} if symmetric else {int(i)}
            if count.sum() + len(pair) <= cells:
                count[list(pair)] += 1
                break
        else:
            break
    if count.sum() != cells:
        parity = ", and even to stay symmetric" if symmetric and n % 2 == 0 else ""
        raise ValueError(
            f"must fit {n} intervals between channels, chambers and plates (at least {n} cells{parity}), got {cells}"
        )
    starts = zip(points[:-1], points[1:], count, strict=True)
    return np.append(np.concatenate([np.linspace(a, b, k, endpoint=False) for a, b, k in starts]), points[-1])


def merged(fixed: list[float], others: Iterable[float], equal: float) -> list[float]:
    """Ascending positions [m]: those that are fixed, and of the others what is farther than `equal` from these."""
    positions = list(fixed)
    for other in others:
        if min(abs(other - one) for one in positions) > equal:
            positions.append(other)
    return sorted(positions)

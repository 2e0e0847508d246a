"""Where a finger is cut into elements, among the cross-sections of its mesh."""

from __future__ import annotations

import numpy as np

from rom.elements.elements import CLAMP, INTERIOR, PLATE, WHOLE
from rom.snapshots.grid import SHARE

END = 1.0  # length of rubber in a clamp or plate piece, over the side: nearer, the section cannot warp freely [-]
LONGEST = 1.1  # length of an interior element over the side [-]

MOST_PAIRS = 12  # interior elements of one finger: samples of a state beyond these repeat each other

Pair = tuple[int, int]  # positions of the proximal and the distal body; the plate follows the last cross-section


def cut(at: np.ndarray, side: float) -> dict[str, list[Pair]]:
    """The elements of a finger by kind, each from all positions where it is.

    Args:
        at: where cross-sections are, from the clamp to the plate's near face, shape (m,) [m].
        side: of the section [m].
    """
    end, longest = END * side * (1 - SHARE), LONGEST * side
    plate = len(at)
    clamp_ends, plate_begins = np.flatnonzero(at >= end), np.flatnonzero(at[-1] - at >= end)
    if not clamp_ends.size or not plate_begins.size or clamp_ends[0] > plate_begins[-1]:
        return {WHOLE: [(0, plate)]}
    first, last = int(clamp_ends[0]), int(plate_begins[-1])
    inside = range(first, last + 1)
    interior = [(i, j) for i in inside for j in inside if 0 < at[j] - at[i] <= longest]
    interior = _some(interior)
    found = {CLAMP: [(0, first)], PLATE: [(last, plate)]}
    return found | ({INTERIOR: interior} if interior else {})


def _some(pairs: list[Pair]) -> list[Pair]:
    """Few of many pairs, of all lengths and places; the shortest and the longest are among them."""
    by_length = sorted(pairs, key=lambda pair: (pair[1] - pair[0], pair))
    chosen = np.linspace(0, len(pairs) - 1, min(len(pairs), MOST_PAIRS)).round().astype(int)
    return [by_length[k] for k in chosen]

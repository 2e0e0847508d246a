"""Cuts of a finger into elements, at cross-sections of its mesh."""

import numpy as np

from rom.dataset.geometry import END
from rom.dataset.grid import SHARE
from rom.elements.elements import CLAMP, INTERIOR, PLATE, WHOLE

LONGEST = 1.1  # length of an interior element over the side [-]

MOST_PAIRS = 12  # interior elements of one finger: samples of a state beyond these repeat each other

Pair = tuple[int, int]  # positions of the proximal and the distal body; the plate follows the last cross-section


def cut(at: np.ndarray, side: float) -> dict[str, list[Pair]]:
    """The elements of a finger by kind, each from all positions where it is.

    Args:
        at: where cross-sections are, from the clamp to the plate's near face, shape (m,) [m].
        side: largest extent of the section [m].
    """
    end, longest = END * side * (1 - SHARE), LONGEST * side
    plate = len(at)
    clamp_ends, plate_begins = np.flatnonzero(at >= end), np.flatnonzero(at[-1] - at >= end)
    if not clamp_ends.size or not plate_begins.size or clamp_ends[0] > plate_begins[-1]:
        return {WHOLE: [(0, plate)]}
    first, last = int(clamp_ends[0]), int(plate_begins[-1])
    interior = _some([(i, j) for i, j in _all(at, first, last, longest) if i < j])
    ends = {CLAMP: [(0, first)], PLATE: [(last, plate)]}
    return ends | ({INTERIOR: interior} if interior else {})


def _all(at: np.ndarray, first: int, last: int, longest: float) -> list[Pair]:
    """All pairs of cross-sections between two that are no farther apart than the longest element [m]."""
    inside = range(first, last + 1)
    return [(i, j) for i in inside for j in inside if 0 <= at[j] - at[i] <= longest]


def outline_pairs(at: np.ndarray, side: float) -> dict[str, list[Pair]]:
    """Cross-sections of elements by kind, each with the body that it is seen from; arguments of `cut`."""
    cuts, plate = cut(at, side), len(at)
    first, last = (cuts[CLAMP][0][1], cuts[PLATE][0][0]) if CLAMP in cuts else (0, 0)
    pairs = {
        CLAMP: [(k, first) for k in range(first + 1)],
        PLATE: [(k, plate) for k in range(last, plate)],
        WHOLE: [(k, plate) for k in range(plate)],
    }
    if INTERIOR in cuts:
        pairs[INTERIOR] = sorted(_all(at, first, last, LONGEST * side), key=lambda pair: (pair[1] - pair[0], pair))
    return {kind: pairs[kind] for kind in cuts}


def _some(pairs: list[Pair]) -> list[Pair]:
    """Few of many pairs, of all lengths and places; the shortest and the longest are among them."""
    by_length = sorted(pairs, key=lambda pair: (pair[1] - pair[0], pair))
    chosen = np.linspace(0, len(pairs) - 1, min(len(pairs), MOST_PAIRS)).round().astype(int)
    return [by_length[k] for k in chosen]

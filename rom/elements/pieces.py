"""The elements that a segment of a length consists of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from rom.dataset.grid import SHARE
from rom.elements.elements import CLAMP, INTERIOR, PLATE, WHOLE
from rom.files.checked_file import ModelError
from rom.native import LIBRARY

MOST_ELEMENTS = LIBRARY.constants.FINGERFEM_MOST_ELEMENTS  # of a segment


class Piece(NamedTuple):
    """An element of a segment: its kind, and its length at rest [m].

    `ends` are the sizes of its distal and of its proximal section, over those of a finger without taper [-].
    """

    kind: str
    length: float
    ends: tuple[float, float] = (1.0, 1.0)

    @property
    def size(self) -> float:
        """Size of the prismatic element that replaces it [-]: one of equal compliance in bending by a tendon.

        A curvature by a tendon goes with 1 / size^3, of which this is the mean.
        """
        distal, proximal = self.ends
        return float((2 * (distal * proximal) ** 2 / (distal + proximal)) ** (1 / 3)) if distal != proximal else distal


def pieces(lengths: Mapping[str, tuple[float, float]], length: float) -> list[Piece]:
    """The elements between a clamp and a plate's centre, from the plate to the clamp.

    Interior elements are as few as can be, and equally long.

    Args:
        lengths: shortest and longest of every kind of element [m].
        length: from the clamp to the plate's centre [m].

    Raises:
        ModelError: these elements make no segment of this length.
    """
    slack = SHARE * length
    if WHOLE in lengths:
        if abs(length - lengths[WHOLE][0]) > slack:
            raise ModelError(
                f"segment must be {lengths[WHOLE][0]:.6g} m long from clamp to plate's centre, as these elements are "
                f"of a finger in one piece, got {length:.6g}; train elements on a finger of three sides or more"
            )
        return [Piece(WHOLE, lengths[WHOLE][0])]
    ends = lengths[CLAMP][0] + lengths[PLATE][0]
    rest = length - ends
    if rest < -slack:
        raise ModelError(
            f"segment must be at least {ends:.6g} m long from clamp to plate's centre, the length of its clamp and "
            f"plate pieces, got {length:.6g}"
        )
    if rest > slack and INTERIOR not in lengths:
        raise ModelError(
            f"segment must be {ends:.6g} m long from clamp to plate's centre, as there is no interior element, "
            f"got {length:.6g}; train elements on a longer finger"
        )
    most = ends + (MOST_ELEMENTS - 2) * lengths[INTERIOR][1] if INTERIOR in lengths else ends
    if length > most + slack:
        raise ModelError(
            f"segment must be at most {most:.6g} m long from clamp to plate's centre, of {MOST_ELEMENTS} elements, "
            f"got {length:.6g}"
        )
    count = max(int(np.ceil(rest / lengths[INTERIOR][1] - SHARE)), 1) if rest > slack else 0
    interior = [Piece(INTERIOR, rest / max(count, 1))] * count
    return [Piece(PLATE, lengths[PLATE][0]), *interior, Piece(CLAMP, lengths[CLAMP][0])]


def cut(own: list[Piece], parts: int) -> list[Piece]:
    """The same elements with every interior one in equal parts; sections between them have the sizes on the way."""
    found = []
    for piece in own:
        count = parts if piece.kind == INTERIOR else 1
        sizes = np.linspace(*piece.ends, count + 1).tolist()
        found += [Piece(piece.kind, piece.length / count, (sizes[k], sizes[k + 1])) for k in range(count)]
    return found

"""The elements that a segment of a length consists of."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rom.dataset.grid import SHARE
from rom.elements.elements import CLAMP, INTERIOR, PLATE, WHOLE
from rom.files.checked_file import ModelError
from rom.native import LIBRARY

MOST_ELEMENTS = LIBRARY.constants.FINGERFEM_MOST_ELEMENTS  # of a segment


class Piece(NamedTuple):
    """An element of a segment: its kind, and its length at rest [m].

    `ends` are the sizes of its distal and of its proximal section, over those of a finger without taper [-]. `material`
    names another material than the segment's rubber, which is `modulus` times as stiff [-]. `hindered` are shares of a
    clamp's effect at both ends, see `rom.elements.transition`.
    """

    kind: str
    length: float
    ends: tuple[float, float] = (1.0, 1.0)
    material: str | None = None
    modulus: float = 1.0
    hindered: tuple[float, float] = (0.0, 0.0)

    def __str__(self) -> str:
        return self.kind if self.material is None else f"{self.kind} ({self.material}, {self.modulus:g} x as stiff)"

    @property
    def size(self) -> float:
        """Size of the prismatic element that replaces it [-]: one of equal compliance in bending by a tendon.

        A curvature by a tendon goes with 1 / size^3, of which this is the mean.
        """
        distal, proximal = self.ends
        return float((2 * (distal * proximal) ** 2 / (distal + proximal)) ** (1 / 3)) if distal != proximal else distal


def pieces(lengths: Mapping[str, tuple[float, float]], length: float, cuts: Sequence[float] = ()) -> list[Piece]:
    """The elements between a clamp and a plate's centre, from the plate to the clamp.

    Interior elements are as few as can be, and equally long between two cuts.

    Args:
        lengths: shortest and longest of every kind of element [m].
        length: from the clamp to the plate's centre [m].
        cuts: distances from the clamp at which interior elements end, ascending [m].

    Raises:
        ModelError: these elements make no segment of this length, or cannot end at a cut.
    """
    slack = SHARE * length
    if WHOLE in lengths:
        if cuts:
            raise ModelError(f"element must be cut at {cuts[0]:.6g} m from its clamp, got a finger in one piece")
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
    interior, stops = list[Piece](), stops_of((lengths[CLAMP][0], length - lengths[PLATE][0]), cuts, slack)
    for begin, end in pairwise(stops) if rest > slack else ():
        count = max(int(np.ceil((end - begin) / lengths[INTERIOR][1] - SHARE)), 1)
        interior = [Piece(INTERIOR, (end - begin) / count)] * count + interior
    return [Piece(PLATE, lengths[PLATE][0]), *interior, Piece(CLAMP, lengths[CLAMP][0])]


def stops_of(ends: tuple[float, float], cuts: Sequence[float], slack: float) -> list[float]:
    """Return where interior elements begin and end: between both ends, and at every cut, ascending [m].

    Args:
        ends: of the clamp piece, and where the plate piece begins [m].
        cuts: ascending [m].
        slack: distance from an end within which a cut is that end [m].

    Raises:
        ModelError: a cut within the clamp or the plate piece.
    """
    first, last = ends
    if beyond := [one for one in cuts if not first - slack <= one <= last + slack]:
        raise ModelError(
            f"material must begin and end from {first:.6g} to {last:.6g} m from the segment's clamp, between its clamp "
            f"and plate pieces, got {beyond[0]:.6g}"
        )
    return [first, *(one for one in cuts if first + slack < one < last - slack), last]


def cut(own: list[Piece], parts: int) -> list[Piece]:
    """The same elements with every interior one in equal parts; sections between them have the sizes on the way."""
    parts_of_all = []
    for piece in own:
        count = parts if piece.kind == INTERIOR else 1
        sizes = np.linspace(*piece.ends, count + 1).tolist()
        part, (distal, proximal) = piece._replace(length=piece.length / count), piece.hindered
        parts_of_all += [
            part._replace(
                ends=(sizes[k], sizes[k + 1]),
                hindered=(distal if k == 0 else 0.0, proximal if k == count - 1 else 0.0),
            )
            for k in range(count)
        ]
    return parts_of_all

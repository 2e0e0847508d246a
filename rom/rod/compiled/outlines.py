"""The outline of an element as compiled code has it: corners of a few of its cross-sections, its knots."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.elements.elements import INTERIOR
from rom.elements.outline import OutlineLaw
from rom.elements.pieces import Piece
from rom.elements.polynomial import Polynomial

STEP, END_STEP = 0.55, 0.28  # of the side: most between knots, and where a plate or the clamp hinders warping [-]
NUMBERS = 12  # of a knot: four corners, -y -z, -y z, y -z and y z


@brief
@dataclass(frozen=True, kw_only=True)
class Outline:
    """Corners of an element's knots, seen from its distal section or from its plate's centre.

    Attributes:
        polynomial: by combinations of tensions, as its element's, and the wrench that the distal section carries
            [N, N m]: 12 values of every knot [m].
        distances: of the knots from the distal section at rest, from the clamp's side to the plate's, shape
            (knots,) [m].
        length: of the element at rest [m].
    """

    polynomial: Polynomial
    distances: np.ndarray
    length: float


def outline_of(law: OutlineLaw, piece: Piece, begins: float) -> Outline:
    """The outline of an element, its knots evenly along its rubber and half as far from its ends.

    Args:
        law: of its kind.
        piece: its kind, and its length at rest [m].
        begins: where its rubber begins, from its distal section on [m]: 0, or a plate's half.
    """
    length = piece.length - begins
    count = max(int(np.ceil(length / (2 * law.half.max() * (STEP if piece.kind == INTERIOR else END_STEP)))), 1)
    shares = 1 - (np.arange(count) + 0.5) / count  # of the way from the distal end
    distances, (distal, proximal) = begins + length * shares, piece.ends
    sizes = (distal + (proximal - distal) * shares) / piece.size
    knots = [(replace(law, half=law.half * own), at) for own, at in zip(sizes, distances, strict=True)]
    polynomial = Polynomial.together([one.at(float(distance)) for one, distance in knots])
    return Outline(polynomial=polynomial, distances=distances, length=piece.length)


def knots_of(outlines: Sequence[Outline], begins: float) -> np.ndarray:
    """Positions of a segment's knots along it at rest, from the clamp on, shape (knots,) [m].

    The first is where the rubber begins, the last where it ends: at the plate's face.

    Args:
        outlines: of the elements, from the plate to the clamp.
        begins: where the plate's rubber begins, from its centre on [m].
    """
    ends = np.cumsum([one.length for one in outlines])
    distal = ends - [one.length for one in outlines]  # from the plate's centre
    own = [start + one.distances for start, one in zip(distal, outlines, strict=True)]
    return ends[-1] - np.concatenate([[ends[-1]], *own[::-1], [begins]])

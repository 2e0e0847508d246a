"""Elements of a tapered segment: each represents a frustum of rubber between sections of two sizes.

It is a trained prismatic element, scaled to one size, with corrections of first order in the relative taper
p = s' / s along x. Let l be the length and u the distance from the distal section. In a plane of bending, with the
bending stiffness E I and the shear compliance c per length:

    a tendon has the curvature k (1 + 3 p (u - l/2)), and its force along the converging channel shears by -c p E I k,
    a moment m has m / (E I) (1 + 4 p (u - l/2)),
    a force f has f u / (E I) (1 + 4 p (u - l/2)).

So the proximal section, seen from the distal one, turns about a centre offset from the middle towards the thinner end:
by p (l^2/4 - c E I) under tendons, and by p l^2/3 under m. Under f it turns by p l^3 / (3 E I) more. The size of an
element has the mean of 1 / s^3; the mean of 1 / s^4, for moments, is larger by (p l)^2 / 6.

If the neutral axis is off the section's centre, an axial force N at the centre bends as a tendon does: k = K N at
rest. It has no component across the axis, so it does not shear; all tendons and N together shear by -c p E I (k - K N),
with the axial forces of tendons in N.

`c E I` is that of the interior element: no constant is fitted. Errors by section and taper: docs/accuracy.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rom.dataset.grid import SHARE
from rom.elements.elements import CLAMP, INTERIOR, PLATE
from rom.elements.law import ElementLaw, ElementMap
from rom.elements.pieces import MOST_ELEMENTS, Piece, pieces, stops_of
from rom.elements.polynomial import Polynomial
from rom.files.checked_file import ModelError

PLANES = (1, 5, 1), (2, 4, -1)  # of bending: indices of position and force, of rotation and moment; sign
ROUNDS = 50  # of the fixed point for sizes of end pieces; each reduces the error to a tenth


class TaperedRubber(NamedTuple):
    """The rubber of a segment, whose section has the sizes `begin` and `end` relative to size 1 [-].

    `length` is from the clamp to the plate's centre, `half` is half the plate's thickness at size 1 [m].
    """

    begin: float
    end: float
    length: float
    half: float

    def size_at(self, x: float) -> float:
        """Size of the section at x from the clamp [m]."""
        return self.begin + (self.end - self.begin) * x / (self.length - self.end * self.half)


def tapered_pieces(
    lengths: Mapping[str, tuple[float, float]], rubber: TaperedRubber, cuts: Sequence[float] = ()
) -> list[Piece]:
    """Return the elements of a segment; with a taper, interior elements between two cuts have equal ratios of sizes.

    Args:
        lengths: shortest and longest length of every kind of element at size 1 [m].
        rubber: of the segment.
        cuts: distances from the clamp at which interior elements end, ascending [m].

    Raises:
        ModelError: the segment is too short or too long, there is no interior element, or none can end at a cut.
    """
    if rubber.begin == rubber.end:
        own = {kind: (rubber.end * least, rubber.end * most) for kind, (least, most) in lengths.items()}
        return [one._replace(ends=(rubber.end, rubber.end)) for one in pieces(own, rubber.length, cuts)]
    if INTERIOR not in lengths:
        raise ModelError("taper needs an interior element, got none: train elements on a longer finger")
    length, (clamp, plate) = rubber.length, (lengths[kind][0] for kind in (CLAMP, PLATE))
    first, last = Piece(CLAMP, clamp, (rubber.begin,) * 2), Piece(PLATE, plate, (rubber.end,) * 2)
    for _ in range(ROUNDS):
        x = first.size * clamp, length - last.size * plate
        first = Piece(CLAMP, first.size * clamp, (rubber.size_at(x[0]), rubber.begin))
        last = Piece(PLATE, last.size * plate, (rubber.end, rubber.size_at(x[1])))
    if x[0] >= x[1]:
        raise ModelError(
            f"segment must be longer than {x[0] + length - x[1]:.6g} m from clamp to plate's centre, the length of its "
            f"clamp and plate pieces, got {length:.6g}"
        )
    interior = list[Piece]()
    for span in pairwise(stops_of(x, cuts, SHARE * length)):
        interior = _frusta(rubber, span, lengths[INTERIOR][1]) + interior
    if len(interior) > MOST_ELEMENTS - 2:
        raise ModelError(f"segment must have at most {MOST_ELEMENTS} elements, got a length of {length:.6g} m")
    return [last, *interior, first]


def _frusta(rubber: TaperedRubber, span: tuple[float, float], longest: float) -> list[Piece]:
    """Fewest interior elements between two distances from the clamp, from plate to clamp; at most MOST_ELEMENTS.

    Their ratios of end sizes are equal, and their lengths at most `longest` times their size [m].
    """
    sizes = rubber.size_at(span[0]), rubber.size_at(span[1])
    interior = [Piece(INTERIOR, np.inf)]
    while any(one.length > one.size * longest for one in interior) and len(interior) < MOST_ELEMENTS:
        count = len(interior) + int(interior[0].length < np.inf)
        ends = np.geomspace(*sizes, count + 1)
        at = span[0] + (span[1] - span[0]) * (ends - sizes[0]) / (sizes[1] - sizes[0])
        interior = [
            Piece(INTERIOR, float(at[k] - at[k - 1]), (float(ends[k]), float(ends[k - 1]))) for k in range(count, 0, -1)
        ]
    return interior


def shear_by_bending(interior: ElementLaw) -> np.ndarray:
    """Return shear compliance times bending stiffness of an interior element, c E I towards y and z, shape (2,) [m^2].

    It follows from the linear law at rest. Seen from the distal section, a force f there displaces the proximal section
    by f (l^3 / (6 E I) - c l). A moment m turns it by -m l / (E I).
    """
    length, t = interior.lengths[1], interior.tensions.shape[1]
    _, gradient = interior.of_length(length).value_and_gradient(np.zeros((1, t + 6)))
    by = gradient[0, :, t:]
    return np.array([length**2 / 6 + by[k, k] / (2 * by[turn, turn]) for k, turn, _ in PLANES])


def tapered(element: ElementMap, piece: Piece, shear: np.ndarray, guided: np.ndarray) -> ElementMap:
    """Return a prismatic element with the corrections of its frustum.

    Args:
        element: of the piece's size and length, by all loads.
        piece: length and end sizes.
        shear: c E I at size 1, shape (2,) [m^2], see `shear_by_bending`.
        guided: 1 of tendons in channels, 0 of other loads, shape (t,).
    """
    law, length = element.polynomial, piece.length
    ratio = float(np.log(piece.ends[0] / piece.ends[1]))  # p l
    coefficients, wrench = law.coefficients.copy(), law.powers[:, -6:]
    linear = [(wrench == one).all(axis=1) for one in np.eye(6)]  # terms that a component of the wrench is linear in
    for (k, turn, sign), own in zip(PLANES, shear, strict=True):
        turns, moment, force = 2 * law.coefficients[:, turn], linear[turn], linear[k]  # the law has half turns
        nearer = np.full(len(turns), ratio / length * (length**2 / 4 - own * piece.size**2))
        nearer[moment], nearer[force] = ratio * length / 3, 0.0
        coefficients[:, k] += sign * nearer * turns
        coefficients[force, turn] *= 1 + ratio * 2 / 3
    for turn in range(3, 6):
        coefficients[linear[turn], turn] *= 1 + ratio**2 / 6
    # the axial force f_x - sum F, by the polynomial's inputs
    axial = np.concatenate([-element.tension_map @ guided, np.eye(6)[0]])
    rest, slopes = np.zeros((1, len(guided) + 6)), np.zeros((law.coefficients.shape[1], len(axial)))
    at_rest = element.value_and_gradient(rest)[1][0][:, -6]
    for (k, turn, sign), own in zip(PLANES, shear, strict=True):
        slopes[k] = sign * ratio / length * own * piece.size**2 * 2 * at_rest[turn] * axial
    corrected = replace(law, coefficients=coefficients).plus(Polynomial.linear(law.lower, law.upper, slopes))
    return replace(element, polynomial=corrected)

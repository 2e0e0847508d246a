"""Elements of a tapered segment: each stands for a frustum of rubber, between sections of two sizes.

It is a trained prismatic element, scaled to one size by similarity, and bends as the frustum does under a tendon. With
the relative taper p = s' / s along x and the length l, its pose gets two terms of first order in p.

Under a wrench (f, m) the stress of bending runs along fibres that converge, so that the shear force of a section is
f_y + p m_z, and f_z - p m_y (Timoshenko, Strength of Materials, on tapered beams). With the shear compliance c of the
element, its energy ((f_y + p m_z)^2 + (f_z - p m_y)^2) c / 2 adds to the proximal section, seen from the distal one,

    place y: -c p m_z        turn about z: -c p (f_y + p m_z)
    place z:  c p m_y        turn about y:  c p (f_z - p m_y).

Under a tendon the curvature goes with 1 / s^3, so that the centre of the frustum's turn lies nearer to its thinner end
than its middle, by p l^2 / 4 if its sections stay plane. They do not: the full-order model has p (l^2 - b^2) / 4 with b
= WARPING sides, whatever the length of the elements (tapers 0.7 and 0.5; lengths from 0.3 to 1 side).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rom.elements.elements import CLAMP, INTERIOR, PLATE
from rom.elements.law import ElementMap
from rom.elements.pieces import MOST_ELEMENTS, Piece, pieces
from rom.files.checked_file import ModelError

WARPING = 0.98  # b over the side [-]
ROUNDS = 50  # of the fixed point for sizes of end pieces; each reduces the error to a tenth


class TaperedRubber(NamedTuple):
    """The rubber of a segment between the sizes of its sections, over those of a finger without taper [-].

    `length` is from the clamp to the plate's centre, `half` is half its plate's thickness at size 1 [m].
    """

    begin: float
    end: float
    length: float
    half: float

    def size_at(self, x: float) -> float:
        """Of the section at x from the clamp [m]."""
        return self.begin + (self.end - self.begin) * x / (self.length - self.end * self.half)


def tapered_pieces(lengths: Mapping[str, tuple[float, float]], rubber: TaperedRubber) -> list[Piece]:
    """The elements of a segment: with a taper end pieces at their own size, interior ones at even ratios of sizes.

    Args:
        lengths: shortest and longest of every kind of element at size 1 [m].
        rubber: between clamp and plate.

    Raises:
        ModelError: these elements make no such segment.
    """
    if rubber.begin == rubber.end:
        own = {kind: (rubber.end * least, rubber.end * most) for kind, (least, most) in lengths.items()}
        return [one._replace(ends=(rubber.end, rubber.end)) for one in pieces(own, rubber.length)]
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
    sizes, count = (rubber.size_at(x[0]), rubber.size_at(x[1])), 0
    interior = [Piece(INTERIOR, np.inf)]
    while any(one.length > one.size * lengths[INTERIOR][1] for one in interior):
        count += 1
        if count > MOST_ELEMENTS - 2:
            raise ModelError(f"segment must have at most {MOST_ELEMENTS} elements, got a length of {length:.6g} m")
        ends = np.geomspace(*sizes, count + 1)
        at = x[0] + (x[1] - x[0]) * (ends - sizes[0]) / (sizes[1] - sizes[0])
        interior = [
            Piece(INTERIOR, float(at[k] - at[k - 1]), (float(ends[k]), float(ends[k - 1]))) for k in range(count, 0, -1)
        ]
    return [last, *interior, first]


def shear_compliance(element: ElementMap, length: float) -> float:
    """Of an element of a length at rest [m], over that length, without loads [1/N].

    Under a force f_y at its distal section its proximal one is displaced by f_y (l^3 / (6 E I) - c), seen from there,
    under a moment it turns by -m_z l / (E I).
    """
    t = element.tension_map.shape[1]
    _, gradient = element.value_and_gradient(np.zeros((1, t + 6)))
    by_force, half_turn_by_moment = gradient[0, 1, t + 1], gradient[0, 5, t + 5]
    return float(-(half_turn_by_moment * length**2 / 3 + by_force) / length)


class Prism(NamedTuple):
    """The prismatic elements at size 1: side [m], and shear compliance over the length [1/N]."""

    side: float
    shear: float


def tapered(element: ElementMap, piece: Piece, prism: Prism) -> ElementMap:
    """A prismatic element with both first-order terms of its frustum.

    Args:
        element: at the piece's size and length.
        piece: its length and sizes.
        prism: at size 1.
    """
    law, m = element.polynomial, len(element.tension_map)
    ratio = float(np.log(piece.ends[0] / piece.ends[1]))  # p l
    nearer = ratio * (piece.length**2 - (WARPING * prism.side * piece.size) ** 2) / (4 * piece.length)
    moved = law.coefficients.copy()
    moved[:, 1:3] += 2 * nearer * law.coefficients[:, [5, 4]] * [1, -1]  # half turns about z and y
    c = prism.shear / piece.size**2 * ratio
    by_wrench = np.zeros((6, law.coefficients.shape[1]))
    by_wrench[1, 5], by_wrench[5, 5], by_wrench[5, 1] = -c / 2, -c / 2 * ratio / piece.length, -c
    by_wrench[2, 4], by_wrench[4, 4], by_wrench[4, 2] = c / 2, -c / 2 * ratio / piece.length, c
    halves = (law.upper - law.lower)[m:, None] / 2
    more = replace(law, powers=np.eye(m + 6, dtype=int)[m:], coefficients=halves * by_wrench)
    return replace(element, polynomial=replace(law, coefficients=moved).plus(more))

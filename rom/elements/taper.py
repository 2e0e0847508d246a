"""Elements of a tapered segment: each stands for a frustum of rubber, between sections of two sizes.

It is a trained prismatic element, scaled to one size by similarity, and bends as the frustum does under a tendon. Under
a wrench a frustum has a further compliance, of first order in its taper. The stress of bending runs along fibres that
converge, so that the shear force of a section is, with the relative taper p = s' / s along x,

    f_y + p m_z    and    f_z - p m_y        (Timoshenko, Strength of Materials, on tapered beams)

where f and m are the wrench. With the shear compliance c of the element, its energy ((f_y + p m_z)^2 + (f_z - p m_y)^2)
c / 2 adds to the pose of its proximal section, seen from the distal one,

    place y: -c p m_z        turn about z: -c p (f_y + p m_z)
    place z:  c p m_y        turn about y:  c p (f_z - p m_y).

Elements about one side long are best: the centre of a frustum's turn lies nearer to its thinner end than that of a
prismatic element, by as much as that of a frustum of such a length would be expected to in a beam of cross-sections
that stay plane, and sections that warp take this back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rom.checked_file import ModelError
from rom.elements.elements import CLAMP, INTERIOR, PLATE
from rom.elements.law import ElementMap
from rom.elements.pieces import MOST_ELEMENTS, Piece
from rom.elements.polynomial import Polynomial

ROUNDS = 50  # towards a size that a piece's own length depends on; each takes away nine tenths of what is off


class Rubber(NamedTuple):
    """The rubber of a segment between the sizes of its sections, over those of a finger without taper [-].

    `half` is that of its plate's thickness at size 1, `length` that of the rubber [m].
    """

    begin: float
    end: float
    length: float
    half: float

    def size_at(self, x: float) -> float:
        """Of the section at x from the clamp [m]."""
        return self.begin + (self.end - self.begin) * x / self.length


def tapered_pieces(lengths: Mapping[str, tuple[float, float]], rubber: Rubber) -> list[Piece]:
    """The elements of rubber with a taper: end pieces at their own size, interior ones at even ratios of sizes.

    Args:
        lengths: shortest and longest of every kind of element at size 1 [m].
        rubber: between clamp and plate.

    Raises:
        ModelError: these elements make no such segment.
    """
    if INTERIOR not in lengths:
        raise ModelError("taper needs an interior element, got none: train elements on a longer finger")
    length, (clamp, plate) = rubber.length + rubber.end * rubber.half, (lengths[kind][0] for kind in (CLAMP, PLATE))
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


def sheared(element: ElementMap, piece: Piece, compliance: float) -> ElementMap:
    """A prismatic element with the further compliance of the frustum that it stands for.

    Args:
        element: it.
        piece: its length and sizes.
        compliance: in shear, over its length, at size 1 [1/N].
    """
    law, m = element.polynomial, len(element.tension_map)
    taper = float(np.log(piece.ends[0] / piece.ends[1]))
    c = compliance / piece.size**2 * taper
    by_wrench = np.zeros((6, law.coefficients.shape[1]))
    by_wrench[1, 5], by_wrench[5, 5], by_wrench[5, 1] = -c / 2, -c / 2 * taper / piece.length, -c
    by_wrench[2, 4], by_wrench[4, 4], by_wrench[4, 2] = c / 2, -c / 2 * taper / piece.length, c
    halves = (law.upper - law.lower)[m:, None] / 2
    more = Polynomial(
        lower=law.lower, upper=law.upper, powers=np.eye(m + 6, dtype=int)[m:], coefficients=halves * by_wrench
    )
    return replace(element, polynomial=law.plus(more))

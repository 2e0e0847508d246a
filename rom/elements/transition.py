"""Effect of a change of material along the axis: the softer element deforms less, as the stiffer hinders its section.

At a clamp, an element differs from an interior one of its length by D, a function of loads and wrench. Between moduli E
and r E, r > 1, with equal Poisson's ratios, lateral strains differ by 1 - 1/r of what the clamp hinders, and both sides
yield, as 1 to 1/r. The least complementary energy of self-equilibrated stresses at the interface gives the softer
element the share (1 - 1/r)^2 / (1 + 1/r) of D.

D acts near the interface. Seen from the distal section of an element of length l, the proximal section moves as at a
clamp where the interface is there. If the interface is the distal section, D turns all of the element by its turn T,
about a point as far from that section: the sum of both displacements across the axis is T times -l e_x.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rom.dataset.grid import SHARE
from rom.elements.elements import CLAMP, INTERIOR
from rom.elements.law import ElementLaw, ElementMap
from rom.elements.pieces import Piece
from rom.elements.polynomial import Polynomial
from rom.files.checked_file import ModelError

ACROSS = (1, 5, 1), (2, 4, -1)  # displacement across the axis, the turn that has it as its lever's, and its sign


def with_transitions(element: ElementMap, piece: Piece, laws: Mapping[str, ElementLaw]) -> ElementMap:
    """Return an element with the effect of stiffer neighbours.

    Args:
        element: of the piece, by all loads.
        piece: with the shares of D at both ends.
        laws: by kind, at the size and modulus of the piece.

    Raises:
        ModelError: there is no interior element as long as the clamp piece.
    """
    distal, proximal = piece.hindered
    if not distal and not proximal:
        return element
    if INTERIOR not in laws:
        raise ModelError("materials along a part need an interior element, got none: train elements on a longer finger")
    length, law, m = laws[CLAMP].lengths[0], element.polynomial, len(element.tension_map)
    if length > laws[INTERIOR].lengths[1] * (1 + SHARE):
        raise ModelError(
            f"materials along a part need interior elements as long as the clamp piece, {length:.6g} m, got at "
            f"most {laws[INTERIOR].lengths[1]:.6g} m: train on a mesh with sections at one side from the clamp"
        )
    parts = [laws[kind].of_length(length).polynomial for kind in (CLAMP, INTERIOR)]
    # on the wrenches that all of them were trained with
    lower, upper = law.lower.copy(), law.upper.copy()
    lower[m:] = np.max([one.lower[m:] for one in (law, *parts)], axis=0)
    upper[m:] = np.min([one.upper[m:] for one in (law, *parts)], axis=0)
    law, clamp, interior = (one.on(lower, upper) for one in (law, *parts))
    difference = clamp.plus(_times(interior, -1.0))
    turned = difference.coefficients.copy()
    for across, turn, sign in ACROSS:
        # the law has half turns
        turned[:, across] = sign * -2 * piece.length * turned[:, turn] - turned[:, across]
    other = replace(difference, coefficients=turned)
    polynomial = law.plus(_times(difference, proximal)).plus(_times(other, distal))
    deviations = None if element.deviations is None else element.deviations.on(lower, upper)
    return replace(element, polynomial=polynomial, deviations=deviations)


def hindered_share(modulus: float, neighbour: float) -> float:
    """Return the share of D that an element has at its end, by its modulus and its neighbour's [Pa]."""
    softer = modulus / neighbour
    return max(1 - softer, 0.0) ** 2 / (1 + softer)


def _times(polynomial: Polynomial, factor: float) -> Polynomial:
    return replace(polynomial, coefficients=factor * polynomial.coefficients)

"""Limits of compiled code on a rod of elements, checked when its struct is made; refused by name and limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rom.elements.law import ElementMap
from rom.elements.march import march
from rom.elements.pieces import MOST_ELEMENTS
from rom.elements.polynomial import Polynomial
from rom.files.checked_file import require
from rom.native import LIBRARY
from rom.rod.compiled.wrench_products import padded

if TYPE_CHECKING:
    from rom.rod.compiled import CondensedSegment, Outline
    from rom.rod.rod import Rod
    from rom.rod.segment import Segment

MOST_TENSIONS, MOST_POWER = LIBRARY.constants.FINGERFEM_MOST_TENSIONS, LIBRARY.constants.FINGERFEM_MOST_POWER
MOST_VARIANTS = LIBRARY.constants.FINGERFEM_MOST_VARIANTS
MOST_PRODUCTS = 1 << 20  # of a polynomial: with these, places in memory are counted in 32 bits
FARTHEST = 2.0  # a plate that nothing touches, from its clamp, over its segment's length [-]
MOST_KNOTS = 16  # of an element's outline; one side long it has two
WRENCH, CORNERS = LIBRARY.constants.FINGERFEM_WRENCH, LIBRARY.constants.FINGERFEM_CORNERS
ELEMENT = LIBRARY.constants.FINGERFEM_BLOCK_ROW // LIBRARY.constants.FINGERFEM_BLOCK  # numbers of an element's pose
KNOT = 12  # numbers of a knot


def check(rod: Rod) -> None:
    """Refuse a finger that compiled code cannot read, also one whose errors are no numbers.

    Raises:
        ModelError: one line that names what and its limit.
    """
    for k, one in enumerate(rod.segments):
        check_rod(one.condensed)
        with np.errstate(all="ignore"):
            away = np.linalg.norm(_ends_of_free_plate(one), axis=1)
        near = bool((away < FARTHEST * one.length).all())  # not where it is nan
        require(near, f"free plate {k + 1} must be within {FARTHEST:g} lengths of its clamp", away.tolist())
    for name in ("contact_force", "position", "surface", "turn", "shortening", "growth"):
        value = getattr(rod.errors, name)
        require(0 <= value < np.inf, f"the expected error of {name} must be finite and at least 0", value)
    for name in ("accuracy", "calibration"):
        require(isinstance(getattr(rod, name), dict), f"{name} must be a table", getattr(rod, name))


def _ends_of_free_plate(segment: Segment) -> np.ndarray:
    """Positions of the free plate at the lowest and the highest tensions, seen from the clamp, shape (2, 3) [m]."""
    lowest, highest = segment.elements[0].tensions
    return march(segment.elements, np.array([lowest, highest]), np.zeros((2, WRENCH))).plate[0]


def check_rod(segment: CondensedSegment) -> None:
    """Refuse a rod of elements beyond what compiled code holds.

    Raises:
        ModelError: one line that names what and its limit.
    """
    elements = segment.elements
    require(1 <= len(elements) <= MOST_ELEMENTS, f"elements must be from 1 to {MOST_ELEMENTS}", len(elements))
    first, box = elements[0].polynomial, elements[0].tensions
    t = _tension_map(elements[0])
    laws, most = {id(one): one for one in elements}, 0
    for k, element in enumerate(laws.values()):
        one = element.polynomial
        _polynomial(f"powers of law {k}", one, t, ELEMENT)
        _deviations(element, k, elements[0])
        _ends(one, t)
        own = [*element.tensions, *element.tension_map, one.lower[:t], one.upper[:t]]
        _alike("tensions of all elements", own, [*box, *elements[0].tension_map, first.lower[:t], first.upper[:t]])
        _, _, counts = padded(one.powers[:, t:])
        most = max(most, sum(counts) * len(np.unique(one.powers[:, :t], axis=0)))
    size = len(laws) * most
    require(size <= MOST_PRODUCTS, f"laws must have at most {MOST_PRODUCTS} products, all as the largest, padded", size)
    if segment.corners is not None:
        corners = segment.corners
        _polynomial("corner_powers", corners, t, CORNERS)
        _alike("corners and the plate's element", [corners.lower, corners.upper], [first.lower, first.upper])
    if segment.shortenings is not None:
        _shortenings(segment.shortenings, elements)
    if segment.section is not None:
        half, box = segment.half_lengths[1:], segment.section.box
        require(np.allclose(half, box, rtol=1e-9), f"half_lengths must be those of the section's box, {box}", half)
        prism = segment.section.is_rectangle or segment.corners is None
        require(prism, "corners must be left out of a plate that is no box", "some")
    if segment.outlines is not None:
        _outlines(segment.outlines, elements, float(segment.half_lengths[0]))


def _deviations(element: ElementMap, k: int, first: ElementMap) -> None:
    """Checks the number of variants of law k: as many as of the first element."""
    one, other = element.deviations, first.deviations
    require((one is None) == (other is None), "variants must be of all laws, or of none", f"law {k}")
    if one is None or other is None:
        return
    count, rest = divmod(other.coefficients.shape[1], ELEMENT)
    most = f"variants must be from 1 to {MOST_VARIANTS}"
    require(rest == 0 and 1 <= count <= MOST_VARIANTS, most, other.coefficients.shape[1] / ELEMENT)
    t = len(element.tension_map)
    _polynomial(f"powers of variants of law {k}", one, t, ELEMENT * count)
    _ends(one, t)
    law = element.polynomial
    _alike("tensions of a law and its variants", [one.lower, one.upper], [law.lower, law.upper])
    single = np.abs(one.coefficients).max() <= np.finfo(np.float32).max
    require(bool(single), f"coefficients of variants of law {k} must be finite in single precision", "others")


def _tension_map(element: ElementMap) -> int:
    """Number of combinations of the tensions that polynomials are of."""
    combinations, count = element.tension_map.shape if element.tension_map.ndim == 2 else (0, 0)
    for name, number in (("tensions", count), ("combinations of tensions", combinations)):
        require(1 <= number <= MOST_TENSIONS, f"{name} must be from 1 to {MOST_TENSIONS}", number)
    require(bool(np.isfinite(element.tension_map).all()), "tension_map must be finite", "others")
    box = element.tensions
    ordered = box.shape == (2, count) and bool(np.isfinite(box).all() and (box[0] < box[1]).all())
    require(ordered, "tensions must have finite lowest ones below the highest", box.tolist())
    return combinations


def _alike(name: str, one: list[np.ndarray], other: list[np.ndarray]) -> None:
    alike = len(one) == len(other) and all(map(np.array_equal, one, other))
    require(alike, f"{name} must have one box", [*map(np.ndarray.tolist, one)])


def _shortenings(shortenings: Sequence[Polynomial], elements: Sequence[ElementMap]) -> None:
    """Checks the tendons' shortenings: compiled code evaluates them with the products of the elements' laws."""
    count = len(elements)
    require(len(shortenings) == count, f"shortenings must be {count}, as the elements", len(shortenings))
    t, combinations = elements[0].tension_map.shape[1], len(elements[0].tension_map)
    for k, (one, element) in enumerate({id(e): (s, e) for s, e in zip(shortenings, elements, strict=True)}.values()):
        _polynomial(f"powers of shortenings {k}", one, combinations, t)
        alike = np.array_equal(one.powers, element.polynomial.powers)
        require(alike, f"shortenings {k} must have the powers of their law", "others")


def _outlines(outlines: Sequence[Outline], elements: Sequence[ElementMap], begins: float) -> None:
    """Checks the outlines of the rubber's surface."""
    require(len(outlines) == len(elements), f"outlines must be {len(elements)}, as the elements", len(outlines))
    first, t = elements[0].polynomial, len(elements[0].tension_map)
    of = {id(one): outline for one, outline in zip(elements, outlines, strict=True)}
    shared = all(of[id(one)] is outline for one, outline in zip(elements, outlines, strict=True))
    require(shared, "outlines must be shared by elements that share a law", "others")
    for k, one in enumerate({id(one): one for one in outlines}.values()):
        own, count = one.polynomial, len(one.distances)
        require(1 <= count <= MOST_KNOTS, f"knots of outline {k} must be from 1 to {MOST_KNOTS}", count)
        _polynomial(f"powers of outline {k}", own, t, KNOT * count)
        _ends(own, t)
        _alike(
            "tensions of elements and outlines",
            [own.lower[:t], own.upper[:t]],
            [first.lower[:t], first.upper[:t]],
        )
        single = np.abs(own.coefficients).max() <= np.finfo(np.float32).max
        require(bool(single), f"coefficients of outline {k} must be finite in single precision", "others")
        ends = np.array([one.length, *one.distances, begins if one is outlines[0] else 0.0])
        ordered = bool(np.isfinite(ends).all() and (np.diff(ends) < 0).all())
        require(ordered, f"knots of outline {k} must lie one after another in its rubber", one.distances.tolist())


def _ends(polynomial: Polynomial, t: int) -> None:
    lower, upper = polynomial.lower, polynomial.upper
    require(lower.shape == upper.shape == (t + WRENCH,), f"box must have shape (2, {t + WRENCH})", lower.shape)
    ordered = bool(np.isfinite([lower, upper]).all() and (lower < upper).all())
    require(ordered, "box must have finite lower ends below its upper ends", [lower.tolist(), upper.tolist()])
    even = bool(np.allclose(lower[t:], -upper[t:], rtol=1e-9))
    require(even, "box must be as wide to both sides of no wrench", [lower[t:].tolist(), upper[t:].tolist()])


def _polynomial(name: str, polynomial: Polynomial, t: int, values: int) -> None:
    powers, coefficients = polynomial.powers, polynomial.coefficients
    require(
        powers.ndim == 2 and powers.shape[1] == t + WRENCH, f"{name} must have shape (k, {t + WRENCH})", powers.shape
    )
    require(1 <= len(powers) <= MOST_PRODUCTS, f"{name} must be from 1 to {MOST_PRODUCTS} products", len(powers))
    known = powers.min() >= 0 and powers.max() <= MOST_POWER
    require(known, f"{name} must be from 0 to {MOST_POWER}", f"{powers.min()} to {powers.max()}")
    shape = (len(powers), values)
    require(coefficients.shape == shape, f"coefficients of {name} must have shape {shape}", coefficients.shape)
    require(bool(np.isfinite(coefficients).all()), f"coefficients of {name} must be finite", "others")

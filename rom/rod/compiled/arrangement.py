"""Numbers of a segment in the order of segment.h."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from rom.dataset.sections.section_outline import SectionOutline
from rom.elements.polynomial import Polynomial
from rom.native import LIBRARY
from rom.rod.compiled.wrench_products import padded

BLOCK, POSE = LIBRARY.constants.FINGERFEM_BLOCK, LIBRARY.constants.FINGERFEM_POSE
SIX = LIBRARY.constants.FINGERFEM_BLOCK_ROW // BLOCK  # values of a law
EIGHT, KNOT = 8, 12  # numbers of an outline fill eights; numbers of one of its knots
AROUND = 4096  # points around an outline, for a mean along it
PLACES, NEAREST = 5, 4  # cross-sections of the rubber for every knot; knots that interpolate one


def at_rest(powers: np.ndarray) -> np.ndarray:
    """Products of the wrench's polynomials, of powers of shape (k, 6), without a wrench; shape (k,)."""
    return np.where((powers % 2).any(axis=1), 0.0, (-1.0) ** (powers.sum(axis=1) // 2))


def free_numbers(monomials: np.ndarray, powers: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Coefficients, shape (k, numbers), of what there is without a wrench, by the first monomials of the tensions."""
    t = monomials.shape[1]
    row = {tuple(one): k for k, one in enumerate(monomials.tolist())}
    of = np.array([row[tuple(one)] for one in powers[:, :t].tolist()], int)
    free = np.zeros((of.max(initial=-1) + 1, coefficients.shape[1]))
    np.add.at(free, of, at_rest(powers[:, t:])[:, None] * coefficients.astype(float))
    return free


def places_between(knots: np.ndarray, lengths: np.ndarray) -> dict[str, Any]:
    """Places of the rubber, and the knots' weights there, as values of a struct fingerfem_segment.

    Args:
        knots: positions along the segment at rest, shape (knots,) [m].
        lengths: of the elements from the plate to the clamp at rest, shape (elements,) [m].

    Polynomials through the nearest knots interpolate the corners.
    """
    near, count = min(len(knots), NEAREST), PLACES * (len(knots) - 1) + 1
    places = np.linspace(knots[0], knots[-1], count)
    before = np.searchsorted(knots, places, side="right") - 1
    first = np.clip(before - (near - 1) // 2, 0, len(knots) - near)
    own = knots[first[:, None] + np.arange(near)]
    weights = np.ones((count, near))
    for k in range(near):
        for j in set(range(near)) - {k}:
            weights[:, k] *= (places - own[:, j]) / (own[:, k] - own[:, j])
    begins = lengths.sum() - np.append(0.0, np.cumsum(lengths))  # of the elements, from the clamp; then the clamp
    middles = (places[1:] + places[:-1]) / 2
    own = np.searchsorted(-begins, -middles, side="right") - 1
    return {
        "knots": len(knots),
        "places": count,
        "near": near,
        "first": first,
        "between": weights,
        "place_elements": own,
        "place_shares": (middles - begins[own + 1]) / lengths[own],
        "element_lengths": lengths,
    }


def by_degree(powers: Sequence[int]) -> tuple[int, ...]:
    """Low degrees first: a group whose monomials are few has the first ones."""
    return sum(powers), *powers


def tension_monomials(t: int, powers: Sequence[np.ndarray]) -> np.ndarray:
    """Powers of the tensions, shape (monomials, t): none, those of the first powers, (k, t + 6), then all others."""
    given = dict.fromkeys([(0,) * t, *map(tuple, powers[0][:, :t].tolist())])
    more = {tuple(row) for one in powers for row in one[:, :t].tolist()} - set(given)
    return np.array([*given, *sorted(more, key=by_degree)])


def factors(powers: list[tuple[int, ...]]) -> np.ndarray:
    """Indices of products' factors among the polynomials of three components, shape (products, 3)."""
    return 4 * (3 * np.array(powers) + np.arange(3))


def law(polynomial: Polynomial, monomials: np.ndarray) -> dict[str, Any]:
    """An element's law as values of a struct fingerfem_law.

    Args:
        polynomial: 6 values, place [m] and Gibbs vector [-], of t + 6 variables.
        monomials: powers of the tensions, shape (monomials, t), that of none first, with all of its own.
    """
    t = monomials.shape[1]
    forces, moments, counts = padded(polynomial.powers[:, t:])
    rows = [(*forces[a], *moments[b]) for a, count in enumerate(counts) for b in range(count)]
    known = _by_rows(polynomial, rows, monomials)
    used = np.array([1 + max(one, default=0) for one in known])
    starts = np.cumsum([0, *counts])
    dependent = [int(np.flatnonzero(used[i:j] > 1).max(initial=-1)) + 1 for i, j in pairwise(starts)]
    of_tensions = np.concatenate([start + np.arange(count) for start, count in zip(starts, dependent, strict=False)])
    used[of_tensions] = np.maximum(used[of_tensions], 2)
    places = [*np.argsort(-used, kind="stable"), *range(len(rows), len(rows) + -len(rows) % BLOCK)]
    slope_rows = np.full(len(places), len(of_tensions))
    slope_rows[of_tensions] = np.arange(len(of_tensions))
    blocks = [_block([known[k] for k in group if k < len(rows)], used[group[0]]) for group in _fours(places)]
    free = np.zeros((used.max(), POSE))
    for value, one in zip(at_rest(np.array(rows)), known, strict=True):
        for m, values in one.items():
            free[m, :6] += value * values
    ends = np.array([polynomial.lower[t:], polynomial.upper[t:]])
    lower, upper = np.concatenate([ends, [[-1.0, -1.0], [1.0, 1.0]]], axis=1)
    return {
        "groups": len(places),
        "monomials": len(free),
        "forces": len(forces),
        "moments": len(moments),
        "most_power": int(polynomial.powers[:, t:].max()),
        "lower": lower,
        "upper": upper,
        "force_factors": factors(forces),
        "moment_factors": factors(moments),
        "moments_of": counts,
        "rows": places,
        "slope_count": 1 + len(of_tensions),
        "slope_moments_of": dependent,
        "slope_rows": slope_rows[places],
        "block_monomials": [len(block) for block in blocks],
        "coefficients": np.concatenate([block.ravel() for block in blocks]),
        "free_coefficients": free,
    }


def in_sixes(polynomial: Polynomial) -> list[Polynomial]:
    """Values by six, of which the last are filled with zeros: as a law has them."""
    values = np.pad(polynomial.coefficients, [(0, 0), (0, -polynomial.coefficients.shape[1] % SIX)])
    return [replace(polynomial, coefficients=values[:, k : k + SIX]) for k in range(0, values.shape[1], SIX)]


def outline(polynomial: Polynomial, monomials: np.ndarray) -> dict[str, Any]:
    """An element's outline as values of a struct fingerfem_outline.

    Args:
        polynomial: 12 values of every knot [m], of t + 6 variables.
        monomials: powers of the tensions, shape (monomials, t), with all of its own.
    """
    t, numbers = monomials.shape[1], polynomial.coefficients.shape[1]
    column = {tuple(one): k for k, one in enumerate(monomials.tolist())}
    products, which = np.unique(polynomial.powers[:, t:], axis=0, return_inverse=True)
    of = np.array([column[tuple(one)] for one in polynomial.powers[:, :t].tolist()])
    order = np.lexsort((of, which.ravel()))
    coefficients = np.pad(polynomial.coefficients[order], [(0, 0), (0, -numbers % EIGHT)]).astype(np.float32)
    free = free_numbers(monomials, polynomial.powers[order], coefficients)
    return {
        "knots": numbers // KNOT,
        "numbers": coefficients.shape[1],
        "terms": len(coefficients),
        "products": len(products),
        "monomials": len(free),
        "most_power": int(products.max()),
        "lower": polynomial.lower[t:],
        "upper": polynomial.upper[t:],
        "wrench_powers": products,
        "term_monomials": of[order],
        "term_products": which.ravel()[order],
        "coefficients": coefficients,
        "free_coefficients": free,
    }


def border(section: SectionOutline | None) -> dict[str, Any]:
    """A section's outline as values of a struct fingerfem_segment; none of a rectangle, which is its box."""
    if section is None or section.is_rectangle:
        return {}
    y, z = section.points(AROUND).T
    return {
        "vertices": len(section.vertices),
        "polygon": section.vertices,
        "margin": section.radius,
        "level": float((y**2 - z**2).mean()),
    }


def variants(polynomial: Polynomial, monomials: np.ndarray) -> dict[str, Any]:
    """The variants of an element's law as values of a struct fingerfem_variants.

    Args:
        polynomial: 6 values for each, place [m] and Gibbs vector [-], of t + 6 variables.
        monomials: powers of the tensions, shape (monomials, t), with all of its own.
    """
    t, count = monomials.shape[1], polynomial.coefficients.shape[1] // SIX
    column = {tuple(one): k for k, one in enumerate(monomials.tolist())}
    products, which = np.unique(polynomial.powers[:, t:], axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    rows = polynomial.coefficients[order].reshape(-1, count, SIX)
    return {
        "count": count,
        "terms": len(order),
        "products": len(products),
        "most_power": int(products.max()),
        "lower": polynomial.lower[t:],
        "upper": polynomial.upper[t:],
        "wrench_powers": products,
        "starts": np.searchsorted(which.ravel()[order], np.arange(len(products) + 1)),
        "term_monomials": [column[tuple(one)] for one in polynomial.powers[order, :t].tolist()],
        "coefficients": np.pad(rows, [(0, 0), (0, 0), (0, POSE - SIX)]).astype(np.float32),
    }


def _by_rows(polynomial: Polynomial, rows: list[tuple[int, ...]], monomials: np.ndarray) -> list[dict[int, np.ndarray]]:
    """Coefficients of every product of the wrench by the places of the tensions' monomials."""
    t = monomials.shape[1]
    row, column = ({tuple(one): k for k, one in enumerate(keys)} for keys in (rows, monomials.tolist()))
    products: list[dict[int, np.ndarray]] = [{} for _ in rows]
    for power, values in zip(polynomial.powers.tolist(), polynomial.coefficients, strict=True):
        one, m = products[row[tuple(power[t:])]], column[tuple(power[:t])]
        one[m] = one.get(m, 0.0) + values
    return products


def _fours(places: list[int]) -> list[list[int]]:
    return [places[k : k + BLOCK] for k in range(0, len(places), BLOCK)]


def _block(groups: list[dict[int, np.ndarray]], monomials: int) -> np.ndarray:
    """Coefficients of a block, shape (monomials, BLOCK, 6)."""
    block = np.zeros((monomials, BLOCK, 6))
    for g, one in enumerate(groups):
        for m, values in one.items():
            block[m, g] = values
    return block

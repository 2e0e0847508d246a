"""Numbers of a segment in the order of segment.h."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from rom.fit.chebyshev import Polynomial
from rom.segment.wrench_products import padded

BLOCK, POSE = 4, 8  # as in segment.h
BETWEEN, NEAREST = 8, 4  # cross-sections between two stations of the rubber's edges; stations that interpolate one


def at_rest(powers: np.ndarray) -> np.ndarray:
    """Products of the wrench's polynomials, of powers of shape (k, 6), without a wrench; shape (k,)."""
    return np.where((powers % 2).any(axis=1), 0.0, (-1.0) ** (powers.sum(axis=1) // 2))


def free_skin(monomials: np.ndarray, powers: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The rubber's coefficients, shape (k, numbers), without a wrench: by the first monomials of the tensions."""
    t = monomials.shape[1]
    row = {tuple(one): k for k, one in enumerate(monomials.tolist())}
    of = np.array([row[tuple(one)] for one in powers[:, :t].tolist()], int)
    found = np.zeros((of.max(initial=-1) + 1, coefficients.shape[1]))
    np.add.at(found, of, at_rest(powers[:, t:])[:, None] * coefficients.astype(float))
    return found


def between(stations: int) -> np.ndarray:
    """Weights, shape (places, stations), of even stations at places between them: polynomials through the nearest."""
    places, near = np.linspace(0, stations - 1, BETWEEN * (stations - 1) + 1), min(stations, NEAREST)
    found = np.zeros((len(places), stations))
    for row, place in zip(found, places, strict=True):
        first = int(np.clip(np.floor(place) - (near - 1) // 2, 0, stations - near))
        for k in range(first, first + near):
            others = [j for j in range(first, first + near) if j != k]
            row[k] = np.prod([(place - j) / (k - j) for j in others])
    return found


def by_degree(powers: Sequence[int]) -> tuple[int, ...]:
    """Low degrees first: a group whose monomials are few has the first ones."""
    return sum(powers), *powers


def tension_monomials(first: np.ndarray, others: Iterable[np.ndarray]) -> np.ndarray:
    """Powers of the tensions, shape (monomials, t): of none, then `first`, shape (j, t), then all `others`, (k, t)."""
    given = dict.fromkeys([(0,) * first.shape[1], *map(tuple, first.tolist())])
    more = {tuple(row) for powers in others for row in powers.tolist()} - set(given)
    return np.array([*given, *sorted(more, key=by_degree)])


def factors(powers: list[tuple[int, ...]]) -> np.ndarray:
    """Where the factors of products lie among the polynomials of three components, shape (products, 3)."""
    return 4 * (3 * np.array(powers) + np.arange(3))


def law(polynomial: Polynomial, monomials: np.ndarray) -> dict[str, Any]:
    """An element's law as values of a struct fingerfem_law.

    Args:
        polynomial: 6 values, place [m] and Gibbs vector [-], of t + 6 variables.
        monomials: powers of the tensions, shape (monomials, t), with all of its own.
    """
    t = monomials.shape[1]
    column = {tuple(row): k for k, row in enumerate(monomials.tolist())}
    forces, moments, counts = padded(polynomial.powers[:, t:])
    rows = [(a, b) for a, count in enumerate(counts) for b in range(count)]
    at = {(forces[a], moments[b]): k for k, (a, b) in enumerate(rows)}
    own: list[dict[int, np.ndarray]] = [{} for _ in rows]
    for power, values in zip(polynomial.powers.tolist(), polynomial.coefficients, strict=True):
        own[at[tuple(power[t : t + 3]), tuple(power[t + 3 :])]][column[tuple(power[:t])]] = values
    used = [1 + max(one, default=0) for one in own]
    pulled = [max((1 + b for b in range(count) if used[at[forces[a], moments[b]]] > 1), default=0) for a, count in enumerate(counts)]
    used = [max(count, 2) if b < pulled[a] else count for count, (a, b) in zip(used, rows, strict=True)]
    order = sorted(range(len(rows)), key=lambda k: -used[k])
    fill = -len(rows) % BLOCK  # groups of which nothing is taken
    places = [*order, *range(len(rows), len(rows) + fill)]
    blocks = [places[k : k + BLOCK] for k in range(0, len(places), BLOCK)]
    block_monomials = [used[block[0]] for block in blocks]
    coefficients = []
    for block, count in zip(blocks, block_monomials, strict=True):
        numbers = np.zeros((count, BLOCK, 6))
        for g, k in enumerate(block):
            for m, values in own[k].items() if k < len(rows) else ():
                numbers[m, g] = values
        coefficients.append(numbers.ravel())
    pulled_rows = {k: row for row, k in enumerate(k for k, (a, b) in enumerate(rows) if b < pulled[a])}
    rest = at_rest(np.array([[*forces[a], *moments[b]] for a, b in rows]))
    free = np.zeros((max(block_monomials), POSE))
    for value, numbers_of in zip(rest, own, strict=True):
        for m, values in numbers_of.items():
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
        "pulled": 1 + sum(pulled),
        "pulled_moments_of": pulled,
        "pulled_rows": [pulled_rows.get(k, sum(pulled)) for k in places],
        "rows": places,
        "block_monomials": block_monomials,
        "coefficients": np.concatenate(coefficients),
        "free_coefficients": free,
    }

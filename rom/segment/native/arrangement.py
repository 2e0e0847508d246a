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
    order = sorted(range(len(rows)), key=lambda k: -used[k])
    fill = -len(rows) % BLOCK  # groups of which nothing is taken
    places = [*order, *range(len(rows), len(rows) + fill)]
    blocks = [places[k : k + BLOCK] for k in range(0, len(places), BLOCK)]
    block_monomials = [used[block[0]] for block in blocks]
    coefficients = []
    for block, count in zip(blocks, block_monomials, strict=True):
        numbers = np.zeros((count, BLOCK, POSE))
        for g, k in enumerate(block):
            for m, values in own[k].items() if k < len(rows) else ():
                numbers[m, g, :6] = values
        coefficients.append(numbers.ravel())
    rest = at_rest(np.array([[*forces[a], *moments[b]] for a, b in rows]))
    free = np.zeros((max(block_monomials), POSE))
    for value, numbers_of in zip(rest, own, strict=True):
        for m, values in numbers_of.items():
            free[m, :6] += value * values
    products = [rows[k] if k < len(rows) else (0, 0) for k in places]
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
        "force_powers": np.array(forces),
        "moment_powers": np.array(moments),
        "moments_of": counts,
        "force_of": [a for a, _ in products],
        "moment_of": [b for _, b in products],
        "rows": places,
        "block_monomials": block_monomials,
        "coefficients": np.concatenate(coefficients),
        "free_coefficients": free,
    }

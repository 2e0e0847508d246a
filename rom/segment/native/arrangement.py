"""Numbers of a map in the order of segment.h."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

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


def arranged(
    powers: np.ndarray, values: np.ndarray, first: np.ndarray, also: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Powers, shape (k, t + 6), and coefficients, shape (k, 7), in the order of segment.h.

    The monomials of the tensions begin with those of powers `first`, shape (j, t); those of `also`, shape (l, t), are
    among them.

    Returns:
        monomials of the tensions, shape (monomials, t); powers of the wrench, shape (groups, 6), those with most
        monomials first, so that a parent stands before its groups; coefficients, shape (groups, monomials, 8).
    """
    t, given = first.shape[1], [tuple(row) for row in first.tolist()]
    others = {tuple(row) for row in [*powers[:, :t].tolist(), *also.tolist()]} - set(given)
    monomials = given + sorted(others, key=by_degree)
    counts = Counter(tuple(row) for row in powers[:, t:].tolist())
    groups = sorted(counts, key=lambda group: (-counts[group], sum(group), group))
    row, column = ({key: k for k, key in enumerate(keys)} for keys in (groups, monomials))
    found = np.zeros((len(groups), len(monomials), POSE))
    for power, coefficients in zip(powers.tolist(), values, strict=True):
        found[row[tuple(power[t:])], column[tuple(power[:t])], : POSE - 1] = coefficients
    fill = -len(groups) % BLOCK  # copies of the first group, of which nothing is taken
    return (
        np.array(monomials),
        np.array(groups + [groups[0]] * fill),
        np.concatenate([found, np.zeros((fill, *found.shape[1:]))]),
    )

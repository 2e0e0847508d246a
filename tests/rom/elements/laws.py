"""Laws of elements without a file: an elastic rod's linear ones, and small smooth terms of higher degree."""

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np

from rom.elements.law import ElementMap
from rom.elements.march import Marched, march
from rom.elements.polynomial import Polynomial

LENGTH, SIDE, YOUNG, OFFSET = 0.006, 0.010, 1.1e6, 0.003  # of an element [m], the section [m], rubber [Pa], tendons [m]
MOST_TENSION, MOST_FORCE, MOST_MOMENT = 12.0, 2.0, 0.03  # [N, N, N m]
AXIAL, BENDING, TORSION = YOUNG * SIDE**2, YOUNG * SIDE**4 / 12, YOUNG / 3 * 0.141 * SIDE**4
SIZES = np.repeat([LENGTH, 1.0], 3)  # of a pose's numbers [m, -]


def total_degree(p: int, degree: int) -> np.ndarray:
    """Degrees of all products of p Chebyshev polynomials whose sum is at most `degree`, shape (k, p)."""
    chosen = combinations_with_replacement(range(p + 1), degree)
    return np.array([[one.count(a) for a in range(p)] for one in chosen], int).reshape(-1, p)


def box(tensions: int) -> np.ndarray:
    """Lower and upper ends of an element's inputs, shape (2, tensions + 6) [N, N m]."""
    wrench = np.repeat([MOST_FORCE, MOST_MOMENT], 3)
    return np.array([[*np.zeros(tensions), *-wrench], [*np.full(tensions, MOST_TENSION), *wrench]])


def elastic(inputs: np.ndarray) -> np.ndarray:
    """Poses of an element that yields linearly to its wrench and to tendons around it, shape (n, 6)."""
    t = inputs.shape[1] - 6
    angles = 2 * np.pi * np.arange(t) / t
    offsets = OFFSET * np.stack([np.zeros(t), np.cos(angles), np.sin(angles)], axis=1)
    pulled, force, moment = inputs[:, :t], inputs[:, t : t + 3], inputs[:, t + 3 :].copy()
    moment -= pulled @ np.cross(offsets, [1.0, 0.0, 0.0])
    place = np.zeros((len(inputs), 3))
    place[:, 0] = -LENGTH * (1 + (force[:, 0] - pulled.sum(axis=1)) / AXIAL)
    turn = -LENGTH * moment / [TORSION, BENDING, BENDING]
    return np.hstack([place, turn / 2])


def law(tensions: int, seed: int, degree: int = 4) -> Polynomial:
    """An element's law of a total degree, its random terms smaller from degree to degree."""
    powers, (lower, upper) = total_degree(tensions + 6, degree), box(tensions)
    random = np.random.default_rng(seed)
    coefficients = 0.03 * SIZES * random.standard_normal((len(powers), 6)) * 0.3 ** powers.sum(axis=1)[:, None]
    middle = elastic((lower + upper)[None] / 2)[0]
    for power, row in zip(powers, coefficients, strict=True):
        if power.sum() == 0:
            row += middle
        elif power.sum() == 1:
            end = (lower + upper) / 2 + power * (upper - lower) / 2
            row += elastic(end[None])[0] - middle
    return Polynomial(lower=lower, upper=upper, powers=powers, coefficients=coefficients)


def as_maps(elements: Sequence[Polynomial]) -> list[ElementMap]:
    """Elements whose polynomials are of the tensions themselves; those that share a law still do."""
    found = {}
    for one in elements:
        t = len(one.lower) - 6
        found[id(one)] = ElementMap(
            tension_map=np.eye(t), tensions=np.array([one.lower[:t], one.upper[:t]]), polynomial=one
        )
    return [found[id(one)] for one in elements]


def marched(elements: Sequence[Polynomial], tensions: np.ndarray, wrenches: np.ndarray) -> Marched:
    """The march through such elements, see `rom.elements.march`."""
    return march(as_maps(elements), tensions, wrenches)


def finger(tensions: int = 2) -> list[Polynomial]:
    """A rod of a plate's piece, three elements that share a law, and a clamp's piece."""
    plate, interior, clamp = (law(tensions, seed) for seed in range(3))
    return [plate, interior, interior, interior, clamp]


def inputs(tensions: int, count: int, seed: int, share: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    """Tensions over their box, shape (count, t) [N], and wrenches over a share of theirs, shape (count, 6) [N, N m]."""
    random, (lower, upper) = np.random.default_rng(seed), box(tensions)
    pulled = random.uniform(lower[:tensions], upper[:tensions], (count, tensions))
    return pulled, share * random.uniform(lower[tensions:], upper[tensions:], (count, 6))

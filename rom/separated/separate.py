"""A function on a grid, or a fitted polynomial on the part of its box where states were, to its separated form."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from rom.brief import brief
from rom.fit.chebyshev import Polynomial
from rom.separated.alternating_directions import EnrichmentOptions, compose, separate, slopes
from rom.separated.separated_form import Separated

logger = logging.getLogger(__name__)

GRID = 3_500  # points of the grid on which it is separated, about
FEWEST_NODES, MOST_NODES = 7, 21  # nodes of an axis
NEAR = 1.5  # steps of the grid that a state is known around itself, at least in one axis


@brief
class Samples(NamedTuple):
    """A function of p variables with m values, sampled at the n nodes of a tensor grid.

    Attributes:
        axes: even nodes of every variable, shapes (n_a,).
        values: at all nodes, the last axis fastest, shape (n, m).
        gradient: by the variables, shape (n, m, p).
        known: nodes that count, shape (n,); at least one in every plane of nodes.
        sizes: what every value is large or small against, shape (m,), in its unit.
    """

    axes: Sequence[np.ndarray]
    values: np.ndarray
    gradient: np.ndarray
    known: np.ndarray
    sizes: np.ndarray


def separated(
    name: str,
    polynomial: Polynomial,
    points: np.ndarray,
    options: EnrichmentOptions,
    alike: bool = False,
    weights: np.ndarray | None = None,
) -> Separated:
    """Separate a polynomial.

    Args:
        name: of what is separated, for readers of the log.
        polynomial: of p variables, m values.
        points: where there were states, shape (n, p); only around them the form has to be like the polynomial.
        options: of the separation.
        alike: whether its m values have one unit and keep their proportions; else each counts by its own size.
        weights: how much every value counts, shape (m,) [-]; alike if left out.
    """
    p = len(polynomial.lower)
    count = int(np.clip(GRID ** (1 / max(p, 1)), FEWEST_NODES, MOST_NODES))
    if not polynomial.powers.any() or p == 0:
        return _constant(polynomial, p)
    axes = [np.linspace(low, high, count) for low, high in zip(polynomial.lower, polynomial.upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, p)
    known = _around(points, grid, polynomial, count)
    samples = Samples(
        axes, *polynomial.value_and_gradient(grid), known, _sizes(polynomial.value(grid[known]), alike, weights)
    )
    form = separated_samples(samples, options)
    if form.errors[-1] > options.tolerance:
        logger.warning("%s", _too_few(name, form.terms, float(form.errors[-1]), options))
    return form


def separated_samples(samples: Samples, options: EnrichmentOptions) -> Separated:
    """Separate a function that is sampled at the nodes of a grid.

    Its numbers are those that single precision holds: a model file need not store more, see rom.model_file.
    """
    shape = (-1, *[len(axis) for axis in samples.axes])

    def tensor(columns: np.ndarray) -> np.ndarray:
        return np.where(samples.known, (columns / samples.sizes).T, np.nan).reshape(shape)

    values = tensor(samples.values)
    factors, errors = separate(values, options)
    by_axis = (tensor(samples.gradient[..., a]) for a in range(len(samples.axes)))
    return Separated(
        lower=np.array([axis[0] for axis in samples.axes]),
        upper=np.array([axis[-1] for axis in samples.axes]),
        lost=_single(_lost(values, factors) * samples.sizes),
        factors=[_single(factor) for factor in factors[1:]],
        slopes=[_single(slopes(factors, one, a + 1)) for a, one in enumerate(by_axis)],
        modes=_single(samples.sizes[:, None] * factors[0]),
        errors=_single(errors),
    )


def _sizes(values: np.ndarray, alike: bool, weights: np.ndarray | None) -> np.ndarray:
    """What each of m values, shape (n, m), is large or small against, shape (m,)."""
    size = np.abs(values).max(axis=0) if not alike else np.full(values.shape[1], np.abs(values).max())
    size[size == 0] = 1.0
    return size if weights is None else size / weights


def _too_few(name: str, terms: int, error: float, options: EnrichmentOptions) -> str:
    then = "rom build --terms allows more" if terms >= options.terms else "more would not help"
    return (
        f"{name}: {terms} products reach a relative error of {error:.1e}, not the {options.tolerance:.1e} asked for; "
        f"the model's estimated errors count it in, {then}"
    )


def _single(values: np.ndarray) -> np.ndarray:
    """Rounded to single precision: 6e-8 of every value, where the fit and its separation err by 1e-4 and more."""
    return values.astype(np.float32).astype(float)


def _constant(polynomial: Polynomial, p: int) -> Separated:
    return Separated(
        lower=polynomial.lower,
        upper=polynomial.upper,
        factors=[np.ones((2, 1))] * p,
        slopes=[np.zeros((2, 1))] * p,
        modes=_single(polynomial.coefficients[:1].T),
        errors=np.zeros(1),
        lost=np.zeros((1, polynomial.coefficients.shape[1])),
    )


def _lost(tensor: np.ndarray, factors: list[np.ndarray]) -> np.ndarray:
    """95th percentile over the points of what each component loses with its first terms, shape (terms, m)."""
    left, found = np.nan_to_num(tensor), []
    known = np.isfinite(tensor[0])
    for k in range(factors[0].shape[1]):
        left = left - compose([factor[:, k : k + 1] for factor in factors])
        found.append(np.percentile(np.abs(left[:, known]), 95, axis=1))
    return np.array(found)


def _around(points: np.ndarray, grid: np.ndarray, polynomial: Polynomial, count: int) -> np.ndarray:
    """Which points of the grid have a state near, shape (grid points,); at least one in every plane of nodes."""
    step = (polynomial.upper - polynomial.lower) / (count - 1)
    spacing = max(NEAR, 0.75 * (count - 1) / max(len(points), 1) ** (1 / len(step)) + 1)
    away, _ = cKDTree(points / step).query(grid / step, p=np.inf)
    known = away <= spacing
    for a in range(len(step)):
        planes = np.round((grid[:, a] - polynomial.lower[a]) / step[a]).astype(int)
        for plane in range(count):
            own = np.flatnonzero(planes == plane)
            if not known[own].any():
                known[own[away[own] <= away[own].min() + 1e-9]] = True
    return known

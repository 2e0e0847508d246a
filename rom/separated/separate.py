"""A function on a grid to its separated form."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.separated.alternating_directions import EnrichmentOptions, compose, separate, slopes
from rom.separated.separated_form import Separated


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

    def columns(self, chosen: Sequence[int]) -> Samples:
        """Some of the values."""
        index = list(chosen)
        return self._replace(values=self.values[:, index], gradient=self.gradient[:, index], sizes=self.sizes[index])


def separated_samples(samples: Samples, options: EnrichmentOptions) -> Separated:
    """Separate a function that is sampled at the nodes of a grid.

    Its numbers are those that single precision holds: a model file need not store more, see rom.separated.model_file.
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


def further_modes(factors: Sequence[np.ndarray], values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Modes of further values with the same one-dimensional functions, by least squares, shape (m, terms).

    Args:
        factors: nodal values of the functions, shapes (n_a, terms).
        values: at all nodes of the grid, the last axis fastest, shape (n, m).
        known: nodes that count, shape (n,).
    """
    products = np.ones((1, factors[0].shape[1]))
    for factor in factors:
        products = (products[:, None] * factor).reshape(-1, factor.shape[1])
    return np.linalg.lstsq(products[known], values[known], rcond=None)[0].T


def _single(values: np.ndarray) -> np.ndarray:
    """Rounded to single precision: 6e-8 of every value, where the separation's error is 1e-4 and more."""
    return values.astype(np.float32).astype(float)


def _lost(tensor: np.ndarray, factors: list[np.ndarray]) -> np.ndarray:
    """95th percentile over the points of what each component loses with its first terms, shape (terms, m)."""
    left, found = np.nan_to_num(tensor), []
    known = np.isfinite(tensor[0])
    for k in range(factors[0].shape[1]):
        left = left - compose([factor[:, k : k + 1] for factor in factors])
        found.append(np.percentile(np.abs(left[:, known]), 95, axis=1))
    return np.array(found)

"""The separated form u(x; mu) = sum_i F_i(x) G_i1(mu_1) ... G_in(mu_n): value and gradient, compiled.

Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from rom import basis1d


class Packed(NamedTuple):
    """The arrays the compiled code reads; axes padded to the longest."""

    counts: np.ndarray  # (axes,) nodes of each axis
    nodes: np.ndarray  # (axes, most nodes)
    pieces: np.ndarray  # (axes, most intervals, 4, terms)
    modes: np.ndarray  # (terms, m)


@dataclass(frozen=True, kw_only=True)
class Separated:
    """A sum of products of nodal functions.

    Attributes:
        nodes: of every axis, shapes (n_a,).
        kinds: of every axis, see basis1d.
        factors: nodal values of the one-dimensional functions, shapes (n_a, terms).
        modes: F_i, shape (m, terms), in the quantity's unit.
        errors: relative 2-norm error over the snapshots of the first 1, 2, ... terms, shape (terms,) [-].
    """

    nodes: Sequence[np.ndarray]
    kinds: Sequence[str]
    factors: Sequence[np.ndarray]
    modes: np.ndarray
    errors: np.ndarray

    @property
    def terms(self) -> int:
        """Number of products."""
        return int(self.modes.shape[1])

    @property
    def finite(self) -> bool:
        """Whether every number is one."""
        return all(np.isfinite(values).all() for values in (self.modes, *self.nodes, *self.factors))

    @cached_property
    def packed(self) -> Packed:
        """The form as plain arrays for compiled code."""
        axes, longest = len(self.nodes), max((len(nodes) for nodes in self.nodes), default=2)
        nodes = np.zeros((axes, longest))
        pieces = np.zeros((axes, longest - 1, 4, self.terms))
        for a, (x, factors, kind) in enumerate(zip(self.nodes, self.factors, self.kinds, strict=True)):
            nodes[a, : len(x)] = x
            pieces[a, : len(x) - 1] = basis1d.coefficients(x, factors, kind)
        counts = np.array([len(x) for x in self.nodes], dtype=np.int64)
        return Packed(counts, nodes, pieces, np.ascontiguousarray(self.modes.T))

    def truncated(self, tolerance: float) -> Separated:
        """The fewest leading terms whose snapshot error is below `tolerance` [-]; all of them if none is."""
        good = np.flatnonzero(self.errors <= tolerance)
        terms = int(good[0]) + 1 if good.size else self.terms
        return Separated(
            nodes=self.nodes,
            kinds=self.kinds,
            factors=[factor[:, :terms] for factor in self.factors],
            modes=self.modes[:, :terms],
            errors=self.errors[:terms],
        )

    def value(self, x: ArrayLike) -> np.ndarray:
        """Value at a point, shape (m,)."""
        return evaluate(self.packed, np.asarray(x, float))[0]

    def value_and_gradient(self, x: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Value, shape (m,), and gradient by the axes, shape (m, axes)."""
        return evaluate(self.packed, np.asarray(x, float))


@njit(cache=True)
def evaluate(form: Packed, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value, shape (m,), and gradient, shape (m, axes), of a form at x, shape (axes,).

    Outside an axis the end pieces go on: whoever calls decides what lies inside.
    """
    axes, terms = form.pieces.shape[0], form.pieces.shape[3]
    m = form.modes.shape[1]
    g = np.empty((axes, terms))
    dg = np.empty((axes, terms))
    for a in range(axes):
        last = form.counts[a] - 2
        i = min(max(np.searchsorted(form.nodes[a, : last + 2], x[a], side="right") - 1, 0), last)
        t = x[a] - form.nodes[a, i]
        c = form.pieces[a, i]
        for k in range(terms):
            g[a, k] = c[0, k] + t * (c[1, k] + t * (c[2, k] + t * c[3, k]))
            dg[a, k] = c[1, k] + t * (2 * c[2, k] + t * 3 * c[3, k])
    value = np.zeros(m)
    gradient = np.zeros((m, axes))
    weights = np.empty(axes)
    for k in range(terms):
        whole = 1.0
        for a in range(axes):
            whole *= g[a, k]
            weights[a] = dg[a, k]
            for b in range(axes):
                if b != a:
                    weights[a] *= g[b, k]
        for j in range(m):
            value[j] += whole * form.modes[k, j]
            for a in range(axes):
                gradient[j, a] += weights[a] * form.modes[k, j]
    return value, gradient

"""The separated form u(x; mu) = sum_i F_i(x) G_i1(mu_1) ... G_in(mu_n), as data.

Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 2. rom.native.forms evaluates it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from rom.brief import brief
from rom.native import EVALUATION, PickledByFields
from rom.native.forms import AXES, COMPONENTS, MODES, ROW, TERMS, values, values_and_gradients


@brief
@dataclass(frozen=True, kw_only=True)
class Separated(PickledByFields):
    """A sum of products of nodal functions on evenly spaced nodes.

    Attributes:
        lower, upper: ends of every axis, shapes (axes,).
        factors: nodal values of the one-dimensional functions, shapes (n_a, terms).
        slopes: their nodal derivatives by the axis, the same shapes.
        modes: F_i, shape (m, terms), in the quantity's unit.
        errors: relative 2-norm error over what was separated of the first 1, 2, ... terms, shape (terms,) [-].
        lost: what every component loses with the first 1, 2, ... terms, 95th percentile over the points it was
            separated on, shape (terms, m).
    """

    lower: np.ndarray
    upper: np.ndarray
    factors: Sequence[np.ndarray]
    slopes: Sequence[np.ndarray]
    modes: np.ndarray
    errors: np.ndarray
    lost: np.ndarray

    @property
    def terms(self) -> int:
        """Number of products."""
        return int(self.modes.shape[1])

    @property
    def finite(self) -> bool:
        """Whether every number is one."""
        numbers = (self.modes, self.lower, self.upper, self.errors, self.lost, *self.factors, *self.slopes)
        return all(np.isfinite(values).all() for values in numbers)

    @property
    def nodes(self) -> list[np.ndarray]:
        """Nodes of every axis, shapes (n_a,)."""
        ends = zip(self.lower, self.upper, self.factors, strict=True)
        return [np.linspace(low, high, len(factor)) for low, high, factor in ends]

    @cached_property
    def pieces(self) -> list[np.ndarray]:
        """Piecewise cubics of every axis, shapes (n_a - 1, 4, terms)."""
        functions = zip(self.nodes, self.factors, self.slopes, strict=True)
        return [cubic_pieces(nodes, factor, slope) for nodes, factor, slope in functions]

    @cached_property
    def tables(self) -> Any:
        """The form alone for compiled code, a struct fingerfem_tables."""
        return EVALUATION.struct("fingerfem_tables", **tables([self]))

    def truncated(self, tolerance: float) -> tuple[Separated, np.ndarray]:
        """The fewest leading terms whose separation error is below `tolerance` [-], all of them if none is.

        And what more every component loses than with all, at the 95th percentile of the points, shape (m,).
        """
        good = np.flatnonzero(self.errors <= tolerance)
        terms = int(good[0]) + 1 if good.size else self.terms
        fewer = replace(
            self,
            factors=[factor[:, :terms] for factor in self.factors],
            slopes=[slope[:, :terms] for slope in self.slopes],
            modes=self.modes[:, :terms],
            errors=self.errors[:terms],
            lost=self.lost[:terms],
        )
        return fewer, np.maximum(self.lost[terms - 1] - self.lost[-1], 0.0)

    def value(self, x: ArrayLike) -> np.ndarray:
        """Value at a point, shape (m,)."""
        return values(self.tables, 0, np.atleast_2d(np.asarray(x, float)))[0]

    def value_and_gradient(self, x: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Value at a point, shape (m,), and gradient by the axes, shape (m, axes)."""
        value, gradient = values_and_gradients(self.tables, 0, np.atleast_2d(np.asarray(x, float)))
        return value[0], gradient[0]


def tables(forms: Sequence[Separated]) -> dict[str, Any]:
    """What a struct fingerfem_tables of these forms holds or points to, by the names of kernel.h."""
    axes = max(len(form.factors) for form in forms)
    parts: list[np.ndarray] = []
    heads, spans = np.zeros((len(forms), ROW), np.int64), np.zeros((len(forms), axes, 2), np.int64)
    scales = np.ones((len(forms), axes, 2))
    offset = 0
    for f, form in enumerate(forms):
        for a, pieces in enumerate(form.pieces):
            spans[f, a] = len(pieces), offset
            scales[f, a] = form.lower[a], len(pieces) / (form.upper[a] - form.lower[a])
            parts.append(pieces.ravel())
            offset += pieces.size
        heads[f, [AXES, TERMS, COMPONENTS, MODES]] = len(form.factors), form.terms, len(form.modes), offset
        parts.append(np.ascontiguousarray(form.modes).ravel())
        offset += form.modes.size
    return {
        "most_axes": axes,
        "most_terms": int(heads[:, TERMS].max()),
        "most_components": int(heads[:, COMPONENTS].max()),
        "forms": heads,
        "axes": spans,
        "scales": scales,
        "data": np.concatenate(parts),
    }


def cubic_pieces(nodes: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Coefficients c of r piecewise cubic functions, shape (n - 1, 4, r).

    On interval i, with t = (x - nodes[i]) / (nodes[i + 1] - nodes[i]) in [0, 1], one is c0 + c1 t + c2 t^2 + c3 t^3.

    Args:
        nodes: ascending positions, shape (n,).
        values: nodal values, shape (n, r).
        slopes: nodal derivatives, shape (n, r).

    Raises:
        ValueError: nodes, values or slopes are not what they must be.
    """
    nodes, values, slopes = (np.asarray(one, float) for one in (nodes, values, slopes))
    if nodes.ndim != 1 or len(nodes) < 2 or not np.all(np.diff(nodes) > 0):
        raise ValueError(f"nodes must ascend and be at least 2, got {nodes.tolist()}")
    if values.ndim != 2 or len(values) != len(nodes) or not np.isfinite(values).all():
        raise ValueError(f"values must be finite and of shape ({len(nodes)}, r), got {values.shape}")
    if slopes.shape != values.shape or not np.isfinite(slopes).all():
        raise ValueError(f"slopes must be finite and of shape {values.shape}, got {slopes.shape}")
    powers = CubicHermiteSpline(nodes, values, slopes, axis=0).c[::-1]
    scales = np.diff(nodes) ** np.arange(4)[:, None]
    return np.ascontiguousarray((powers * scales[..., None]).transpose(1, 0, 2))

"""The separated form u(x; mu) = sum_i F_i(x) G_i1(mu_1) ... G_in(mu_n), as data.

Chenevier et al., PLoS ONE 13(2): e0192052 (2018), eq. 2. rom.native.forms evaluates it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rom.brief import brief
from rom.native import LIBRARY, PickledByFields
from rom.native.forms import AXES, COMPONENTS, MODES, ROW, TERMS
from rom.separated.alternating_directions import EnrichmentOptions, khatri_rao, separate, slopes

FEWEST = 4  # nodes with samples
RELIED = 1e-2  # share of the largest below which singular values of products do not count for the field [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Separated(PickledByFields):
    """A sum of products of cubic Hermite functions on evenly spaced nodes.

    Attributes:
        ends: lower and upper of every axis, shape (2, axes).
        functions: nodal values of the one-dimensional functions, and their derivatives, shapes (2, n_a, terms).
        modes: F_i, shape (m, terms), in the quantity's unit.
        field: F_i of k further quantities by the same products, shape (k, terms).
        errors: relative 2-norm error over what was separated of the first 1, 2, ... terms, shape (terms,) [-].
    """

    ends: np.ndarray
    functions: Sequence[np.ndarray]
    modes: np.ndarray
    field: np.ndarray
    errors: np.ndarray

    @classmethod
    def of(
        cls, axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray, options: EnrichmentOptions
    ) -> Separated:
        """Separate a function that is sampled on a grid, in numbers that single precision holds.

        Args:
            axes: nodes of every axis, shapes (n_a,); some nodes of an even axis.
            values: shape (n_1, ..., m + k), nan where missing; the last k get the products of the others.
            gradient: of the first m by the axes, shape (n_1, ..., m, axes), nan where missing.
            options: of the separation.

        Raises:
            ValueError: too few samples.
        """
        values, field = np.split(values, [gradient.shape[-2]], axis=-1)
        known = np.isfinite(values[..., 0])
        if known.sum() < FEWEST:
            raise ValueError(f"a grid must have samples at {FEWEST} nodes at least, got {known.sum()}")
        sizes = np.abs(values[known]).max(axis=0)
        sizes[sizes == 0] = 1.0  # a finger that bends in a plane has no third displacement
        (modes, *factors), errors = separate(np.moveaxis(values / sizes, -1, 0), options)
        functions = []
        for a, axis in enumerate(axes):
            derivative = np.moveaxis(gradient[..., a] / sizes, -1, 0)
            function = CubicHermiteSpline(axis, factors[a], slopes([modes, *factors], derivative, a + 1))
            even = np.linspace(axis[0], axis[-1], round(np.ptp(axis) / np.diff(axis).min()) + 1)
            functions.append(_single(np.array([function(even), function(even, 1)])))
        weights = np.linalg.norm(modes, axis=0)  # a small term has steep functions, and stays small
        products = (khatri_rao(factors) * weights)[known.ravel()]
        return cls(
            ends=np.array([[axis[0], axis[-1]] for axis in axes]).T,
            functions=functions,
            modes=_single(sizes[:, None] * modes),
            field=_single(weights * np.linalg.lstsq(products, field[known], rcond=RELIED)[0].T),
            errors=_single(errors),
        )

    @property
    def terms(self) -> int:
        """Number of products."""
        return int(self.modes.shape[1])

    @cached_property
    def tables(self) -> Any:
        """The form alone for compiled code, a struct fingerfem_tables."""
        return LIBRARY.struct("fingerfem_tables", **tables([self]))

    def truncated(self, tolerance: float) -> tuple[Separated, np.ndarray]:
        """The fewest leading terms whose separation error is below `tolerance` [-], or all terms.

        The second result is what every component loses, the 95th percentile over the nodes, shape (m,).
        """
        good = np.flatnonzero(self.errors <= tolerance)
        k = int(good[0]) + 1 if good.size else self.terms
        lost = khatri_rao([function[0, :, k:] for function in self.functions]) @ self.modes[:, k:].T
        functions = [function[..., :k] for function in self.functions]
        arrays = {"modes": self.modes[:, :k], "field": self.field[:, :k], "errors": self.errors[:k]}
        return replace(self, functions=functions, **arrays), np.percentile(np.abs(lost), 95, axis=0)


def tables(forms: Sequence[Separated]) -> dict[str, Any]:
    """The fields of a struct fingerfem_tables of these forms, by the names of kernel.h."""
    axes = max(len(form.functions) for form in forms)
    heads, spans = np.zeros((len(forms), ROW), np.int64), np.zeros((len(forms), axes, 2), np.int64)
    scales, parts, offset = np.ones((len(forms), axes, 2)), [], 0
    for f, form in enumerate(forms):
        for a, ((low, high), function) in enumerate(zip(form.ends.T, form.functions, strict=True)):
            intervals = function.shape[1] - 1
            spans[f, a], scales[f, a] = (intervals, offset), (low, intervals / (high - low))
            values, slopes = function
            pieces = CubicHermiteSpline(np.arange(intervals + 1), values, slopes * (high - low) / intervals).c
            parts.append(pieces[::-1].swapaxes(0, 1).ravel())
            offset += parts[-1].size
        heads[f, [AXES, TERMS, COMPONENTS, MODES]] = len(form.functions), form.terms, len(form.modes), offset
        parts.append(form.modes.ravel())
        offset += form.modes.size
    most = dict(zip(("most_axes", "most_terms", "most_components"), heads.max(axis=0).tolist(), strict=False))
    return most | {"forms": heads, "axes": spans, "scales": scales, "data": np.concatenate(parts)}


def _single(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32).astype(float)

"""A separated form on nodes of any spacing: what a grid of full-order states is separated into first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from rom.brief import brief
from rom.separated.alternating_directions import EnrichmentOptions, separate, slopes
from rom.separated.separate import further_modes


@brief
@dataclass(frozen=True)
class NodalForm:
    """A separated form sum_k mode_jk prod_a function_ak(x_a) of cubic Hermite functions, on nodes of any spacing."""

    modes: np.ndarray
    functions: Sequence[CubicHermiteSpline]

    @staticmethod
    def of(
        axes: Sequence[np.ndarray], values: np.ndarray, gradient: np.ndarray, options: EnrichmentOptions, leading: int
    ) -> NodalForm:
        """Separate values, shape (n_1, ..., n_k, m), nan where missing, and their gradient, shape (..., m, k).

        The leading values determine the functions, the others have modes of these by least squares.
        """
        own, m = values[..., :leading], values.shape[-1]
        size = np.nanmax(np.abs(own).reshape(-1, leading), axis=0)
        size[size == 0] = 1.0
        factors, _ = separate(np.moveaxis(own / size, -1, 0), options)
        tensors = (np.moveaxis(gradient[..., :leading, a] / size, -1, 0) for a in range(len(axes)))
        by_axis = [slopes(factors, one, a + 1) for a, one in enumerate(tensors)]
        parts = zip(axes, factors[1:], by_axis, strict=True)
        known = np.isfinite(values[..., 0]).ravel()
        others = values[..., leading:].reshape(known.size, m - leading)
        modes = np.vstack([size[:, None] * factors[0], further_modes(factors[1:], others, known)])
        return NodalForm(modes, [CubicHermiteSpline(*part, axis=0) for part in parts])

    def value_and_gradient(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """At points, shape (n, k): values, shape (n, m), and derivatives, shape (n, m, k)."""
        values = [function(x[:, a]) for a, function in enumerate(self.functions)]
        gradient = []
        for a, function in enumerate(self.functions):
            others = [function(x[:, a], 1) if b == a else one for b, one in enumerate(values)]
            gradient.append(np.prod(others, axis=0) @ self.modes.T)
        return np.prod(values, axis=0) @ self.modes.T, np.stack(gradient, axis=-1)

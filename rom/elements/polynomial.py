"""Polynomials of several variables: sums of products of Chebyshev polynomials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from rom.brief import brief


@brief
@dataclass(frozen=True, kw_only=True)
class Polynomial:
    """Sum of coefficients times products of Chebyshev polynomials of the scaled variables; linear beyond its box.

    Attributes:
        lower, upper: of the box that is scaled to [-1, 1], shapes (p,).
        powers: degrees of every product, shape (k, p).
        coefficients: shape (k, m).
    """

    lower: np.ndarray
    upper: np.ndarray
    powers: np.ndarray
    coefficients: np.ndarray

    def value(self, points: np.ndarray) -> np.ndarray:
        """Values, shape (n, m), at points, shape (n, p)."""
        if ((points < self.lower) | (points > self.upper)).any():
            return self.value_and_gradient(points)[0]
        return products(self._scaled(points), self.powers) @ self.coefficients

    def value_and_gradient(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values, shape (n, m), and derivatives, shape (n, m, p); beyond the box those of its nearest point."""
        inside = np.clip(points, self.lower, self.upper)
        scaled, half = self._scaled(inside), (self.upper - self.lower) / 2
        slopes = [products(scaled, self.powers, a) @ self.coefficients / half[a] for a in range(len(half))]
        gradient = np.stack(slopes, axis=-1)
        values = products(scaled, self.powers) @ self.coefficients
        return values + np.einsum("nmp,np->nm", gradient, points - inside), gradient

    def on(self, lower: np.ndarray, upper: np.ndarray) -> Polynomial:
        """The same polynomial by the variables scaled to another box, shapes (p,)."""
        powers, coefficients, wide = self.powers, self.coefficients, self.upper - self.lower
        ratios, shifts = (upper - lower) / wide, (lower + upper - self.lower - self.upper) / wide
        for a in np.flatnonzero((ratios != 1) | (shifts != 0)):
            table = _substituted(int(powers[:, a].max()), ratios[a], shifts[a])
            rows, own = np.nonzero(table[powers[:, a]])
            every, shares = powers[rows], table[powers[rows, a], own]
            every[:, a] = own
            powers, which = np.unique(every, axis=0, return_inverse=True)
            parts, coefficients = shares[:, None] * coefficients[rows], np.zeros((len(powers), coefficients.shape[1]))
            np.add.at(coefficients, which.ravel(), parts)
        return replace(self, lower=lower, upper=upper, powers=powers, coefficients=coefficients)

    @staticmethod
    def linear(lower: np.ndarray, upper: np.ndarray, slopes: np.ndarray) -> Polynomial:
        """Slopes @ point, on a box; shapes (p,), (p,), (m, p)."""
        powers = np.vstack([np.zeros(len(lower), int), np.eye(len(lower), dtype=int)])
        coefficients = np.vstack([slopes @ (lower + upper) / 2, (slopes * (upper - lower) / 2).T])
        return Polynomial(lower=lower, upper=upper, powers=powers, coefficients=coefficients)

    @staticmethod
    def together(polynomials: Sequence[Polynomial]) -> Polynomial:
        """Polynomials on one box as one of all their values."""
        powers = max((one.powers for one in polynomials), key=len)
        columns = [one._by(powers) for one in polynomials]
        return replace(polynomials[0], powers=powers, coefficients=np.hstack(columns))

    def plus(self, other: Polynomial) -> Polynomial:
        """The sum with a polynomial on the same box."""
        powers = np.unique(np.concatenate([self.powers, other.powers]), axis=0)
        return replace(self, powers=powers, coefficients=self._by(powers) + other._by(powers))

    def _by(self, powers: np.ndarray) -> np.ndarray:
        """Coefficients by powers that include the polynomial's own."""
        places = {tuple(row): k for k, row in enumerate(powers.tolist())}
        coefficients = np.zeros((len(powers), self.coefficients.shape[1]))
        coefficients[[places[tuple(row)] for row in self.powers.tolist()]] = self.coefficients
        return coefficients

    def _scaled(self, points: np.ndarray) -> np.ndarray:
        return 2 * (points - self.lower) / (self.upper - self.lower) - 1


def products(scaled: np.ndarray, powers: np.ndarray, by: int | None = None) -> np.ndarray:
    """Products at points, shape (n, k); their derivatives by the scaled variable `by`, if one is named."""
    degree = int(powers.max(initial=0))
    values = np.ones((len(scaled), len(powers)))
    for a in range(scaled.shape[1]):
        table = chebyshev.chebvander(scaled[:, a], degree)
        if a == by:
            table = table @ _derivative(degree)
        values *= table[:, powers[:, a]]
    return values


def _substituted(degree: int, ratio: float, shift: float) -> np.ndarray:
    """Chebyshev coefficients of T_0(y) ... T_degree(y), y = ratio z + shift, by z, as rows."""
    points = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    values = chebyshev.chebvander(ratio * points + shift, degree)
    return np.tril(np.linalg.solve(chebyshev.chebvander(points, degree), values).T)


@lru_cache
def _derivative(degree: int) -> np.ndarray:
    """Chebyshev coefficients of the derivatives of T_0 ... T_degree, as columns."""
    columns = np.zeros((degree + 1, degree + 1))
    for k in range(1, degree + 1):
        columns[:degree, k] = chebyshev.chebder(np.eye(degree + 1)[k])
    return columns

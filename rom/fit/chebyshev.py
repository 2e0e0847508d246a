"""Polynomials of several variables fitted to scattered states and their derivatives, the degree chosen by themselves.

In Chebyshev polynomials of total degree q, by least squares (gradient-enhanced regression: Peng, Hampton, Doostan,
J. Comput. Phys. 310, 2016, doi:10.1016/j.jcp.2015.12.049). A response that is smooth needs few states: where n nodes an
axis are n^p states on a grid, total degree q needs some (p + q)! / (p! q!) / (1 + p). States may be missing anywhere.

The degree is the one that best predicts states left out, each by all others. With all rows of the least-squares
problem Q R, leaving out a state's rows g changes their residuals from e_g to (I - Q_g Q_g^T)^-1 e_g: no further fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations_with_replacement

import numpy as np
from numpy.polynomial import chebyshev
from scipy.linalg import qr, solve_triangular

from rom.brief import brief

SLOPES = 0.1  # weight of a derivative by an axis scaled to [-1, 1], beside a value
ROWS = 1.5  # rows a fit has at least for every coefficient
NOISE, DECAY = 1e-7, 0.4  # coefficients are expected to be smaller than DECAY^degree / NOISE
CALM = 1e-6  # noise of a fit that will be corrected, by states that may lie a little beyond its own
HIGHEST_DEGREE = 16  # total degree
FEW = 3  # states below which they correct nothing
SLIGHT = 1e-6  # share of a function below which a correction of it is rounding
NOTHING = 1e-9  # share of the largest function below which another, as it is here in SI units, is rounding
PATIENCE = 3  # degrees without a better prediction after which none is expected


@brief
@dataclass(frozen=True, kw_only=True)
class Samples:
    """What is known of m functions of p variables.

    Attributes:
        points: shape (n, p).
        values: shape (n, m).
        slopes: derivatives, shape (n, m, p); None if not known.
        weights: of the states, shape (n,).
        lower, upper: of the box, shapes (p,).
        noise: NOISE or CALM: the larger, the less a fit swings where there are no states.
    """

    points: np.ndarray
    values: np.ndarray
    slopes: np.ndarray | None
    weights: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    noise: float = NOISE


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

    @staticmethod
    def together(polynomials: Sequence[Polynomial]) -> Polynomial:
        """Polynomials on one box as one of all their values."""
        powers = max((one.powers for one in polynomials), key=len)
        columns = [one._by(powers) for one in polynomials]
        return replace(polynomials[0], powers=powers, coefficients=np.hstack(columns))

    def mixed(self, weights: np.ndarray) -> Polynomial:
        """Sums of its values, by weights of shape (m, sums)."""
        return replace(self, coefficients=self.coefficients @ weights)

    def plus(self, other: Polynomial) -> Polynomial:
        """The sum with a polynomial on the same box."""
        powers = max(self.powers, other.powers, key=len)
        return replace(self, powers=powers, coefficients=self._by(powers) + other._by(powers))

    def _by(self, powers: np.ndarray) -> np.ndarray:
        """Its coefficients by powers among which its own are."""
        places = {tuple(row): k for k, row in enumerate(powers.tolist())}
        found = np.zeros((len(powers), self.coefficients.shape[1]))
        found[[places[tuple(row)] for row in self.powers.tolist()]] = self.coefficients
        return found

    def _scaled(self, points: np.ndarray) -> np.ndarray:
        return 2 * (points - self.lower) / (self.upper - self.lower) - 1


@brief
@dataclass(frozen=True, kw_only=True)
class Fitted:
    """A polynomial, and how well it predicts what it was not fitted to.

    Attributes:
        polynomial: the fit to all samples.
        degree: its total degree.
        residuals: of the values, each state predicted by all others, shape (n, m).
    """

    polynomial: Polynomial
    degree: int
    residuals: np.ndarray

    def of(self, columns: np.ndarray) -> Fitted:
        """The fit of some of the functions: `columns`, shape (columns,), are positions or a mask."""
        return Fitted(
            polynomial=replace(self.polynomial, coefficients=self.polynomial.coefficients[:, columns]),
            degree=self.degree,
            residuals=self.residuals[:, columns],
        )


def fit(
    samples: Samples, before: Polynomial | None = None, *, alike: bool = False, rows: float | None = None
) -> Fitted:
    """The polynomial of the total degree, up to HIGHEST_DEGREE, that predicts best what is left out.

    Args:
        samples: of m functions.
        before: what is known of them from elsewhere, in or near whose box the samples lie; what they say beyond it is
            then fitted.
        alike: whether all have one unit and count alike; else each counts by its own size. All have the same degree.
        rows: values and slopes of states that a fit has at least for every coefficient; ROWS if left out.
    """
    if before is None:
        return _of_best_degree(samples, alike, 0.0, rows or ROWS)
    known, known_slopes = before.value_and_gradient(samples.points)
    values = samples.values - known
    if len(values) < FEW:
        return Fitted(polynomial=before, degree=0, residuals=values)
    slopes = None if samples.slopes is None else samples.slopes - known_slopes
    own = replace(samples, values=values, slopes=slopes, lower=before.lower, upper=before.upper)
    size = np.abs(samples.values).max(axis=0)
    least = np.maximum(SLIGHT * size, NOTHING * size.max())
    found = _of_best_degree(own, alike, least, rows or ROWS)
    return replace(found, polynomial=before.plus(found.polynomial))


def _of_best_degree(samples: Samples, alike: bool, least: np.ndarray | float, rows: float) -> Fitted:
    size = np.abs(samples.values).max(axis=0)
    size = np.maximum(size, np.maximum(least, NOTHING * size.max()))
    if alike:
        size[:] = size.max()
    size[size == 0] = 1.0
    found = _fit(samples, 0)
    smallest, since = _score(samples, found, size), 0
    for degree in range(1, HIGHEST_DEGREE + 1):
        powers = total_degree(samples.points.shape[1], degree)
        known = len(samples.points) * (1 if samples.slopes is None else 1 + samples.points.shape[1])
        if known < rows * len(powers) or since == PATIENCE:
            break
        candidate = _fit(samples, degree)
        score, since = _score(samples, candidate, size), since + 1
        if score < smallest:
            found, smallest, since = candidate, score, 0
    return found


def _score(samples: Samples, found: Fitted, size: np.ndarray) -> float:
    spread = np.abs(samples.weights[:, None] * found.residuals / size)
    return float(np.linalg.norm(np.quantile(spread, 0.75, axis=0)))


def _fit(samples: Samples, degree: int) -> Fitted:
    p, powers = samples.points.shape[1], total_degree(samples.points.shape[1], degree)
    blank = Polynomial(lower=samples.lower, upper=samples.upper, powers=powers, coefficients=np.zeros((0, 0)))
    scaled, half = blank._scaled(samples.points), (samples.upper - samples.lower) / 2
    rows, right = [products(scaled, powers)], [samples.values]
    if samples.slopes is not None:
        for a in range(p):
            rows.append(SLOPES * products(scaled, powers, a))
            right.append(SLOPES * half[a] * samples.slopes[..., a])
    weights = np.tile(samples.weights, len(rows))[:, None]
    matrix, wanted = weights * np.concatenate(rows), weights * np.concatenate(right)
    prior = np.sqrt(len(wanted)) * samples.noise * DECAY ** -powers.sum(axis=1)
    Q, R = qr(np.concatenate([matrix, np.diag(prior)]), mode="economic")
    Q = Q[: len(wanted)]
    along = Q.T @ wanted
    return Fitted(
        polynomial=Polynomial(
            lower=samples.lower, upper=samples.upper, powers=powers, coefficients=solve_triangular(R, along)
        ),
        degree=degree,
        residuals=_left_out(samples, Q, wanted - Q @ along),
    )


def _left_out(samples: Samples, Q: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Residuals of the values, each state predicted by all others, shape (n, m)."""
    n, blocks = len(samples.points), len(Q) // len(samples.points)
    rows = Q.reshape(blocks, n, -1).transpose(1, 0, 2)
    leverages = np.eye(blocks) - rows @ rows.transpose(0, 2, 1)
    # A state that alone says something is reproduced whatever it is: nothing is known of what others would predict.
    left_out = np.linalg.pinv(leverages, rcond=1e-12, hermitian=True) @ errors.reshape(blocks, n, -1).transpose(1, 0, 2)
    return np.asarray(left_out[:, 0] / samples.weights[:, None])


@lru_cache
def total_degree(p: int, degree: int) -> np.ndarray:
    """Degrees of all products of p Chebyshev polynomials whose sum is at most `degree`, shape (k, p)."""
    found = []
    for chosen in combinations_with_replacement(range(p + 1), degree):
        found.append([chosen.count(a) for a in range(p)])
    return np.array(found, int).reshape(-1, p)


def products(scaled: np.ndarray, powers: np.ndarray, by: int | None = None) -> np.ndarray:
    """Products at points, shape (n, k); their derivatives by the scaled variable `by`, if one is named."""
    degree = int(powers.max(initial=0))
    found = np.ones((len(scaled), len(powers)))
    for a in range(scaled.shape[1]):
        table = chebyshev.chebvander(scaled[:, a], degree)
        if a == by:
            table = table @ _derivative(degree)
        found *= table[:, powers[:, a]]
    return found


@lru_cache
def _derivative(degree: int) -> np.ndarray:
    """Chebyshev coefficients of the derivatives of T_0 ... T_degree, as columns."""
    found = np.zeros((degree + 1, degree + 1))
    for k in range(1, degree + 1):
        found[:degree, k] = chebyshev.chebder(np.eye(degree + 1)[k])
    return found

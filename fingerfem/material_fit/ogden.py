"""Least squares for Ogden's law: powers by a search from several starts, their moduli by linear least squares."""

from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import least_squares, nnls

from fingerfem.material_fit.points import Points
from fingerfem.material_fit.stresses import EXPONENTS, pulled

POWERS = (-8.0, -4.0, -2.0, -1.0, 1.0, 2.0, 3.0, 5.0, 8.0, 11.0)  # among which starts are chosen [-]
STARTS = 4  # of as many negative powers
SMALLEST, LARGEST = 0.05, 12.0  # size of a power; larger ones fit noise, and grow soon beyond the data [-]
ABSENT = 1e-9  # of the shear modulus: a term below that is left out [-]
SETTLED = 1e-15  # relative, of the sum of squares, of the powers and of the gradient [-]


def fit_ogden(points: Points, terms: int) -> dict[str, Any]:
    """The constants mu [Pa] and alpha [-] of the least weighted squares, of `terms` terms or fewer.

    No product mu_p alpha_p is below 0. Incompressible rubber of such a law is stable at all stretches, and its terms do
    not cancel one another.
    """

    def cost(alpha: tuple[float, ...]) -> float:
        return float(np.sum(_error(np.array(alpha), points) ** 2))

    def refined(start: tuple[float, ...]) -> Any:
        limits = np.sort(np.outer([SMALLEST, LARGEST], np.sign(start)), axis=0)
        return least_squares(_error, start, args=(points,), bounds=limits, xtol=SETTLED, ftol=SETTLED, gtol=SETTLED)

    starts: dict[int, list[tuple[float, ...]]] = {}  # by how many powers are negative
    for one in sorted(combinations(POWERS, terms), key=cost):
        starts.setdefault(sum(power < 0 for power in one), []).append(one)
    alpha = min(
        (refined(start) for alike in starts.values() for start in alike[:STARTS]), key=lambda found: found.cost
    ).x
    products = _products(alpha, points)[0]
    kept = products > ABSENT * products.sum()
    return {"mu": (products[kept] / alpha[kept]).tolist(), "alpha": alpha[kept].tolist()}


def _products(alpha: np.ndarray, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """The best mu_p alpha_p of these powers, shape (terms,) [Pa], and the scaled errors, shape (points,) [-]."""

    def stress(mode: str, stretch: np.ndarray) -> np.ndarray:
        """Stress at mu_p alpha_p = 1 Pa: 1 / (n alpha_p) times the sum of k l^(alpha_p k - 1), k = EXPONENTS."""
        k = np.array(EXPONENTS[mode])
        powers = stretch[:, None, None] ** (alpha[:, None] * k - 1)
        return (powers @ k) / alpha / pulled(mode)

    A, b = points.by_mode(stress) * points.scale[:, None], points.stress * points.scale
    products, _ = nnls(A, b)
    return products, A @ products - b


def _error(alpha: np.ndarray, points: Points) -> np.ndarray:
    return _products(alpha, points)[1]

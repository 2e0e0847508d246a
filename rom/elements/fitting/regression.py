"""Least squares for values and derivatives of smooth functions, and what lines that are left out are predicted as.

Gradient-enhanced regression (Peng, Hampton, Doostan, J. Comput. Phys. 310, 2016, doi:10.1016/j.jcp.2015.12.049) in
products of Chebyshev polynomials of the scaled inputs. The normal equations are kept line by line: A fit without a line
is one subtraction and one factorisation, and a fit of fewer products is a part of the same matrices.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from rom.elements.polynomial import Polynomial, products
from rom.elements.samples.symmetry import Mirror

DERIVATIVES = 0.3  # weight of a derivative by an input scaled to [-1, 1], beside a value [-]
RIDGE = 1e-13  # of the normal equations' largest entry: round-off of a double's sums [-]
ROWS = 4000  # rows of values and derivatives that are worked on at once: bounds the memory


class NormalEquations:
    """Normal equations of m functions of p inputs, in folds of lines.

    Args:
        lower: of the inputs, shape (p,).
        upper: likewise.
        powers: of the products, shape (k, p).
        folds: number of folds.
        values: number of functions m.

    Attributes:
        rows: values and derivatives of every fold, shape (folds,).
        prior: what is added to the normal equations' diagonal, shape (k,): it draws coefficients towards 0.
    """

    def __init__(self, lower: np.ndarray, upper: np.ndarray, powers: np.ndarray, folds: int, values: int):
        self.lower, self.upper, self.powers, self.folds = lower, upper, powers, folds
        self.rows, self.prior = np.zeros(folds), np.zeros(len(powers))
        self._gram = np.zeros((folds, len(powers), len(powers)))
        self._right = np.zeros((folds, len(powers), values))

    def add(self, inputs: np.ndarray, values: np.ndarray, jacobians: np.ndarray, fold: np.ndarray) -> None:
        """Add samples.

        Args:
            inputs: shape (n, p).
            values: shape (n, m).
            jacobians: by the first inputs, shape (n, m, q), q at most p: those by the others are not known.
            fold: of every sample, shape (n,).
        """
        half = (self.upper - self.lower) / 2
        for k in range(self.folds):
            own = np.flatnonzero(fold == k)
            axes = range(jacobians.shape[2])
            for part in np.array_split(own, len(own) * (1 + len(axes)) // ROWS + 1):
                scaled = (inputs[part] - self.lower) / half - 1
                slopes = [DERIVATIVES * products(scaled, self.powers, a) for a in axes]
                wanted = [DERIVATIVES * half[a] * jacobians[part, :, a] for a in axes]
                rows = np.concatenate([products(scaled, self.powers), *slopes])
                self.rows[k] += len(rows)
                self._gram[k] += rows.T @ rows
                self._right[k] += rows.T @ np.concatenate([values[part], *wanted])

    def add_images(self, mirrors: Sequence[Mirror]) -> None:
        """Add the images of all samples by mirrors of the inputs, under which the box and the products are the same.

        A mirror makes of the input x_i the input s_i x_j, so of a product with powers a the product with the same
        powers of the permuted inputs, times prod_i s_i^a_i. The normal equations of the images are therefore those of
        the samples with rows and columns permuted and changed in sign. Mirrors that differ in signs alone are summed
        first.
        """
        images = [(*self._permutation(mirror.inputs), mirror.values) for mirror in mirrors]
        signs: dict[tuple[int, ...], list[np.ndarray]] = {}
        for place, sign, _ in images:
            signs.setdefault(tuple(place), []).append(sign)
        for k in range(self.folds):
            gram, right = self._gram[k].copy(), self._right[k].copy()
            for permuted, alike in signs.items():
                self._gram[k] += np.transpose(alike) @ np.array(alike) * gram[np.ix_(permuted, permuted)]
            for place, sign, values in images:
                self._right[k] += sign[:, None] * right[place] @ values.T
        self.rows *= 1 + len(images)

    def _permutation(self, mirror: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Images of all products: their indices, and their signs, shapes (k,)."""
        position = {tuple(row): k for k, row in enumerate(self.powers.tolist())}
        place = [position[tuple(row)] for row in (self.powers @ np.abs(mirror).astype(int)).tolist()]
        return np.array(place), np.prod(mirror.sum(axis=1) ** self.powers, axis=1)

    def fit(self, chosen: np.ndarray, left_out: Collection[int] = ()) -> Polynomial:
        """The polynomial of some of the products.

        Args:
            chosen: positions of the products, shape (j,).
            left_out: folds.
        """
        gram, right = self._sums(left_out)
        normal = gram[np.ix_(chosen, chosen)]
        normal[np.diag_indices_from(normal)] += RIDGE * normal.max() + self.prior[chosen]
        factor = cho_factor(normal)
        coefficients = np.ascontiguousarray(cho_solve(factor, right[chosen]))  # as a file holds them: the same sums
        return Polynomial(lower=self.lower, upper=self.upper, powers=self.powers[chosen], coefficients=coefficients)

    def deviations(self, chosen: np.ndarray, groups: Sequence[Collection[int]], values: int) -> Polynomial:
        """Deviations of fits without a group of folds from that of all: their squares add up to its variance.

        That is the jackknife's, (V - 1) / V times the sum of squares of V groups (R. G. Miller, Biometrika 61, 1974).

        Args:
            chosen: positions of the products, shape (j,).
            groups: V of them, that make up all folds.
            values: number of functions m, the first ones.

        Returns:
            of V m values: those of the first group first.
        """
        whole, share = self.fit(chosen), np.sqrt((len(groups) - 1) / len(groups))
        fits = [self.fit(chosen, group).coefficients for group in groups]
        return replace(whole, coefficients=np.hstack([share * (one - whole.coefficients)[:, :values] for one in fits]))

    def _sums(self, left_out: Collection[int]) -> tuple[np.ndarray, np.ndarray]:
        gram, right = self._total
        for k in left_out:
            gram, right = gram - self._gram[k], right - self._right[k]
        return gram, right

    @property
    def _total(self) -> tuple[np.ndarray, np.ndarray]:
        return self._gram.sum(axis=0), self._right.sum(axis=0)


def index_set(weights: np.ndarray, degree: float) -> np.ndarray:
    """Degrees a of all products with sum_i weights_i a_i <= degree, shape (k, inputs)."""
    rows, left = [[]], [degree + 1e-9]  # type: list[list[int]], list[float]
    for weight in weights:
        grown = [
            ([*row, power], rest - power * weight)
            for row, rest in zip(rows, left, strict=True)
            for power in range(int(rest / weight) + 1)
        ]
        rows, left = [row for row, _ in grown], [rest for _, rest in grown]
    return np.array(sorted(map(tuple, rows)), int).reshape(-1, len(weights))


def chosen(powers: np.ndarray, weights: np.ndarray, degree: float) -> np.ndarray:
    """Positions of the products of a weighted total degree among powers, shape (k, inputs); shape (j,)."""
    return np.flatnonzero(powers @ weights <= degree + 1e-9)

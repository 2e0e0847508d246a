"""Correction of every element's law for the error of its training mesh, by a few states on a finer mesh.

A mesh is too stiff by a share that hardly depends on the loads. So the difference of two meshes is modelled as a share
of the law's change from rest, plus a polynomial of low degree. Few states determine both, because each state gives
samples of every element. A ridge term shrinks the polynomial, but not the share. If it shrank both, the correction
would be too small at the ends of the ranges.
"""

from collections.abc import Collection, Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from rom.elements.fitting.candidates import Candidates, rows_of
from rom.elements.fitting.regression import DERIVATIVES, NormalEquations, chosen
from rom.elements.law import ElementLaw
from rom.elements.polynomial import Polynomial
from rom.elements.samples.element_samples import Samples
from rom.elements.samples.symmetry import Mirror

DEGREE = 3.0  # weighted degree of a correction's polynomial [-]
RIDGES = 1e-4, 1e-3, 1e-2  # of the number of rows, on the diagonal of the normal equations: lines left out choose [-]


class Differences(NormalEquations):
    """Normal equations of the m differences of a finer mesh from a law: a share of each value, and a polynomial.

    Args:
        law: that they are from, of p inputs.
        powers: of the products of the polynomial, shape (k, p), among the law's.
        folds: number of folds.
    """

    def __init__(self, law: ElementLaw, powers: np.ndarray, folds: int):
        own, values = law.polynomial, law.polynomial.coefficients.shape[1]
        super().__init__(own.lower, own.upper, powers, folds, 2 * values)
        unloaded = np.zeros(len(own.lower))
        if law.has_lengths:
            unloaded[-1] = law.lengths[1]
        coefficients = own.coefficients.copy()
        coefficients[np.flatnonzero(~own.powers.any(axis=1))] -= own.value(unloaded[None])
        self._law = replace(own, coefficients=coefficients)
        self._squares = np.zeros((folds, 2, values))  # of the law's values with the differences, and with themselves

    def add(self, inputs: np.ndarray, values: np.ndarray, jacobians: np.ndarray, fold: np.ndarray) -> None:
        """Add differences at samples, see NormalEquations."""
        own, gradient = self._law.value_and_gradient(inputs)
        by = jacobians.shape[2]
        weights = DERIVATIVES * (self.upper - self.lower)[:by] / 2
        own_rows = np.concatenate([own[..., None], weights * gradient[..., :by]], axis=2)
        rows = np.concatenate([values[..., None], weights * jacobians], axis=2)
        for k, one in enumerate((rows, own_rows)):
            np.add.at(self._squares[:, k], fold, np.sum(own_rows * one, axis=2))
        super().add(inputs, np.hstack([values, own]), np.hstack([jacobians, gradient[..., :by]]), fold)

    def add_images(self, mirrors: Sequence[Mirror]) -> None:
        """Add the images of all samples, see NormalEquations."""
        super().add_images([replace(one, values=block_diag(one.values, one.values)) for one in mirrors])
        self._squares += sum(self._squares @ np.abs(one.values).T for one in mirrors)

    def shares(self, left_out: Collection[int] = ()) -> np.ndarray:
        """Differences over the law's values, by least squares, without some folds, shape (m,) [-]."""
        kept = np.setdiff1d(np.arange(self.folds), list(left_out))
        products, squares = self._squares[kept].sum(axis=0)
        return np.divide(products, squares, out=np.zeros_like(products), where=squares > 0)

    def fit(self, chosen: np.ndarray, left_out: Collection[int] = ()) -> Polynomial:
        """The difference as a polynomial of the law's products, see NormalEquations."""
        polynomial, shares = super().fit(chosen, left_out), self.shares(left_out)
        differences, own = np.hsplit(polynomial.coefficients, 2)
        rest = replace(polynomial, coefficients=differences - shares * own)
        return replace(self._law, coefficients=shares * self._law.coefficients).plus(rest)


def correcting(own: Candidates, degree: float, samples: Sequence[Samples], fold_of: dict[int, int]) -> Candidates:
    """The law of an element that is its own one and a correction.

    Args:
        own: laws of the coarser mesh.
        degree: that was chosen among these.
        samples: on the finer mesh, of one length each.
        fold_of: of every line of these.
    """
    law = own.with_variants(degree)
    powers = law.polynomial.powers[chosen(law.polynomial.powers, own.weights, DEGREE)]
    equations = Differences(law, powers, max(fold_of.values()) + 1)
    for one in samples:
        left = _without(law, one)
        inputs, differences, jacobians = rows_of(left, law.tension_map, law.has_lengths)
        equations.add(inputs, differences, jacobians, np.array([fold_of[line] for line in one.lines.tolist()]))
    equations.add_images(own.images)
    return replace(own, equations=equations, highest=DEGREE, corrected=law)


def with_ridge(correction: Candidates, ridge: float) -> Candidates:
    """The same correction with another ridge, one of RIDGES [-]."""
    equations = copy(correction.equations)
    equations.prior = np.full(len(equations.powers), ridge * equations.rows.sum())
    return replace(correction, equations=equations)


def _without(law: ElementLaw, samples: Samples) -> Samples:
    """Samples less a law's values: the residual."""
    values, gradient = law.of_length(samples.length).value_and_gradient(samples.inputs)
    return replace(samples, values=samples.values - values, jacobians=samples.jacobians - gradient)

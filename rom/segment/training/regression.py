"""Least squares for values and derivatives, and what lines of states would be predicted as by all others.

In Chebyshev polynomials of the scaled inputs, by the normal equations (L L^T, with a step of iterative refinement).
Leaving out a line's rows A_g changes their residuals from e_g to (1 - A_g (L L^T)^-1 A_g^T)^-1 e_g: no further fit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from rom.brief import brief
from rom.fit.chebyshev import Polynomial, products
from rom.snapshots.pressed_states import PressedStates

DERIVATIVES = 0.3  # weight of a derivative by an input scaled to [-1, 1], beside a value [-]
RIDGE = 1e-12  # of the normal equations' largest entry: no wrench of one force has a moment along it, so that some
# products are known by nothing [-]


@brief
@dataclass(frozen=True, kw_only=True)
class Samples:
    """What is known of m functions of p inputs.

    Attributes:
        inputs: shape (n, p).
        values: shape (n, m).
        jacobians: shape (n, m, p).
        lines: of states that are left out together, shape (n,).
    """

    inputs: np.ndarray
    values: np.ndarray
    jacobians: np.ndarray
    lines: np.ndarray

    @classmethod
    def of(cls, states: PressedStates, values: np.ndarray, jacobians: np.ndarray) -> Samples:
        """Of what pressed states say, shapes (n, ...) and (n, ..., p)."""
        n, p = states.inputs.shape
        flat = {"values": values.reshape(n, -1), "jacobians": jacobians.reshape(n, -1, p)}
        return cls(inputs=states.inputs, lines=states.lines, **flat)


def regression(samples: Samples, box: np.ndarray, powers: np.ndarray) -> tuple[Polynomial, np.ndarray]:
    """The polynomial of products of these powers, shape (k, p), and the values predicted without each one's line.

    Args:
        samples: of n states.
        box: lowest and highest of every input, shape (p, 2).
        powers: of the products.

    Returns:
        the polynomial; and shape (n, m).
    """
    lower, half = box[:, 0], (box[:, 1] - box[:, 0]) / 2
    scaled = (samples.inputs - lower) / half - 1
    lines = [np.flatnonzero(samples.lines == line) for line in np.unique(samples.lines)]

    def rows(of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values, then derivatives by every input, of states: rows of the matrix, and right-hand sides."""
        matrix, wanted = [products(scaled[of], powers)], [samples.values[of]]
        for a in range(len(half)):
            matrix.append(DERIVATIVES * products(scaled[of], powers, a))
            wanted.append(DERIVATIVES * half[a] * samples.jacobians[of, :, a])
        return np.concatenate(matrix), np.concatenate(wanted)

    matrix, wanted = (np.concatenate(part) for part in zip(*map(rows, lines), strict=True))
    normal = matrix.T @ matrix
    normal[np.diag_indices_from(normal)] += RIDGE * normal.max()
    factor = cholesky(normal, lower=True)
    coefficients = cho_solve((factor, True), matrix.T @ wanted)
    coefficients += cho_solve((factor, True), matrix.T @ (wanted - matrix @ coefficients))
    coefficients = np.ascontiguousarray(coefficients)  # as a file holds them: the same sums
    predicted, errors, at = samples.values.copy(), wanted - matrix @ coefficients, 0
    for line in lines:
        size = len(line) * (1 + len(half))
        along = solve_triangular(factor, matrix[at : at + size].T, lower=True)
        left_out = np.linalg.solve(np.eye(size) - along.T @ along, errors[at : at + size])
        predicted[line] -= left_out[: len(line)]
        at += size
    return Polynomial(lower=lower, upper=box[:, 1], powers=powers, coefficients=coefficients), predicted


def correction(before: Polynomial, samples: Samples, powers: np.ndarray) -> tuple[Polynomial, np.ndarray]:
    """A polynomial that is known, and what samples say beyond it; the values predicted without each one's line.

    Args:
        before: what is known.
        samples: of n states.
        powers: of the products that are added, some of those that are known.
    """
    values, slopes = before.value_and_gradient(samples.inputs)
    beyond = replace(samples, values=samples.values - values, jacobians=samples.jacobians - slopes)
    found, predicted = regression(beyond, np.column_stack([before.lower, before.upper]), powers)
    return before.plus(found), values + predicted

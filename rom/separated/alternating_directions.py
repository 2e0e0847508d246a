"""Greedy enrichment with alternating directions: a function on a tensor grid -> a sum of products.

Each new term is the best product for what the terms before left over, found by solving for one direction at a time
(Chenevier et al. 2018, section "Model order reduction"; Ammar et al., J. Non-Newtonian Fluid Mech. 139, 2006). After
each enrichment all terms are improved together by a few damped sweeps (alternating least squares). A point without a
value begins at its nearest neighbour's, and then follows the sum of products.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt

Factors = list[np.ndarray]  # of a sum of products, shapes (n_0, terms), (n_1, terms), ...
GROWN = 10.0  # largest size of a term over that of the tensor: where no best approximation exists, terms grow without
# bound (de Silva, Lim, SIAM J. Matrix Anal. Appl. 30, 2008, doi:10.1137/06066518X)
ALTERNATIONS = 30  # most rounds over the directions for one new term
ROUNDS = 20  # in which missing derivatives follow the others; two make the damping vanish
TINY = np.finfo(float).tiny


@dataclass(frozen=True, kw_only=True)
class EnrichmentOptions:
    """Stopping criteria of the enrichment.

    Attributes:
        tolerance: bounds the 2-norm of what is left over that of the snapshots [-].
        terms: most products.
        sweeps: rounds that improve all terms after an enrichment.
    """

    tolerance: float = 1e-5
    terms: int = 200
    sweeps: int = 4


def separate(tensor: np.ndarray, options: EnrichmentOptions) -> tuple[Factors, np.ndarray]:
    """Approximate a tensor by a sum of products.

    Args:
        tensor: shape (n_0, n_1, ..., n_k). A point (n_1, ..., n_k) of the grid counts as missing if any of its n_0
            values is not finite.
        options: when to stop.

    Returns:
        factors, shapes (n_a, terms), unit columns but for the first direction's, which carry size and unit; terms in
        descending size; and the relative 2-norm error of the first 1, 2, ... terms, shape (terms,) [-].
    """
    known = np.isfinite(tensor).all(axis=0)
    size = float(np.linalg.norm(tensor[:, known]))
    if size == 0:
        return [np.zeros((n, 1)) for n in tensor.shape], np.zeros(1)
    nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
    tensor = left = tensor[(slice(None), *nearest)]
    factors = [np.zeros((n, 0)) for n in tensor.shape]
    while factors[0].shape[1] < options.terms and np.linalg.norm(left[:, known]) > options.tolerance * size:
        factors = [np.hstack(pair) for pair in zip(factors, _best_product(left), strict=True)]
        for _ in range(options.sweeps):
            swept = _swept(tensor, known, factors)
            if np.linalg.norm(swept[0], axis=0).max() > GROWN * size:
                break
            factors = swept
        left = tensor - compose(factors)
    order = np.argsort(-np.linalg.norm(factors[0], axis=0), kind="stable")
    factors, errors = [factor[:, order] for factor in factors], []
    for k in range(len(order)):
        tensor = tensor - compose([factor[:, k : k + 1] for factor in factors])
        errors.append(np.linalg.norm(tensor[:, known]) / size)
    return factors, np.array(errors)


def slopes(factors: Factors, derivative: np.ndarray, axis: int) -> np.ndarray:
    """Nodal derivatives of the one-dimensional functions of an axis, shape (n_a, terms), by least squares.

    Args:
        factors: of a separated tensor.
        derivative: of that tensor by the axis, of the same shape, nan where it is missing.
        axis: from 1.
    """
    known, changes = np.isfinite(derivative), list(factors)
    derivative, changes[axis] = np.where(known, derivative, 0.0), np.zeros_like(factors[axis])
    for _ in range(2 if known.all() else ROUNDS):
        changes[axis] = _solved(derivative, changes, axis)
        derivative = np.where(known, derivative, compose(changes))
    return changes[axis]


def compose(factors: Factors) -> np.ndarray:
    """The tensor that factors, shapes (n_a, terms), stand for, shape (n_0, ..., n_k)."""
    return (factors[0] @ khatri_rao(factors[1:]).T).reshape([len(factor) for factor in factors])


def khatri_rao(factors: Factors) -> np.ndarray:
    """Column-wise Kronecker product, shape (product of n_a, terms)."""
    product = factors[0]
    for factor in factors[1:]:
        product = (product[:, None, :] * factor[None, :, :]).reshape(len(product) * len(factor), factor.shape[1])
    return product


def _best_product(tensor: np.ndarray) -> Factors:
    """The rank-one tensor nearest to a tensor: unit columns, and the size in the first."""
    peak = np.unravel_index(np.argmax(np.abs(tensor)), tensor.shape)
    # Start from the fibres through the largest entry.
    term = [np.moveaxis(tensor, a, -1)[tuple(np.delete(peak, a))] for a in range(tensor.ndim)]
    term = [vector / max(np.linalg.norm(vector), TINY) for vector in term]
    size = 0.0
    for _ in range(ALTERNATIONS):
        before = size
        for a in range(tensor.ndim):
            vector = tensor
            for b in reversed(range(tensor.ndim)):
                vector = vector if a == b else np.tensordot(vector, term[b], axes=(b, 0))
            size = float(np.linalg.norm(vector))
            term[a] = vector / max(size, TINY)
        if abs(size - before) <= 1e-3 * size:
            break
    return [vector[:, None] for vector in (term[0] * size, *term[1:])]


def _swept(tensor: np.ndarray, known: np.ndarray, factors: Factors) -> Factors:
    """One round of alternating least squares over all terms; missing points of the tensor then follow them."""
    factors = list(factors)
    for a in range(tensor.ndim - 1, -1, -1):
        factors[a] = _solved(tensor, factors, a)
        if a > 0:
            length = np.linalg.norm(factors[a], axis=0)
            length[length == 0] = 1.0
            factors[a], factors[0] = factors[a] / length, factors[0] * length
    at = zip(factors[1:], np.nonzero(~known), strict=True)
    tensor[:, ~known] = factors[0] @ np.prod([factor[index] for factor, index in at], axis=0).T
    return factors


def _solved(tensor: np.ndarray, factors: Factors, a: int) -> np.ndarray:
    """A factor by least squares, damped towards the present one: a minimum-norm damping would bias every value."""
    others, terms = factors[:a] + factors[a + 1 :], factors[a].shape[1]
    gram = np.prod([factor.T @ factor for factor in others], axis=0)
    right = np.moveaxis(tensor, a, 0).reshape(tensor.shape[a], -1) @ khatri_rao(others)
    damping = max(1e-10 * np.trace(gram) / terms, TINY)
    return np.asarray(np.linalg.solve(gram + damping * np.eye(terms), (right + damping * factors[a]).T).T)

"""Greedy enrichment with alternating directions: a function on a tensor grid -> separated form.

Each new term is the best product for what the terms before left over, found by solving for one direction at a time
(Chenevier et al. 2018, section "Model order reduction"; Ammar et al., J. Non-Newtonian Fluid Mech. 139, 2006). After
each enrichment all terms are improved together by a few damped sweeps (alternating least squares). Grid points without
a value are left out of every least-squares problem.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

logger = logging.getLogger(__name__)

OPPOSED = 0.999  # cosine of two terms beyond which, large and opposed, they only cancel each other
MERGERS = 5  # after so many of them, more terms do not help
GROWN = 10.0  # size of such terms over that of the tensor


@dataclass(frozen=True, kw_only=True)
class EnrichmentOptions:
    """When to stop.

    Attributes:
        tolerance: bounds the 2-norm of what is left over that of the snapshots [-].
        terms: most products.
        alternations: most rounds over the directions for one new term.
        sweeps: rounds that improve all terms after an enrichment.
    """

    tolerance: float = 3e-4
    terms: int = 100
    alternations: int = 30
    sweeps: int = 4


def separate(tensor: np.ndarray, options: EnrichmentOptions) -> tuple[list[np.ndarray], np.ndarray]:
    """Approximate a tensor by a sum of products.

    Args:
        tensor: shape (n_0, n_1, ..., n_k). A point (n_1, ..., n_k) of the grid may be missing: nan for all n_0.
        options: when to stop.

    Returns:
        factors, shapes (n_a, terms), unit columns but for the first direction's, which carry size and unit; terms in
        descending size; and the relative 2-norm error of the first 1, 2, ... terms, shape (terms,) [-].

    Raises:
        ValueError: values are infinite, or missing for some of n_0 only, or everywhere.
    """
    known = np.isfinite(tensor[0])
    if not np.array_equal(np.isfinite(tensor), np.broadcast_to(known, tensor.shape)) or np.isinf(tensor).any():
        raise ValueError("tensor must be finite, or nan at whole points of its grid")
    if not known.any():
        raise ValueError("tensor must have values, got none")
    tensor = np.where(known, tensor, 0.0)
    size = float(np.linalg.norm(tensor))
    if size == 0:
        return [np.zeros((n, 1)) for n in tensor.shape], np.zeros(1)
    factors = [np.zeros((n, 0)) for n in tensor.shape]
    left, merged = tensor, 0
    while factors[0].shape[1] < options.terms:
        term = _best_product(left, options.alternations)
        factors = [np.column_stack([factor, column]) for factor, column in zip(factors, term, strict=True)]
        for _ in range(options.sweeps):
            factors = _sweep(tensor, known, factors)
        opposed = _without_opposed(factors, size)
        if opposed is not None:
            factors, merged = _sweep(tensor, known, opposed), merged + 1
            logger.debug("two products that only cancelled each other were merged into one")
            if merged > MERGERS:
                break
        left = (tensor - compose(factors)) * known
        if np.linalg.norm(left) <= options.tolerance * size:
            break
    order = np.argsort(-np.linalg.norm(factors[0], axis=0), kind="stable")
    factors = [factor[:, order] for factor in factors]
    return factors, _prefix_errors(tensor, known, factors)


def slopes(factors: list[np.ndarray], derivative: np.ndarray, axis: int) -> np.ndarray:
    """Nodal derivatives of the one-dimensional functions of an axis, shape (n_a, terms), by one least-squares problem.

    Args:
        factors: of a separated tensor.
        derivative: of that tensor by the axis, of the same shape, nan where it is not known.
        axis: from 1.
    """
    known = np.isfinite(derivative[0])
    others = _khatri_rao(factors[:axis] + factors[axis + 1 :])
    unfolded = np.moveaxis(np.where(known, derivative, 0.0), axis, 0).reshape(derivative.shape[axis], -1)
    grams, right = _grams(known, factors, axis), unfolded @ others
    return _solve(grams, right, _solve(grams, right, np.zeros_like(factors[axis])))


def _without_opposed(factors: list[np.ndarray], size: float) -> list[np.ndarray] | None:
    """The factors with the two terms merged that grow against each other; None if there are no such terms.

    Where no best approximation exists, sums of products approach the tensor with terms that grow without bound (de
    Silva, Lim, SIAM J. Matrix Anal. Appl. 30, 2008, doi:10.1137/06066518X).
    """
    gram = np.ones((factors[0].shape[1],) * 2)
    for factor in factors:
        gram *= factor.T @ factor
    sizes = np.sqrt(np.diag(gram))
    cosines = gram / np.maximum(np.outer(sizes, sizes), np.finfo(float).tiny)
    i, j = np.unravel_index(np.argmin(cosines), cosines.shape)
    if cosines[i, j] > -OPPOSED or min(sizes[i], sizes[j]) < GROWN * size:
        return None
    pair = _best_product(compose([factor[:, [i, j]] for factor in factors]), 30)
    rest = [np.delete(factor, [i, j], axis=1) for factor in factors]
    return [np.column_stack([factor, column]) for factor, column in zip(rest, pair, strict=True)]


def compose(factors: list[np.ndarray]) -> np.ndarray:
    """The tensor that factors, shapes (n_a, terms), stand for, shape (n_0, ..., n_k)."""
    others = _khatri_rao(factors[1:])
    return (factors[0] @ others.T).reshape([len(factor) for factor in factors])


def _khatri_rao(factors: list[np.ndarray]) -> np.ndarray:
    """Column-wise Kronecker product, shape (product of n_a, terms)."""
    product = factors[0]
    for factor in factors[1:]:
        product = (product[:, None, :] * factor[None, :, :]).reshape(-1, factor.shape[1])
    return product


def _best_product(tensor: np.ndarray, alternations: int) -> list[np.ndarray]:
    """The rank-one tensor nearest to a tensor, one unit vector a direction and the size in the first."""
    peak = np.unravel_index(np.argmax(np.abs(tensor)), tensor.shape)
    # Start from the fibres through the largest entry.
    term = [np.moveaxis(tensor, a, -1)[tuple(np.delete(peak, a))] for a in range(tensor.ndim)]
    term = [vector / np.linalg.norm(vector) for vector in term]
    size = 0.0
    for _ in range(alternations):
        before = size
        for a in range(tensor.ndim):
            vector = _contract(tensor, term, a)
            size = float(np.linalg.norm(vector))
            if size == 0:
                return [np.zeros(n) for n in tensor.shape]
            term[a] = vector / size
        if abs(size - before) <= 1e-3 * size:
            break
    return [term[0] * size, *term[1:]]


def _contract(tensor: np.ndarray, vectors: list[np.ndarray], kept: int) -> np.ndarray:
    for a in reversed(range(tensor.ndim)):
        if a != kept:
            tensor = np.tensordot(tensor, vectors[a], axes=(a, 0))
    return tensor


def _sweep(tensor: np.ndarray, known: np.ndarray, factors: list[np.ndarray]) -> list[np.ndarray]:
    """One round of alternating least squares over all terms, damped so that no two can grow against each other."""
    factors = list(factors)
    for a in range(tensor.ndim - 1, -1, -1):
        others = _khatri_rao(factors[:a] + factors[a + 1 :])
        right = np.moveaxis(tensor, a, 0).reshape(tensor.shape[a], -1) @ others
        updated = _solve(_grams(known, factors, a), right, factors[a])
        if a > 0:
            length = np.linalg.norm(updated, axis=0)
            length[length == 0] = 1.0
            updated, factors[0] = updated / length, factors[0] * length
        factors[a] = updated
    return factors


def _solve(grams: np.ndarray, right: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Rows of a factor from their normal equations; those of one matrix for all rows, or of one each."""
    terms = present.shape[1]
    damping = 1e-10 * np.trace(grams, axis1=-2, axis2=-1)[..., None, None] / terms
    # Damped towards the present factor: a plain minimum-norm damping would bias every value.
    matrices = grams + np.maximum(damping, np.finfo(float).tiny) * np.eye(terms)
    if len(grams) == 1:
        return np.asarray(np.linalg.solve(matrices[0], (right + damping[0] * present).T).T)
    return np.asarray(np.linalg.solve(matrices, (right + damping[..., 0] * present)[..., None])[..., 0])


def _grams(known: np.ndarray, factors: list[np.ndarray], a: int) -> np.ndarray:
    """Matrices of the normal equations of a factor, shape (1, terms, terms) or one for every row."""
    if known.all():
        gram = np.ones((factors[0].shape[1],) * 2)
        for b, factor in enumerate(factors):
            if b != a:
                gram *= factor.T @ factor
        return gram[None]
    if a == 0:
        rows = _khatri_rao(factors[1:])[known.ravel()]
        return (rows.T @ rows)[None]
    grid = factors[1:]
    across = [factor for b, factor in enumerate(grid) if b != a - 1]
    products = _khatri_rao(across) if across else np.ones((1, factors[0].shape[1]))
    masks = np.moveaxis(known, a - 1, 0).reshape(known.shape[a - 1], -1)
    components = factors[0].T @ factors[0]
    return np.array([components * (products[mask].T @ products[mask]) for mask in masks])


def _prefix_errors(tensor: np.ndarray, known: np.ndarray, factors: list[np.ndarray]) -> np.ndarray:
    left, errors, size = tensor.copy(), [], np.linalg.norm(tensor)
    for k in range(factors[0].shape[1]):
        left -= compose([factor[:, k : k + 1] for factor in factors]) * known
        errors.append(np.linalg.norm(left) / size)
    return np.array(errors)

"""Greedy enrichment with alternating directions: snapshots on a tensor grid -> separated form.

Each new term is the best product for what the terms before left over, found by solving for one direction at a time
(Chenevier et al. 2018, section "Model order reduction"; Ammar et al., J. Non-Newtonian Fluid Mech. 139, 2006). After
each enrichment all terms are improved together by a few damped sweeps (alternating least squares).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class EnrichmentOptions:
    """When to stop.

    Attributes:
        tolerance: bounds the 2-norm of what is left over that of the snapshots [-].
        terms: most products.
        alternations: most rounds over the directions for one new term.
        sweeps: rounds that improve all terms after an enrichment.
    """

    tolerance: float = 1e-4
    terms: int = 80
    alternations: int = 30
    sweeps: int = 4


def separate(tensor: np.ndarray, options: EnrichmentOptions) -> tuple[list[np.ndarray], np.ndarray]:
    """Approximate a tensor by a sum of products.

    Args:
        tensor: shape (n_0, n_1, ..., n_k), finite.
        options: when to stop.

    Returns:
        factors, shapes (n_a, terms), unit columns but for the first direction's, which carry size and unit; terms in
        descending size; and the relative 2-norm error of the first 1, 2, ... terms, shape (terms,) [-].

    Raises:
        ValueError: the tensor is not finite.
    """
    if not np.isfinite(tensor).all():
        raise ValueError(f"tensor must be finite, got {np.count_nonzero(~np.isfinite(tensor))} values that are not")
    size = np.linalg.norm(tensor)
    if size == 0:
        return [np.zeros((n, 1)) for n in tensor.shape], np.zeros(1)
    factors = [np.zeros((n, 0)) for n in tensor.shape]
    left = tensor
    for _ in range(options.terms):
        term = _best_product(left, options.alternations)
        factors = [np.column_stack([factor, column]) for factor, column in zip(factors, term, strict=True)]
        for _ in range(options.sweeps):
            factors = _sweep(tensor, factors)
        left = tensor - compose(factors)
        if np.linalg.norm(left) <= options.tolerance * size:
            break
    order = np.argsort(-np.linalg.norm(factors[0], axis=0))
    factors = [factor[:, order] for factor in factors]
    return factors, _prefix_errors(tensor, factors)


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


def _sweep(tensor: np.ndarray, factors: list[np.ndarray]) -> list[np.ndarray]:
    """One round of alternating least squares over all terms, damped so that no two can grow against each other."""
    factors = list(factors)
    for a in range(tensor.ndim - 1, -1, -1):
        others = _khatri_rao(factors[:a] + factors[a + 1 :])
        unfolded = np.moveaxis(tensor, a, 0).reshape(tensor.shape[a], -1)
        gram = np.ones((others.shape[1],) * 2)
        for b, factor in enumerate(factors):
            if b != a:
                gram *= factor.T @ factor
        damping = 1e-10 * np.trace(gram) / len(gram)
        # Damped towards the present factor: a plain minimum-norm damping would bias every value.
        right = unfolded @ others + damping * factors[a]
        updated = np.linalg.solve(gram + damping * np.eye(len(gram)), right.T).T
        if a > 0:
            length = np.linalg.norm(updated, axis=0)
            length[length == 0] = 1.0
            updated, factors[0] = updated / length, factors[0] * length
        factors[a] = updated
    return factors


def _prefix_errors(tensor: np.ndarray, factors: list[np.ndarray]) -> np.ndarray:
    left, errors, size = tensor.copy(), [], np.linalg.norm(tensor)
    for k in range(factors[0].shape[1]):
        left -= compose([factor[:, k : k + 1] for factor in factors])
        errors.append(np.linalg.norm(left) / size)
    return np.array(errors)

"""Greedy enrichment: what has low rank is found, what has none is not forced."""

import numpy as np
import pytest

from rom.enrichment import EnrichmentOptions, compose, separate


def of_rank(rank: int, shape: tuple[int, ...], seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    return compose([random.standard_normal((n, rank)) for n in shape])


@pytest.mark.parametrize("shape", [(6, 7), (5, 6, 7), (4, 5, 6, 5)])
@pytest.mark.parametrize("rank", [1, 2, 3])
def test_tensors_of_known_rank_are_recovered(shape, rank):
    tensor = of_rank(rank, shape, seed=rank)
    factors, errors = separate(tensor, EnrichmentOptions(tolerance=1e-10, terms=3 * rank, sweeps=200))
    assert errors[-1] < 1e-10
    assert compose(factors) == pytest.approx(tensor, abs=1e-9 * np.abs(tensor).max())


def test_a_matrix_needs_no_more_terms_than_its_rank():
    factors, errors = separate(of_rank(4, (20, 15), seed=0), EnrichmentOptions(tolerance=1e-8, sweeps=50))
    assert factors[0].shape[1] == len(errors) == 4


@pytest.mark.parametrize("seed", range(3))
def test_the_border_rank_tensor_does_not_make_terms_grow_without_end(seed):
    """a.a.b + a.b.a + b.a.a has rank 3 and border rank 2: a fit with two terms has no minimum, only terms that grow
    against each other for ever (de Silva, Lim, SIAM J. Matrix Anal. Appl. 30, 2008)."""
    a, b = np.linalg.qr(np.random.default_rng(seed).standard_normal((4, 4)))[0][:2]
    tensor = sum(np.einsum("i,j,k", *order) for order in ((a, a, b), (a, b, a), (b, a, a)))
    factors, _ = separate(tensor, EnrichmentOptions(tolerance=1e-12, terms=2, sweeps=2000))
    assert np.linalg.norm(factors[0], axis=0).max() < 10 * np.linalg.norm(tensor)
    _, errors = separate(tensor, EnrichmentOptions(tolerance=1e-8, terms=12, sweeps=500))
    assert errors[-1] < 1e-8


def test_reported_errors_are_those_of_the_leading_terms():
    tensor = of_rank(8, (6, 6, 6), seed=5)
    factors, errors = separate(tensor, EnrichmentOptions(tolerance=1e-3, terms=6))
    for k in range(len(errors)):
        left = tensor - compose([factor[:, : k + 1] for factor in factors])
        assert errors[k] == pytest.approx(np.linalg.norm(left) / np.linalg.norm(tensor), rel=1e-9)


def test_a_smooth_function_needs_few_terms_and_a_kinked_one_many():
    x = np.linspace(0, 1, 21)
    smooth = np.exp(-(np.subtract.outer(x, x) ** 2))
    kinked = np.abs(np.subtract.outer(x, x))
    terms = {
        name: separate(tensor, EnrichmentOptions(tolerance=1e-4))[0][0].shape[1]
        for name, tensor in (("smooth", smooth), ("kinked", kinked))
    }
    assert terms["smooth"] <= 5 < terms["kinked"]


def test_zero_is_one_term_and_nan_is_refused():
    factors, errors = separate(np.zeros((3, 4)), EnrichmentOptions())
    assert compose(factors) == pytest.approx(np.zeros((3, 4))) and errors[-1] == 0
    with pytest.raises(ValueError, match="1 values that are not"):
        separate(np.array([[1.0, np.nan], [0.0, 1.0]]), EnrichmentOptions())

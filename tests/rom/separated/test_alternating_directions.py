"""Greedy enrichment: what has low rank is found, what has none is not forced."""

import numpy as np
import pytest

from rom.separated.alternating_directions import EnrichmentOptions, compose, separate, slopes


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


@pytest.mark.parametrize("share", [0.1, 0.4])
def test_missing_states_do_not_spoil_the_fit(share):
    """A tensor of rank 2 is known again where it was missing."""
    tensor = of_rank(2, (3, 9, 8, 7), seed=1)
    missing = np.random.default_rng(2).random(tensor.shape[1:]) < share
    holed = np.where(missing, np.nan, tensor)
    factors, errors = separate(holed, EnrichmentOptions(tolerance=1e-9, terms=2, sweeps=500))
    assert errors[-1] < 1e-6
    assert np.abs(compose(factors) - tensor)[:, missing].max() < 1e-4 * np.abs(tensor).max()


def test_nodal_slopes_are_those_of_the_tensor_given():
    """u = sin(x) exp(y) + x y: the factors' slopes along x, with the other factors, give du/dx at every node."""
    x, y = np.linspace(0, 1, 7), np.linspace(0, 1, 6)
    tensor = (np.outer(np.sin(x), np.exp(y)) + np.outer(x, y))[None]
    derivative = (np.outer(np.cos(x), np.exp(y)) + y)[None]
    factors, _ = separate(tensor, EnrichmentOptions(tolerance=1e-12, sweeps=50))
    found = [factors[0], slopes(factors, derivative, 1), factors[2]]
    assert compose(found) == pytest.approx(derivative, abs=1e-8)


def test_the_same_tensor_gives_the_same_terms_bit_for_bit():
    tensor = np.where(np.random.default_rng(0).random((7, 6, 5)) < 0.2, np.nan, of_rank(5, (4, 7, 6, 5), seed=3))
    first, second = (separate(tensor, EnrichmentOptions(terms=6))[0] for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def test_zero_is_one_term_and_a_point_that_is_half_missing_is_missing():
    factors, errors = separate(np.zeros((3, 4)), EnrichmentOptions())
    assert compose(factors) == pytest.approx(np.zeros((3, 4))) and errors[-1] == 0
    tensor = of_rank(2, (3, 6, 5), seed=4)
    whole, half = (np.where(np.arange(30).reshape(6, 5) == 8, np.nan, tensor) for _ in range(2))
    half[:2, 1, 3] = 1.0, np.inf
    first, second = (compose(separate(one, EnrichmentOptions(terms=3))[0]) for one in (whole, half))
    assert np.array_equal(first, second)


@pytest.mark.parametrize("size", [1e-150, 1.0, 1e150])
@pytest.mark.parametrize("kind", ["constant", "linear", "jump", "noise"])
def test_the_stated_error_is_the_true_one_whatever_the_size_of_the_numbers(kind, size):
    x, y, z = np.meshgrid(*[np.linspace(0, 1, 12)] * 3, indexing="ij")
    noise = np.random.default_rng(1).standard_normal(x.shape)
    tensor = {"constant": 0 * x + 3.7, "linear": 1 + x + 2 * y - z, "jump": 1.0 * (x + y > z + 0.5), "noise": noise}[
        kind
    ]
    factors, errors = separate(size * tensor[None], EnrichmentOptions(tolerance=1e-10, terms=20))
    left = np.linalg.norm(compose(factors) / size - tensor[None]) / np.linalg.norm(tensor)
    assert left == pytest.approx(errors[-1], abs=1e-9)

"""Regression with derivatives: what is a polynomial is found, what is smooth converges, missing states do no harm."""

import numpy as np
import pytest

from rom.fit import chebyshev
from rom.elements.polynomial import Samples, fit, total_degree

LOWER, UPPER = np.array([-1.0, 0.0, 2.0]), np.array([3.0, 1.0, 5.0])


def samples(function, n: int, p: int = 3, seed: int = 0, with_slopes: bool = True) -> Samples:
    """Values and derivatives (by complex steps) of a function at random points."""
    points = LOWER[:p] + np.random.default_rng(seed).random((n, p)) * (UPPER - LOWER)[:p]
    values = np.array([function(point) for point in points])
    steps = 1e-30j * np.eye(p)
    slopes = np.array([[np.imag(function(point + step)) / 1e-30 for step in steps] for point in points])
    return Samples(
        points=points,
        values=values,
        slopes=slopes.transpose(0, 2, 1) if with_slopes else None,
        weights=np.ones(n),
        lower=LOWER[:p],
        upper=UPPER[:p],
    )


def cubic(x):
    return np.array([x[0] ** 2 * x[1] + x[2], 3.0 * x[1] ** 3 - x[0] * x[2]])


def smooth(x):
    return np.array([np.exp(0.3 * x[0]) / (1 + x[1]) + np.sin(x[2])])


def test_a_polynomial_is_found_with_its_derivatives():
    found = fit(samples(cubic, 40))
    fresh = samples(cubic, 50, seed=1)
    value, gradient = found.polynomial.value_and_gradient(fresh.points)
    assert found.degree >= 3
    assert value == pytest.approx(fresh.values, abs=1e-6)
    assert gradient == pytest.approx(fresh.slopes, abs=1e-5)
    assert np.abs(found.residuals).max() < 1e-5


def test_a_smooth_function_converges_faster_than_any_power_of_the_number_of_states():
    fresh = samples(smooth, 200, seed=1)
    errors = [
        np.abs(fit(samples(smooth, n)).polynomial.value(fresh.points) - fresh.values).max() for n in (20, 80, 320)
    ]
    assert errors[2] < 1e-4 * errors[0] and errors[2] < 1e-5


def test_derivatives_are_worth_states():
    fresh = samples(smooth, 200, seed=1)
    errors = [
        np.abs(fit(samples(smooth, 60, with_slopes=given)).polynomial.value(fresh.points) - fresh.values).max()
        for given in (True, False)
    ]
    assert errors[0] < 0.1 * errors[1]


def test_states_left_out_are_predicted_as_a_fit_without_them_would():
    """The formula with the leverages against fits that never saw the state."""
    given = samples(smooth, 45)
    found = fit(given)
    for state in (0, 7, 44):
        rest = np.arange(45) != state
        without = Samples(
            points=given.points[rest],
            values=given.values[rest],
            slopes=given.slopes[rest],
            weights=given.weights[rest],
            lower=LOWER,
            upper=UPPER,
        )
        left_out = chebyshev._fit(without, found.degree).polynomial.value(given.points[~rest])
        # The prior counts by the number of rows, which differs a little.
        assert found.residuals[~rest] == pytest.approx(given.values[~rest] - left_out, rel=0.05, abs=1e-5)


def test_a_function_of_which_little_is_known_gets_a_low_degree():
    assert fit(samples(smooth, 1)).degree <= 1
    assert fit(samples(smooth, 3)).degree <= 2
    noisy = samples(smooth, 60, with_slopes=False)
    noise = Samples(**{**noisy.__dict__, "values": np.random.default_rng(3).standard_normal((60, 1))})
    assert fit(noise).degree <= 2


@pytest.mark.parametrize(("p", "degree", "count"), [(1, 4, 5), (3, 2, 10), (5, 6, 462)])
def test_the_number_of_products_is_the_binomial_coefficient(p, degree, count):
    powers = total_degree(p, degree)
    assert powers.shape == (count, p)
    assert len({tuple(row) for row in powers.tolist()}) == count and powers.sum(axis=1).max() == degree

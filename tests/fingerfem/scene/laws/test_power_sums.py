"""Sums of powers of three eigenvalues from their invariants, by eigenvalues."""

import numpy as np
import pytest

from fingerfem.scene.laws.formula import NUMPY
from fingerfem.scene.laws.power_sums import ERROR, STRETCHES, power_sum

POWERS = [0.0, 1.0, 2.0, 5.0, -1.0, -3.0, 0.5, 0.65, 1.3, 2.99, 7.4, 0.01, 0.99, -0.5, -2.3, -6.1]


@pytest.mark.parametrize("power", POWERS)
def test_a_sum_is_that_of_the_eigenvalues_powers(power):
    e = np.random.default_rng(7).uniform(-1, 1, (20_000, 3)) * np.log(STRETCHES[1])
    e -= e.mean(axis=1, keepdims=True)
    b = np.exp(2 * e[np.abs(e).max(axis=1) <= np.log(STRETCHES[1])])
    found = power_sum(power, b.sum(axis=1), (1 / b).sum(axis=1), NUMPY)
    allowed = 1e-11 if power == int(power) else ERROR * 10
    assert len(b) > 5000 and found == pytest.approx((b**power).sum(axis=1), rel=allowed)


@pytest.mark.parametrize("power", [0.65, 3.5, -2.3])
def test_second_derivatives_at_rest_are_those_of_equal_eigenvalues(power):
    """By b1 = e^x, b2 = e^-x, b3 = 1 the sum is 1 + 2 cosh(power x), whose second derivative at rest is 2 power^2."""
    x = 1e-3
    values = [power_sum(power, 1 + 2 * np.cosh(one), 1 + 2 * np.cosh(one), NUMPY) for one in (-x, 0.0, x)]
    assert np.diff(values, 2)[0] / x**2 == pytest.approx(2 * power**2, rel=1e-5)

"""Bounded Levenberg-Marquardt on problems with known answers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.least_squares import Options, minimise

WIDE = np.full(2, -10.0), np.full(2, 10.0)


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


@given(st.floats(-5, 5), st.floats(-5, 5))
def test_rosenbrocks_valley_is_followed_to_its_end_from_anywhere(a, b):
    solution = minimise(rosenbrock, np.array([a, b]), WIDE, Options(residual=1e-9, iterations=300))
    assert solution.status == "converged"
    assert solution.x == pytest.approx([1.0, 1.0], abs=1e-6)


def test_a_minimum_on_a_bound_is_found_and_called_stationary():
    solution = minimise(rosenbrock, np.zeros(2), (np.full(2, -2.0), np.array([0.5, 2.0])), Options(residual=1e-9))
    assert solution.status == "stationary"
    assert solution.x == pytest.approx([0.5, 0.25], abs=1e-6)  # x0 held at its bound, x1 = x0^2
    assert solution.residual == pytest.approx(0.5)


def test_a_rank_deficient_jacobian_gives_the_solution_nearest_the_start():
    def line(x):
        return np.array([x[0] + x[1] - 2.0]), np.array([[1.0, 1.0]])

    solution = minimise(line, np.array([3.0, 1.0]), WIDE, Options(residual=1e-10))
    assert solution.status == "converged"
    assert solution.x == pytest.approx([2.0, 0.0], abs=1e-3)


def test_a_start_on_a_plateau_is_stationary_and_not_converged():
    solution = minimise(lambda x: (np.array([1.0]), np.zeros((1, 2))), np.zeros(2), WIDE, Options())
    assert solution.status == "stationary" and solution.residual == 1.0 and solution.iterations == 1


def test_the_iteration_limit_is_said():
    solution = minimise(rosenbrock, np.array([-5.0, 5.0]), WIDE, Options(residual=1e-9, iterations=3))
    assert solution.status == "iteration_limit" and solution.iterations == 3


def test_it_never_leaves_the_bounds_nor_evaluates_outside():
    seen = []

    def watched(x):
        seen.append(x.copy())
        return rosenbrock(x)

    lower, upper = np.array([-1.5, -0.5]), np.array([0.7, 2.0])
    minimise(watched, np.array([-9.0, 9.0]), (lower, upper), Options())
    assert np.all(np.array(seen) >= lower) and np.all(np.array(seen) <= upper)


def test_fixed_variables_stay():
    solution = minimise(rosenbrock, np.array([0.3, 0.0]), (np.array([0.3, -5.0]), np.array([0.3, 5.0])), Options())
    assert solution.x == pytest.approx([0.3, 0.09], abs=1e-6)


def test_nan_ahead_is_stepped_back_from():
    def wall(x):
        value = x[0] - 1.0 if x[0] < 2.0 else np.nan
        return np.array([value**3 if value == value else np.nan]), np.array([[3 * value**2, 0.0]])

    solution = minimise(wall, np.array([-3.0, 0.0]), WIDE, Options(residual=1e-6))
    assert np.isfinite(solution.x).all() and solution.status == "converged"


@pytest.mark.parametrize("start", [np.array([np.nan, 0.0]), np.array([0.0, np.inf])])
def test_a_start_that_is_no_number_is_refused(start):
    with pytest.raises(ValueError, match="start and bounds must be finite"):
        minimise(rosenbrock, start, WIDE, Options())

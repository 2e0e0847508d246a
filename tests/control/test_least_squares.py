"""Bounded Levenberg-Marquardt on problems with known answers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares, minimize

from control.least_squares import Rules, minimise

WIDE = np.full(2, -10.0), np.full(2, 10.0)


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


@given(st.floats(-5, 5), st.floats(-5, 5))
def test_rosenbrocks_valley_is_followed_to_its_end_from_anywhere(a, b):
    solution = minimise(rosenbrock, np.array([a, b]), WIDE, Rules(residual=1e-9, iterations=300))
    assert solution.status == "converged"
    assert solution.x == pytest.approx([1.0, 1.0], abs=1e-6)


def test_a_minimum_on_a_bound_is_found_and_called_stationary():
    solution = minimise(rosenbrock, np.zeros(2), (np.full(2, -2.0), np.array([0.5, 2.0])), Rules(residual=1e-9))
    assert solution.status == "stationary"
    assert solution.x == pytest.approx([0.5, 0.25], abs=1e-6)  # x0 held at its bound, x1 = x0^2
    assert solution.residual == pytest.approx(0.5)


def test_a_rank_deficient_jacobian_gives_the_solution_nearest_the_start():
    def line(x):
        return np.array([x[0] + x[1] - 2.0]), np.array([[1.0, 1.0]])

    solution = minimise(line, np.array([3.0, 1.0]), WIDE, Rules(residual=1e-10))
    assert solution.status == "converged"
    assert solution.x == pytest.approx([2.0, 0.0], abs=1e-9)


@given(st.lists(st.floats(-3, 3), min_size=4, max_size=4))
def test_of_the_points_on_a_curved_surface_the_nearest_to_the_start_is_taken(start):
    """A sphere of radius 2 around the origin in four dimensions: the nearest point lies on the start's own ray."""
    start = np.array(start)
    if np.linalg.norm(start) < 0.1:
        return

    def sphere(x):
        return np.array([x @ x - 4.0]), 2 * x[None]

    bounds = np.full(4, -10.0), np.full(4, 10.0)
    solution = minimise(sphere, start, bounds, Rules(residual=1e-9, nearest=1e-7))
    assert solution.status == "converged" and solution.residual <= 1e-9
    assert solution.x == pytest.approx(2 * start / np.linalg.norm(start), abs=1e-4)


def test_the_nearest_solution_is_scipys_also_where_bounds_hold():
    """One nonlinear equation in four unknowns, as one force by four tensions: SLSQP minimises the distance itself."""
    random, found = np.random.default_rng(5), 0
    lower, upper = np.zeros(4), np.ones(4)
    for _ in range(100):
        a, b, start = random.uniform(0.2, 1, 4), random.uniform(-0.5, 0.5, (4, 4)), random.uniform(0, 1, 4)
        b, target = b @ b.T, random.uniform(0.3, 2.0)

        def equation(x, a=a, b=b, target=target):
            return np.array([a @ x + x @ b @ x - target]), (a + 2 * b @ x)[None]

        solution = minimise(
            equation, start, (lower, upper), Rules(residual=1e-9, nearest=1e-6, null_space_iterations=100)
        )
        other = minimize(
            lambda x, start=start: (x - start) @ (x - start),
            start,
            jac=lambda x, start=start: 2 * (x - start),
            bounds=[(0, 1)] * 4,
            constraints={"type": "eq", "fun": lambda x, e=equation: e(x)[0], "jac": lambda x, e=equation: e(x)[1]},
            method="SLSQP",
            options={"ftol": 1e-12, "maxiter": 300},
        )
        if other.success:
            found += 1
            assert solution.status == "converged"
            assert np.linalg.norm(solution.x - start) <= np.linalg.norm(other.x - start) + 1e-6
    assert found > 50


def test_least_squares_with_bounds_agree_with_scipys():
    random = np.random.default_rng(3)
    for _ in range(60):
        a, b, c = random.standard_normal((6, 3)), random.standard_normal((6, 3)), random.standard_normal(6)

        def residual(x, a=a, b=b, c=c):
            return a @ x + 0.1 * (b @ x) ** 2 - 2 * c, a + 0.2 * (b @ x)[:, None] * b

        bounds = np.full(3, -0.5), np.full(3, 0.5)
        own = minimise(residual, np.zeros(3), bounds, Rules(residual=1e-12))
        other = least_squares(
            lambda x, f=residual: f(x)[0], np.zeros(3), lambda x, f=residual: f(x)[1], bounds, xtol=1e-14, ftol=1e-14
        )
        assert own.status == "stationary"
        assert own.residual == pytest.approx(np.sqrt(2 * other.cost), rel=1e-6)
        assert own.x == pytest.approx(other.x, abs=1e-4)


def test_a_start_on_a_plateau_is_stationary_and_not_converged():
    solution = minimise(lambda x: (np.array([1.0]), np.zeros((1, 2))), np.zeros(2), WIDE, Rules())
    assert solution.status == "stationary" and solution.residual == 1.0 and solution.iterations == 1


def test_the_iteration_limit_is_said():
    solution = minimise(rosenbrock, np.array([-5.0, 5.0]), WIDE, Rules(residual=1e-9, iterations=3))
    assert solution.status == "iteration_limit" and solution.iterations == 3


def test_it_never_leaves_the_bounds_nor_evaluates_outside():
    seen = []

    def watched(x):
        seen.append(x.copy())
        return rosenbrock(x)

    lower, upper = np.array([-1.5, -0.5]), np.array([0.7, 2.0])
    minimise(watched, np.array([-9.0, 9.0]), (lower, upper), Rules())
    assert np.all(np.array(seen) >= lower) and np.all(np.array(seen) <= upper)


def test_fixed_variables_stay():
    solution = minimise(rosenbrock, np.array([0.3, 0.0]), (np.array([0.3, -5.0]), np.array([0.3, 5.0])), Rules())
    assert solution.x == pytest.approx([0.3, 0.09], abs=1e-6)


def test_nan_ahead_is_stepped_back_from():
    def wall(x):
        value = x[0] - 1.0 if x[0] < 2.0 else np.nan
        return np.array([value**3 if value == value else np.nan]), np.array([[3 * value**2, 0.0]])

    solution = minimise(wall, np.array([-3.0, 0.0]), WIDE, Rules(residual=1e-6))
    assert np.isfinite(solution.x).all() and solution.status == "converged"


@pytest.mark.parametrize("start", [np.array([np.nan, 0.0]), np.array([0.0, np.inf])])
def test_a_start_that_is_no_number_is_refused(start):
    with pytest.raises(ValueError, match="start and bounds must be finite"):
        minimise(rosenbrock, start, WIDE, Rules())

"""Equilibrium tensions of a free tip along a curve: solved at rows that follow its bends, interpolated between them."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from control.least_squares import Rules, minimise
from rom.rod.touched_segment import TouchedSegment

CHOICE = 1e-4  # weight of the distance from the pretension over the range: selects one of many solutions [m]
RULES = Rules(residual=1e-9, longest=0.2, step=1e-5, nearest=1.0, null_space_iterations=0, iterations=40)
FIRST = 8  # intervals of a curve before they are halved
SMOOTH = 2e-6  # largest difference of an interpolated tip from a solved one [m]
NEWTON = 3  # steps at a row near bounds
LOOSE = 1e-3  # likewise of tensions, over their range [-]

Bounds = tuple[np.ndarray, np.ndarray]


def pretensioned(share: float, bounds: Bounds) -> np.ndarray:
    """Tensions at a share of their range, shape (t,) [N]."""
    return np.asarray(bounds[0] + share * (bounds[1] - bounds[0]))


def resting(model: TouchedSegment, goal: np.ndarray, pretension: float, bounds: Bounds) -> np.ndarray:
    """Equilibrium tensions, shape (t,) [N], near a pretension [-], of the tip nearest to y and z, shape (2,) [m]."""
    pulled = pretensioned(pretension, bounds)
    return inverse(model, goal, pulled, pulled, bounds)


def inverse(
    model: TouchedSegment, goal: np.ndarray, start: np.ndarray, pretension: np.ndarray, bounds: Bounds
) -> np.ndarray:
    """Equilibrium tensions, shape (t,) [N], of the free tip nearest to y and z, shape (2,) [m]."""
    away = np.full(len(model.objects), np.inf)

    def residual(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, jacobian = model.value_and_jacobian(np.append(tensions, away))
        return value[1:3] + model.rod.rest[1:] - goal, jacobian[1:3, : len(start)]

    return solved(residual, start, pretension, bounds)


def solved(
    residual: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    start: np.ndarray,
    pretension: np.ndarray,
    bounds: Bounds,
) -> np.ndarray:
    """Tensions, shape (t,) [N], of the least residual [m]; of many solutions the nearest to the pretension."""
    weight = CHOICE / np.maximum(bounds[1] - bounds[0], 1e-9)

    def both(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, jacobian = residual(tensions)
        return np.concatenate([value, weight * (tensions - pretension)]), np.vstack([jacobian, np.diag(weight)])

    return minimise(both, start, bounds, RULES).x


def inverses(model: TouchedSegment, goals: np.ndarray, pretension: np.ndarray, bounds: Bounds) -> np.ndarray:
    """Equilibrium tensions, shape (n, t) [N], of the free tip along goals, shape (n, 2) [m].

    An interval is halved until its middle is interpolated well, or it has no row inside. Rows that are still not
    interpolated well are solved.
    """
    last, width = len(goals) - 1, np.maximum(bounds[1] - bounds[0], 1e-9)
    rows = np.unique(np.linspace(0, last, FIRST + 1).round().astype(int))
    found: dict[int, np.ndarray] = {}
    start = pretension
    for row in rows.tolist():
        start = found[row] = inverse(model, goals[row], start, pretension, bounds)
    waiting = list(pairwise(rows.tolist()))
    away = np.full(len(model.objects), np.inf)
    while waiting:
        curve, halves = interpolated(found), []
        for first, second in waiting:
            row = (first + second) // 2
            if row == first:
                continue
            expected = np.clip(curve(row), *bounds)
            own = inverse(model, goals[row], expected, pretension, bounds)
            slopes = model.jacobian(np.append(own, away))[1:3, : len(own)]
            near = np.linalg.norm(slopes @ (expected - own)) <= SMOOTH
            if not (near and (np.abs(expected - own) <= LOOSE * width).all()):
                halves += [(first, row), (row, second)]
            found[row] = own
        waiting = halves
    tensions = np.clip(interpolated(found)(np.arange(len(goals))), *bounds)
    tips = model.outputs(np.column_stack([tensions, np.tile(away, (len(goals), 1))]))[:, 1:3] + model.rod.rest[1:]
    for row in np.flatnonzero(np.linalg.norm(tips - goals, axis=1) > SMOOTH):
        tensions[row] = _nearer(
            model, goals[row], inverse(model, goals[row], tensions[row], pretension, bounds), bounds
        )
    return tensions


def _nearer(model: TouchedSegment, goal: np.ndarray, tensions: np.ndarray, bounds: Bounds) -> np.ndarray:
    """Tensions after Newton steps: at bounds, the weight of the pretension moves the tip off its goal."""
    away = np.full(len(model.objects), np.inf)
    for _ in range(NEWTON):
        value, jacobian = model.value_and_jacobian(np.append(tensions, away))
        inside = (tensions > bounds[0]) & (tensions < bounds[1])
        step = np.linalg.pinv(jacobian[1:3, : len(tensions)] * inside) @ (goal - value[1:3] - model.rod.rest[1:])
        tensions = np.clip(tensions + step, *bounds)
    return tensions


def interpolated(found: dict[int, np.ndarray]) -> CubicSpline:
    """A cubic spline through values, shapes (t,), of at least two rows."""
    rows = sorted(found)
    return CubicSpline(rows, [found[row] for row in rows])

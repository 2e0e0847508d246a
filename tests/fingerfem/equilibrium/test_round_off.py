"""Steel plates on soft rubber: round-off holds the residual up, and no iteration is wasted on it."""

import itertools

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.scene.scene import Scene

SLENDERNESS = 6  # length over side [-]


def finger(side: float, C1: float, nu: float, order: int, plate: float) -> FingerModel:
    """A square one with two tendons; its plate's thickness is a share of its side."""
    tendons = [
        {"name": name, "offset": offset, "segment": 1, "tension": [0.0, 0.195 * C1 * side**2]}
        for name, offset in (("F1", [0.4 * side, 0.0]), ("F2", [0.0, 0.4 * side]))
    ]
    table = {
        "name": "plate on rubber",
        "geometry": {"side": side, "segments": [SLENDERNESS * side], "plate": plate * side},
        "material": {"law": "neo-hookean", "E": 4 * C1 * (1 + nu), "nu": nu},
        "tendons": tendons,
        "mesh": {"cells": [{1: 11, 2: 7}[order], 5], "order": order},
    }
    return FingerModel(Scene.model_validate(table))


def bend(model: FingerModel, C1: float) -> np.ndarray:
    """Displacement over the side; what further iterations of Newton's method move is nothing."""
    side = model.scene.geometry.side
    found = model.solve(np.array([0.19, 0.11]) * C1 * side**2, sensitivities=False).displacement
    newton = model.continuation.newton
    newton.options = NewtonOptions(tolerance=0.0, settled=1e-13)
    newton.solve("plain")
    assert np.abs(model.problem.displacement - found).max() < 1e-10 * SLENDERNESS * side
    return found / side


@pytest.fixture(scope="module")
def soft() -> FingerModel:
    """One whose residual stays above what other fingers reach."""
    model = finger(0.01, 5e3, 0.3, 2, 0.01)
    bend(model, 5e3)
    return model


def test_a_residual_above_the_tolerance_costs_no_failed_attempt(soft):
    assert soft.continuation.newton.round_off() > soft.continuation.newton.options.noise
    assert soft.continuation.wasted == 0
    assert soft.continuation.iterations <= 15


def test_the_round_off_of_the_residual_is_that_of_rounded_displacements(soft):
    problem, random = soft.problem, np.random.default_rng(0)
    at, residual = problem.displacement.copy(), _values(soft)
    problem.displacement[:] = at * (1 + np.finfo(float).eps / 2 * random.uniform(-1, 1, at.size))
    change = np.linalg.norm(_values(soft) - residual) / problem.force_scale
    problem.displacement[:] = at
    assert 0.3 < change / soft.continuation.newton.round_off() < 2
    assert 0.3 < _residual(soft) / soft.continuation.newton.round_off() < 2


@pytest.mark.parametrize(("order", "nu"), [(1, 0.3), pytest.param(2, 0.4999, marks=pytest.mark.long)])
def test_extremes_of_size_and_stiffness_bend_alike(order, nu):
    """Steel differs: it is 8e3 to 1e6 times stiffer than the rubber."""
    found = [bend(finger(side, C1, nu, order, 0.1), C1) for C1, side in itertools.product((5e3, 5e6), (3e-3, 0.1))]
    for small, large in (found[:2], found[2:]):
        assert np.abs(small - large).max() < 1e-9
    assert np.abs(found[0] - found[2]).max() < 1e-2


def _values(model: FingerModel) -> np.ndarray:
    residual, _ = model.problem.residual()
    values = residual.array_r.copy()
    residual.destroy()
    return values


def _residual(model: FingerModel) -> float:
    """Over E A [-]."""
    return float(np.linalg.norm(_values(model)) / model.problem.force_scale)

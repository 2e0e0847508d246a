"""Frequencies by closed forms; modes about loaded and unstable states."""

import numpy as np
import pytest
from scipy.optimize import brentq

from fingerfem.dynamics.modes import ModalAnalysis
from fingerfem.scene.scene import Scene

E, RHO, SIDE, LENGTH = 1e6, 1100.0, 0.01, 0.1


@pytest.fixture(scope="module")
def bar():
    """Modes of a bar of Poisson's ratio 0, its plate as light as rubber and a five-hundredth of its length."""
    table = {
        "name": "bar",
        "geometry": {"side": SIDE, "segments": [LENGTH], "plate": 0.0002, "channel": SIDE / 3},
        "material": {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.0},
        "density": {"rubber": RHO, "plates": RHO},
        "tendons": [{"name": "F1", "offset": [SIDE / 3, 0.0], "segment": 1, "tension": [0.0, 1.0]}],
        "mesh": {"cells": [20, 3], "order": 2},
    }
    return ModalAnalysis(Scene.model_validate(table)).solve([0.0], count=8)


def along(modes, axis: int) -> np.ndarray:
    """Frequencies of the modes that move mass along an axis."""
    return modes.frequencies[modes.participation[:, axis] > 0.01]


def timoshenko(length: float, count: int) -> np.ndarray:
    """Frequencies of a cantilever with shear and rotary inertia [Hz], from its characteristic determinant."""
    area, second, shear = SIDE**2, SIDE**4 / 12, E / 2 * 5 / 6

    def determinant(w: float) -> float:
        # (w, psi) = (1, r) exp(s x): two equations of motion give a quadratic in s^2
        a, b, c = 1.0, RHO * w**2 * (1 / E + 1 / shear), RHO * w**2 / E * (RHO * w**2 / shear - area / second)
        squares = np.roots([a, b, c]).astype(complex)
        s = np.sqrt(np.concatenate([squares, squares]))
        s[2:] *= -1
        ratio = s + RHO * w**2 / (shear * s)
        end = np.exp(s * length)
        rows = np.array([np.ones(4), ratio, ratio * s * end, (s - ratio) * end])
        value = np.linalg.det(rows / np.abs(rows).max(axis=1, keepdims=True))
        return float(value.real if abs(value.real) > abs(value.imag) else value.imag)

    grid = 2 * np.pi * np.linspace(1.0, 90.0, 4000)
    values = np.array([determinant(w) for w in grid])
    jumps = np.flatnonzero(values[:-1] * values[1:] < 0)
    return np.array([brentq(determinant, grid[k], grid[k + 1]) for k in jumps[:count]]) / (2 * np.pi)


def test_the_first_axial_mode_is_that_of_a_bar_and_moves_its_share_of_mass(bar):
    (first,) = along(bar, 0)
    (share,) = bar.participation[bar.participation[:, 0] > 0.01, 0]
    assert first == pytest.approx(np.sqrt(E / RHO) / (4 * LENGTH), rel=1e-5)
    assert share == pytest.approx(8 / np.pi**2, rel=1e-4)


def test_bending_modes_are_those_of_timoshenko_s_cantilever_in_both_planes(bar):
    expected = timoshenko(LENGTH, 3)
    assert len(expected) == 3 and expected[0] == pytest.approx(4.84, abs=0.01)
    for axis in (1, 2):
        assert along(bar, axis) == pytest.approx(expected, rel=3e-3)


def test_modes_fulfil_their_equation_and_the_mass_is_the_finger_s(bar):
    assert bar.residuals.max() < 1e-3  # over |K f|, which the steel plate's round-off dominates
    assert bar.mass == pytest.approx(RHO * SIDE**2 * LENGTH, rel=1e-12)
    assert bar.as_json()["stable"] and (bar.participation.sum(axis=0) < 1).all()


def test_a_straight_tendon_that_buckles_the_finger_gives_a_negative_frequency(moving):
    moving["tendons"][0] |= {"path": "straight", "offset": [0.0, 0.0]}
    moving["mesh"] = {"cells": [10, 3]}
    analysis = ModalAnalysis(Scene.model_validate(moving))
    squares = []
    for tension in (0.0, 1.5, 4.5):  # a pull towards the clamp buckles at pi^2 EI / L^2, some 3.3 N
        found = analysis.solve([tension], count=2)
        squares.append(float((found.frequencies * np.abs(found.frequencies)).min()))
    assert squares[0] > squares[1] > 0 > squares[2] and not found.as_json()["stable"]


def test_branches_stiffen_modes_at_once_by_their_share(moving):
    moving["material"]["prony"] = [[0.3, 0.1], [0.2, 1.0]]
    analysis = ModalAnalysis(Scene.model_validate(moving))
    relaxed, fast = (analysis.solve([2.0], count=2, instantaneous=now).frequencies for now in (False, True))
    del moving["material"]["prony"]
    elastic = ModalAnalysis(Scene.model_validate(moving)).solve([2.0], count=2).frequencies
    assert relaxed == pytest.approx(elastic, rel=1e-6)
    mu, K = 1e6 / 2.6, 1e6 / 1.2
    young = [9 * K * m / (3 * K + m) for m in (mu, 1.5 * mu)]
    assert fast / relaxed == pytest.approx(np.sqrt(young[1] / young[0]) * np.ones(2), rel=0.02)


def test_a_count_that_a_mesh_does_not_have_is_refused(moving):
    with pytest.raises(ValueError, match="count must be above 0 and below"):
        ModalAnalysis(Scene.model_validate(moving)).solve([0.0], count=100_000)

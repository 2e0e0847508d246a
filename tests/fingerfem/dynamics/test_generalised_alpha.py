"""Motion in time: order of convergence, energy at every step, decay by one branch, base, relaxation."""

from itertools import pairwise

import numpy as np
import pytest

from fingerfem.dynamics.generalised_alpha import Scheme
from fingerfem.dynamics.modes import ModalAnalysis
from fingerfem.dynamics.motion import motion_of
from fingerfem.dynamics.simulation import Simulation
from fingerfem.scene.scene import Scene

SMOOTH = {"F1": {"mean": 1.5, "amplitude": 1.0, "frequency": 12.0, "phase": -np.pi / 2}}  # begins with no slope


def rows_of(table: dict, time: dict, loads: dict, base: dict | None = None) -> list[dict[str, float]]:
    scene, rows = Scene.model_validate(table), []
    motion = motion_of({"time": time, "loads": loads, "base": base or {}}, scene)
    Simulation(scene, motion).run(lambda row, _: rows.append(row))
    return rows


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.8, 1.0])
def test_the_coefficients_are_those_of_second_order_and_of_the_radius(radius):
    """Roots of the linear oscillator at infinite frequency: the largest is the spectral radius."""
    one = Scheme.of(radius)
    assert one.gamma == pytest.approx(0.5 - one.alpha_m + one.alpha_f)
    stiff = 1e16
    update = np.array([[1, 1, 0.5 - one.beta], [0, 1, 1 - one.gamma], [0, 0, 0]])
    by_acceleration = np.array([one.beta, one.gamma, 1.0])
    balance = (1 - one.alpha_m) + (1 - one.alpha_f) * stiff * one.beta
    known = np.array([-stiff * one.alpha_f, 0, -one.alpha_m]) - (1 - one.alpha_f) * stiff * update[0]
    whole = update + np.outer(by_acceleration, known / balance)
    assert np.abs(np.linalg.eigvals(whole)).max() == pytest.approx(radius, abs=1e-4)


@pytest.mark.parametrize("radius", [0.5, 0.8])
def test_halved_steps_quarter_the_error(moving, radius):
    def tip(step: float) -> np.ndarray:
        row = rows_of(moving, {"end": 0.06, "step": step, "spectral_radius": radius}, SMOOTH)[-1]
        return np.array([row["tip_x"], row["tip_y"]])

    tips = [tip(0.06 / n) for n in (40, 80, 160)]
    changes = [np.linalg.norm(one - other) for one, other in pairwise(tips)]
    assert changes[0] > 1e-6 and 3.2 < changes[0] / changes[1] < 5.0


def test_energy_is_kept_at_every_step_to_the_order_of_the_method(moving):
    """No step loses or makes more than a millionth of the largest energy, and halved steps a quarter of it."""
    moving["material"]["prony"] = [[0.3, 0.01]]
    worst = []
    for step in (5e-4, 2.5e-4):
        rows = rows_of(moving, {"end": 0.06, "step": step, "spectral_radius": 1.0}, SMOOTH)
        lost = np.array([row["lost"] for row in rows])
        scale = max(row["strain"] + row["kinetic"] for row in rows)
        assert np.abs(np.diff(lost)).max() < 1e-6 * scale
        assert rows[-1]["branches"] > 0.02 * scale
        worst.append(np.abs(lost).max() / scale)
    assert worst[0] < 1e-5 and worst[1] < 0.35 * worst[0]


def test_one_branch_makes_a_mode_of_a_bent_finger_decay_as_the_oscillator_s_closed_form(moving):
    """q'' + w^2 q + r = 0, r' + r / tau = (w0^2 - w^2) q' with the frequencies w relaxed and w0 at once."""
    tau, amplitude = 0.008, 1e-5  # [s], [kg^1/2 m]
    moving["material"]["prony"] = [[0.2, tau]]
    moving["mesh"]["symmetry"] = False
    scene = Scene.model_validate(moving)
    analysis = ModalAnalysis(scene)
    relaxed, fast = (analysis.solve([2.0], count=3, instantaneous=now) for now in (False, True))
    k = int(np.argmax(relaxed.participation[:2, 2]))  # in z, across the tendon
    w, w0 = (2 * np.pi * one.frequencies[k] for one in (relaxed, fast))
    shape = relaxed.shapes[k]
    time = {"end": 0.15, "step": 5e-4, "spectral_radius": 1.0}
    simulation = Simulation(scene, motion_of({"time": time, "loads": {"F1": 2.0}}, scene))
    moment, found = simulation.begin(amplitude * w * shape), []
    modal = analysis.problem.times_mass(shape)
    bent = moment.state.displacement
    simulation.run(lambda row, now: found.append((row["time"], modal @ (now.state.displacement - bent))), moment)
    times, q = np.array(found).T
    # (q, q', r)' = A (q, q', r)
    A = np.array([[0, 1, 0], [-(w**2), 0, -1], [0, w0**2 - w**2, -1 / tau]])
    values, vectors = np.linalg.eig(A)
    weights = np.linalg.solve(vectors, np.array([0, amplitude * w, 0]))
    exact = np.real(np.exp(np.outer(times, values)) @ (weights * vectors[0]))
    assert np.abs(exact[-60:]).max() < 0.6 * amplitude  # it has decayed
    assert np.abs(q - exact).max() < 0.02 * amplitude


def test_long_steps_lead_to_the_relaxed_equilibrium(moving):
    moving["material"]["prony"] = [[0.5, 0.05], [0.2, 10.0]]
    loads = {"F1": [[0.0, 0.0], [0.5, 2.0]]}
    last = rows_of(moving, {"end": 3600.0, "step": 300.0, "spectral_radius": 0.0}, loads)[-1]
    del moving["material"]["prony"]
    (still, *_) = rows_of(moving, {"end": 1e-3, "step": 1e-3}, {"F1": 2.0})
    assert last["tip_y"] == pytest.approx(still["tip_y"], rel=1e-6) and still["tip_y"] > 1e-3
    assert last["kinetic"] < 1e-9 * last["strain"]


def test_a_base_that_accelerates_is_weight_the_other_way(moving):
    loads = {"F1": 1.0}
    slow = {"end": 400.0, "step": 20.0, "spectral_radius": 0.0}
    pushed = rows_of(moving, slow, loads, {"ay": [[0.0, 0.0], [100.0, -4.0]], "ax": [[0.0, 0.0], [100.0, 3.0]]})[-1]
    moving["gravity"] = {"direction": [-3.0, 4.0, 0.0], "acceleration": 5.0}
    hung = rows_of(moving, {"end": 1e-3, "step": 1e-3}, loads)[0]
    names = ("tip_x", "tip_y", "turn_z")
    assert [pushed[name] for name in names] == pytest.approx([hung[name] for name in names], rel=1e-6)


def test_a_base_that_spins_stretches_a_bar_by_its_closed_form(moving):
    """u = w^2 (rho L^3 / 3 + m L x_m / A) / E of rubber of length L and a plate of mass m at x_m; small strains."""
    E, w, rho = 1e6, 2.0, 1100.0
    moving["material"] = {"law": "saint-venant-kirchhoff", "E": E, "nu": 0.0}
    moving["mesh"] = {"cells": [9, 3], "symmetry": False}
    ramp = {"wz": [[0.0, 0.0], [8.0, w]]}
    last = rows_of(moving, {"end": 12.0, "step": 0.1, "spectral_radius": 0.0}, {}, ramp)[-1]
    L, plate = 0.049, 7850.0 * 0.001
    expected = w**2 * (rho * L**3 / 3 + plate * L * 0.0495) / E
    assert last["tip_x"] == pytest.approx(expected, rel=2e-3)


def test_weight_turns_with_the_base(moving):
    """After a quarter turn about z, weight along y is along x."""
    moving["gravity"] = {"direction": [0.0, 1.0, 0.0], "acceleration": 2.0}
    turn = {"wz": [[0.0, 0.0], [20.0, np.pi / 40], [40.0, 0.0]]}
    last = rows_of(moving, {"end": 200.0, "step": 1.0, "spectral_radius": 0.0}, {}, turn)[-1]
    moving["gravity"]["direction"] = [1.0, 0.0, 0.0]
    hung = rows_of(moving, {"end": 1e-3, "step": 1e-3}, {})[0]
    assert last["tip_x"] == pytest.approx(hung["tip_x"], rel=1e-4)
    assert abs(last["tip_y"]) < 1e-6 * 0.05

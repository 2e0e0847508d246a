"""Impacts take energy and make none, whatever the step; at rest a finger presses as its equilibrium does."""

from itertools import pairwise

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.dynamics.generalised_alpha import MovingState, Scheme
from fingerfem.dynamics.modes import ModalAnalysis
from fingerfem.dynamics.motion import motion_of
from fingerfem.dynamics.simulation import Simulation
from fingerfem.scene.scene import Scene

PLANE = {"distance": [0.0005, 0.031]}
BALL = {"shape": "sphere", "centre": [0.047, 0.012, 0.0], "radius": 0.007, "distance": [-0.005, 0.02]}


def thrown(moving: dict, obstacle: dict, d: float, time: dict) -> list[dict[str, float]]:
    """From rest with the velocity of its first mode in the plane z = 0, towards what stands there."""
    moving["mesh"]["symmetry"] = False
    analysis = ModalAnalysis(Scene.model_validate(moving))
    modes = analysis.solve([0.0], count=2)
    shape = modes.shapes[int(np.argmax(modes.participation[:, 1]))]
    shape = shape * np.sign(shape.reshape(-1, 3)[:, 1].sum()) * 0.5 / np.abs(shape).max()  # the tip's 0.5 m/s
    scene, rows = Scene.model_validate(moving | {"obstacle": obstacle}), []
    simulation = Simulation(scene, motion_of({"time": time, "loads": {"d": d}}, scene))
    first = simulation.begin(shape)
    simulation.run(lambda row, _: rows.append(row), first)
    return [simulation.row(first), *rows]


@pytest.mark.parametrize(
    ("obstacle", "d", "step", "radius"),
    [
        (PLANE, 0.002, 2e-3, 0.8),
        (PLANE, 0.002, 5e-4, 0.8),
        (PLANE, 0.002, 2e-3, 0.0),
        (BALL, 0.0, 1e-3, 0.8),
        pytest.param(PLANE, 0.002, 5e-4, 0.0, marks=pytest.mark.long),
        pytest.param(BALL, 0.0, 2e-3, 0.0, marks=pytest.mark.long),
        pytest.param(BALL, 0.0, 5e-4, 0.8, marks=pytest.mark.long),
    ],
)
def test_an_impact_takes_energy_and_makes_none(moving, obstacle, d, step, radius):
    """The plate keeps little of its velocity. A step may make a hundredth of its energy, `simulation.MADE`."""
    rows = thrown(moving, obstacle, d, {"end": 0.03, "step": step, "spectral_radius": radius})
    force, lost = (np.array([row[name] for row in rows]) for name in ("contact_force", "lost"))
    scale = rows[0]["kinetic"]
    assert (force >= 0).all() and force.max() > 0.05
    assert (np.maximum.accumulate(lost) - lost).max() < 0.015 * scale
    assert 0.1 * scale < lost[-1] < scale


@pytest.mark.parametrize(("obstacle", "d"), [(PLANE, [[0.0, 0.004], [0.02, 0.003]]), (BALL, 0.002)])
@pytest.mark.parametrize("radius", [0.0, 0.8])
def test_momentum_changes_by_the_forces_of_clamp_and_contact_at_every_step(moving, obstacle, d, radius):
    """M (v1 - v0) / h + (1/2 - af) M (a1 - a0) summed along the obstacle's direction, see `generalised_alpha`."""
    scene, found = Scene.model_validate(moving | {"obstacle": obstacle}), []
    loads = {"F1": [[0.0, 0.0], [0.01, 4.0]], "d": d}
    motion = motion_of({"time": {"end": 0.03, "step": 1e-3, "spectral_radius": radius}, "loads": loads}, scene)
    simulation, af = Simulation(scene, motion), Scheme.of(radius).alpha_f
    problem, place = simulation.problem, simulation._stepper.place
    simulation.run(lambda row, moment: found.append((row, moment.state)))

    def clamp(state: MovingState) -> float:
        place(state, after=False)
        problem.contact.weigh(0.0)
        residual, reaction = problem.residual()
        residual.destroy()
        return reaction[1]

    def momentum(values: np.ndarray) -> float:
        return problem.copies * problem.times_mass(values).reshape(-1, 3)[:, 1].sum()

    forces, impacts = np.array([row["contact_force"] for row, _ in found]), 0
    for (_, before), (row, now) in pairwise(found):
        h = now.time - before.time
        change = momentum(now.velocity - before.velocity) / h
        change += (0.5 - af) * momentum(now.acceleration - before.acceleration)
        outer = (1 - af) * clamp(now) + af * clamp(before) - row["contact_force"]
        assert change == pytest.approx(outer, abs=1e-6 * forces.max())
        impacts += abs(now.impact) > 1e-3 * forces.max()
    assert impacts > 0 and forces.max() > 0.05


def test_the_impulse_of_an_impact_depends_little_on_the_step(moving):
    impulses = []
    for step in (2e-3, 1e-3, 5e-4):
        rows = thrown(moving, PLANE, 0.002, {"end": 0.02, "step": step})
        times, force = (np.array([row[name] for row in rows]) for name in ("time", "contact_force"))
        impulses.append(float(np.diff(times) @ force[1:]))
    assert np.ptp(impulses) < 0.15 * np.mean(impulses)  # 12 % between 1 ms and 0.5 ms


def test_at_rest_it_presses_as_its_equilibrium_does(moving):
    moving["obstacle"] = PLANE
    moving["material"]["prony"] = [[1.0, 0.02]]
    scene, rows = Scene.model_validate(moving), []
    loads = {"F1": [[0.0, 0.0], [0.05, 3.0]], "d": 0.004}
    time = {"end": 60.0, "step": 1.0, "spectral_radius": 0.0}
    Simulation(scene, motion_of({"time": time, "loads": loads}, scene)).run(lambda row, _: rows.append(row))
    state = FingerModel(scene).solve([3.0], 0.004, sensitivities=False)
    assert rows[-1]["contact_force"] == pytest.approx(state.contact_force, rel=1e-5) and state.contact_force > 0.05
    assert [rows[-1][name] for name in ("tip_x", "tip_y")] == pytest.approx(state.tip[:2], rel=1e-6)


def test_an_obstacle_that_moves_does_work_on_the_finger(moving):
    moving["obstacle"] = PLANE
    scene, rows = Scene.model_validate(moving), []
    loads = {"F1": 2.0, "d": [[0.0, 0.01], [0.2, 0.003]]}
    Simulation(scene, motion_of({"time": {"end": 0.2, "step": 2e-3}, "loads": loads}, scene)).run(
        lambda row, _: rows.append(row)
    )
    last, scale = rows[-1], max(row["strain"] for row in rows)
    assert last["obstacle"] > 0.01 * scale and -2e-3 * scale < last["lost"] < 0.05 * scale

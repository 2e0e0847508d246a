"""Wrenches that follow the plates: balance, Jacobian, and the same states as an obstacle that presses with them."""

import tomllib

import numpy as np
import pytest
from farm import ROOT

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene

TENSIONS = [40.0, 25.0]
WRENCH = np.array([[-0.6, -1.5, 0.8, 2e-3, -3e-3, 4e-3]])  # [N, N m]


def changed(pressed: bool, **parts) -> Scene:
    table = tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())
    if pressed:
        del table["obstacle"]
        table["load"] = {"force": 20.0}
    return Scene.model_validate(table | parts)


@pytest.fixture(scope="module")
def finger():
    return FingerModel(changed(pressed=True))


@pytest.fixture(scope="module")
def pressed(finger):
    return finger.solve(TENSIONS, wrenches=WRENCH)


def at(finger: FingerModel, state, tensions, wrench) -> tuple[np.ndarray, np.ndarray]:
    """Place and rotation of the plate near a state."""
    finger.take(state)
    finger.continuation.advance(tensions, None, wrench)
    (found,) = finger.problem.plates.poses(finger.problem.displacement)
    return found.centre, found.rotation


def test_the_clamp_reacts_to_what_presses_on_the_plate(finger, pressed):
    problem = finger.problem
    finger.take(pressed)
    (pose,) = problem.plates.poses(problem.displacement)
    force, moment = pose.rotation @ WRENCH[0, :3], pose.rotation @ WRENCH[0, 3:]
    assert pressed.clamp_reaction == pytest.approx(-force, abs=1e-8 * problem.force_scale)
    inner = problem.nodal(problem.forms.residual)  # of the finger alone: at the clamp, and against the wrench
    places = problem.space.tabulate_dof_coordinates() + problem.displacement.reshape(-1, 3)
    clamped = problem.space.tabulate_dof_coordinates()[:, 0] < 1e-12
    about_origin = np.cross(places[clamped], inner[clamped]).sum(axis=0)
    assert about_origin == pytest.approx(-moment - np.cross(pose.centre, force), abs=1e-8 * problem.force_scale * 0.05)
    assert pressed.stable is None and pressed.plate_rotations[0] == pytest.approx(pose.rotation)


def test_the_plate_stays_where_it_was_without_a_wrench(finger):
    free, same = FingerModel(changed(pressed=False)).solve(TENSIONS), finger.solve(TENSIONS)
    assert np.abs(free.displacement - same.displacement).max() < 1e-10
    assert same.plate_centres[0] == pytest.approx(free.tip + np.array([0.0495, 0, 0]), abs=1e-10)


def test_the_jacobian_by_tensions_and_wrench_is_exact(finger, pressed):
    assert pressed.plate_motion.shape == (8, 1, 6)
    steps = [1e-3] * 5 + [1e-5] * 3
    for k, h in enumerate(steps):
        unit = np.eye(8)[k]
        tensions, wrench = h * unit[:2], h * unit[None, 2:]
        (before, first), (after, last) = (
            at(finger, pressed, TENSIONS + sign * tensions, WRENCH + sign * wrench) for sign in (-1, 1)
        )
        rotation = pressed.plate_rotations[0]
        spin = rotation.T @ (last - first) / (2 * h)
        found = np.concatenate([rotation.T @ (after - before) / (2 * h), [spin[2, 1], spin[0, 2], spin[1, 0]]])
        assert pressed.plate_motion[k, 0] == pytest.approx(found, rel=1e-5, abs=1e-6 * np.abs(found).max())


def test_what_an_obstacle_presses_with_as_a_wrench_gives_the_state_it_makes(finger):
    """The plane touches the plate alone here, so its forces are a wrench on it."""
    touched = FingerModel(changed(pressed=False))
    state = touched.solve(TENSIONS, 0.012)
    assert state.contact_force > 0.5
    problem = touched.problem
    touched.take(state)
    forces = -problem.contact.nodal_force()  # on the finger
    rest = problem.space.tabulate_dof_coordinates()
    on_plate = rest[:, 0] > 0.049 - 1e-9
    assert np.abs(forces[~on_plate]).max() == 0.0
    places = rest + problem.displacement.reshape(-1, 3)
    plates = finger.problem.plates  # of the same mesh
    (pose,) = plates.poses(state.displacement)
    force, moment = forces.sum(axis=0), np.cross(places - pose.centre, forces).sum(axis=0)
    wrench = np.concatenate([pose.rotation.T @ force, pose.rotation.T @ moment])
    same = finger.solve(TENSIONS, wrenches=wrench[None])
    assert same.plate_centres[0] == pytest.approx(pose.centre, abs=3e-6)  # steel yields where it is pressed
    assert same.plate_rotations[0] == pytest.approx(pose.rotation, abs=3e-4)


def test_large_wrenches_that_no_dead_load_would_hold_are_solved(finger):
    state = finger.solve([100.0, 60.0], wrenches=[[-8.0, -12.0, 3.0, 0.0, 0.02, -0.03]])
    assert state.newton_iterations < 80 and np.abs(state.clamp_reaction).max() > 5
    residual, _ = finger.problem.residual()
    assert residual.norm() < 1e-8 * finger.problem.force_scale


@pytest.mark.parametrize(
    ("wrenches", "rule"),
    [
        (np.zeros((2, 6)), r"wrenches must be finite, shape \(1, 6\)"),
        (np.full((1, 6), np.nan), "wrenches must be fin"),
        ([[0, 21, 0, 0, 0, 0]], "up to load.force, 20 N, got 21"),
    ],
)
def test_wrenches_that_are_none_are_refused(finger, wrenches, rule):
    with pytest.raises(ValueError, match=rule):
        finger.solve(TENSIONS, wrenches=wrenches)


def test_a_load_is_no_obstacle_and_costs_nothing_where_it_is_not_named():
    plain = FingerModel(changed(pressed=False))
    assert plain.problem.plates is None and plain.problem.unsymmetric() is None
    with pytest.raises(ValueError, match="wrenches must be left out of a scene without a load"):
        plain.solve(TENSIONS, wrenches=WRENCH)
    with pytest.raises(ValueError, match="obstacle must be left out where load says what may press"):
        changed(pressed=False, load={"force": 5.0})
    with pytest.raises(ValueError, match=r"mesh.symmetry must be left out where load"):
        mesh = {"cells": [20, 5], "order": 1, "symmetry": True}
        changed(pressed=True, mesh=mesh, tendons=changed(pressed=True).model_dump()["tendons"][:1])

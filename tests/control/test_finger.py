"""One finger: what it is asked for it does, or says that it cannot."""

import numpy as np
import pytest

from control import Finger


@pytest.fixture(scope="module")
def finger(surrogate):
    return Finger(surrogate)


@pytest.mark.parametrize("tensions", [[30.0, 20.0], [80.0, 10.0], [5.0, 90.0], [100.0, 100.0]], ids=str)
def test_a_point_the_tip_can_reach_is_reached(finger, surrogate, tensions):
    goal = finger.rest + surrogate.evaluate([*tensions, np.inf]).tip
    motion = finger.reach(goal)
    assert motion.status == "converged" and motion.residual < 1e-4
    assert np.linalg.norm(finger.rest + surrogate.evaluate([*motion.tensions, np.inf]).tip - goal) < 1e-4


def test_a_point_out_of_reach_comes_back_flagged_with_the_nearest_answer(finger, surrogate):
    goal = np.array([0.0, 0.2, 0.0])
    motion = finger.reach(goal)
    assert motion.status == "unreachable"
    grid = np.array([[f1, f2, np.inf] for f1 in np.linspace(0, 100, 41) for f2 in np.linspace(0, 100, 41)])
    nearest = np.linalg.norm(finger.rest + surrogate.evaluate(grid).tip - goal, axis=1).min()
    assert motion.residual <= nearest + 1e-6


def test_a_point_out_of_reach_anywhere_comes_back_with_the_nearest_answer(finger, surrogate):
    grid = np.array([[f1, f2, np.inf] for f1 in np.linspace(0, 100, 31) for f2 in np.linspace(0, 100, 31)])
    tips = finger.rest + surrogate.evaluate(grid).tip
    for goal in np.random.default_rng(2).uniform(-0.06, 0.06, (60, 3)):
        motion = finger.reach(goal)
        assert motion.residual <= np.linalg.norm(tips - goal, axis=1).min() + 1e-5


def test_reaching_stays_before_the_plane(finger, surrogate):
    goal = finger.rest + surrogate.evaluate([60.0, 0.0, np.inf]).tip
    assert finger.reach(goal).converged
    motion = finger.reach(goal, distance=0.010)
    assert motion.status == "unreachable"
    assert 0.009 < surrogate.evaluate([*motion.tensions, np.inf]).touch_distance <= 0.010 + 1e-9


def test_no_reach_before_a_plane_ever_touches_it_and_is_called_converged(finger, surrogate):
    random = np.random.default_rng(4)
    for tensions, distance in zip(random.random((150, 2)) * 100, random.uniform(0.001, 0.03, 150), strict=True):
        goal = finger.rest + surrogate.evaluate([*tensions, np.inf]).tip
        motion = finger.reach(goal, distance=distance)
        if motion.converged:
            assert surrogate.evaluate([*motion.tensions, np.inf]).touch_distance <= distance
    assert finger.reach(finger.rest, distance=-0.001).status in ("unreachable", "out_of_domain")


@pytest.mark.parametrize("force", [0.05, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("distance", [0.002, 0.010, 0.018])
def test_a_force_is_held(finger, surrogate, force, distance):
    motion = finger.hold(force, distance)
    assert motion.status == "converged"
    assert surrogate.evaluate([*motion.tensions, distance]).contact_force == pytest.approx(force, abs=1e-5)
    assert motion.error == surrogate.evaluate([*motion.tensions, distance]).error["contact_force"]
    assert 0 < motion.error < 0.05 * force


def test_holding_starts_from_where_the_finger_is_and_moves_little(finger):
    first = finger.hold(1.0, 0.010)
    second = finger.hold(1.02, 0.010, start=first.tensions)
    assert second.converged and np.abs(second.tensions - first.tensions).max() < 1.0


def test_a_plane_a_little_farther_is_held_with_tensions_a_little_different(finger):
    # Beyond 23.5 mm the plate rolls over its face, where contact force falls with tension for a while: tensions jump.
    motions = [finger.hold(1.0, distance) for distance in np.linspace(0.002, 0.0235, 360)]
    assert {motion.status for motion in motions} == {"converged"}
    steps = np.abs(np.diff([motion.tensions for motion in motions], axis=0)).max(axis=1)
    assert steps.max() < 1.0  # [N] for 60 um


def test_a_start_far_from_touch_still_finds_the_force(finger):
    assert finger.hold(1.0, 0.020, start=[0.0, 0.0]).converged


@pytest.mark.parametrize(("force", "distance"), [(1.0, 0.0309), (500.0, 0.005)])
def test_a_force_that_cannot_be_held_is_flagged_with_the_nearest(finger, surrogate, force, distance):
    motion = finger.hold(force, distance)
    held = float(surrogate.evaluate([*motion.tensions, distance]).contact_force)
    assert motion.status == "unreachable" and motion.residual == pytest.approx(force - held)
    assert np.all(motion.tensions >= 0) and np.all(motion.tensions <= 100)
    if distance < 0.03:
        random = np.random.default_rng(1).random((300, 2)) * 100
        most = surrogate.evaluate(np.column_stack([random, np.full(300, distance)])).contact_force.max()
        assert force - motion.residual > 0.95 * most


@pytest.mark.parametrize("distance", [0.0015, 0.004, 0.010, 0.017])
@pytest.mark.parametrize("tensions", [[50.0, 0.0], [55.0, 35.0]], ids=str)
def test_the_plane_is_found_from_what_is_felt(finger, surrogate, tensions, distance):
    felt = float(surrogate.evaluate([*tensions, distance]).contact_force)
    assert felt > 0
    motion = finger.locate(tensions, felt)
    assert motion.status == "converged"
    assert motion.distance == pytest.approx(distance, abs=1e-7)


def test_a_force_no_plane_could_cause_is_flagged(finger):
    assert finger.locate([20.0, 0.0], 300.0).status == "unreachable"


def test_nothing_raises_for_a_hard_target(finger):
    nothing = [
        finger.reach([np.nan, 0.0, 0.0]),
        finger.reach([0.0, 0.0]),
        finger.reach([1e200, 0.0, 0.0]),
        finger.hold(1.0, 0.0),
        finger.hold(1.0, np.nan),
        finger.hold(np.nan, 0.01),
        finger.hold(-1.0, 0.01),
        finger.locate([500.0, 0.0], 1.0),
        finger.locate([50.0], 1.0),
        finger.locate([50.0, 0.0], 0.0),
    ]
    assert {motion.status for motion in nothing} == {"out_of_domain"}

"""One finger: what it is asked for it does, or says that it cannot."""

import numpy as np
import pytest

from control import Finger, Limits


def test_no_reach_before_a_plane_ever_touches_it_and_is_called_converged(finger):
    random = np.random.default_rng(4)
    for tensions, distance in zip(random.random((150, 2)) * 100, random.uniform(0.005, 0.03, 150), strict=True):
        goal = finger.rest + finger.model.evaluate([*tensions, np.inf]).tip
        motion = finger.reach(goal, distance=distance)
        if motion.converged:
            assert finger.model.evaluate([*motion.tensions, np.inf]).touch_distance <= distance
    assert finger.reach(finger.rest, distance=-0.001).status == "out_of_domain"


@pytest.mark.parametrize("force", [0.05, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("distance", [0.005, 0.0107, 0.018])
def test_a_force_is_held(finger, force, distance):
    motion = finger.hold(force, distance)
    assert motion.status == "converged"
    answer = finger.model.evaluate([*motion.tensions, distance])
    assert answer.contact_force == pytest.approx(force, abs=1e-5)
    assert motion.error == pytest.approx(answer.error["contact_force"], rel=1e-4) and motion.error > 0


def test_holding_starts_from_where_the_finger_is_and_moves_little(finger):
    first = finger.hold(1.0, 0.010)
    second = finger.hold(1.02, 0.010, start=first.tensions)
    assert second.converged and np.abs(second.tensions - first.tensions).max() < 1.0


def test_a_plane_a_little_farther_is_held_with_tensions_a_little_different(rod_finger):
    # Beyond 23.5 mm the plate rolls over its face, where contact force falls with tension for a while: tensions jump.
    motions = [rod_finger.hold(1.0, distance) for distance in np.linspace(0.002, 0.0235, 360)]
    assert {motion.status for motion in motions} == {"converged"}
    steps = np.abs(np.diff([motion.tensions for motion in motions], axis=0)).max(axis=1)
    assert steps.max() < 1.0  # [N] for 60 um


@pytest.mark.parametrize(("force", "distance"), [(1.0, 0.0309), (500.0, 0.005)])
def test_a_force_that_cannot_be_held_is_flagged_with_the_nearest(finger, force, distance):
    motion = finger.hold(force, distance)
    held = float(finger.model.evaluate([*motion.tensions, distance]).contact_force)
    assert motion.status == "unreachable" and motion.residual == pytest.approx(force - held)
    assert np.all(motion.tensions >= 0) and np.all(motion.tensions <= 100)
    if distance < 0.03:
        random = np.random.default_rng(1).random((300, 2)) * 100
        most = finger.model.evaluate(np.column_stack([random, np.full(300, distance)])).contact_force.max()
        assert force - motion.residual > 0.95 * most


@pytest.mark.parametrize("distance", [0.0045, 0.0103, 0.017])
@pytest.mark.parametrize("tensions", [[50.0, 0.0], [55.0, 35.0]], ids=str)
def test_the_plane_is_found_from_what_is_felt(finger, tensions, distance):
    felt = float(finger.model.evaluate([*tensions, distance]).contact_force)
    assert felt > 0
    motion = finger.locate(tensions, felt)
    assert motion.status == "converged"
    assert motion.distance == pytest.approx(distance, abs=1e-7)


def test_a_force_no_plane_could_cause_is_flagged(finger):
    assert finger.locate([20.0, 0.0], 300.0).status == "unreachable"


# -- sides, limits, paths, deviations --------------------------------------------------------------------------------


@pytest.mark.parametrize("sides", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_the_other_sides_are_reached_by_mirror_images_of_the_tendons(finger, sides):
    goal = finger.rest + finger.model.evaluate([60.0, 40.0, np.inf]).tip * [1, *sides]
    motion = finger.reach(goal)
    assert motion.converged and motion.sides == sides
    assert motion.tensions == pytest.approx([60.0, 40.0], abs=0.5)


def test_before_a_plane_only_the_sides_along_it_are_mirror_images(finger):
    tip = finger.model.evaluate([30.0, 40.0, np.inf]).tip
    assert finger.reach(finger.rest + tip * [1, 1, -1], distance=0.030).sides == (1, -1)
    away = finger.reach(finger.rest + tip * [1, -1, 1], distance=0.030)
    assert away.sides == (1, 1) and away.status == "unreachable"


def test_limits_are_kept_and_make_targets_unreachable(table):
    narrow = Finger(table, Limits(lower=[2.0, 0.0], upper=[40.0, 10.0]))
    goal = narrow.rest + table.evaluate([60.0, 40.0, np.inf]).tip
    for motion in (narrow.reach(goal), narrow.hold(1.0, 0.020), narrow.hold(0.5, 0.010), narrow.hold(9.0, 0.005)):
        assert np.all(motion.tensions >= [2.0, 0.0]) and np.all(motion.tensions <= [40.0, 10.0])
    assert narrow.reach(goal).status == narrow.hold(1.0, 0.020).status == "unreachable"
    assert narrow.hold(0.5, 0.010).converged
    with pytest.raises(ValueError, match="limits must leave some of the trained tensions"):
        Finger(table, Limits(lower=200.0))
    with pytest.raises(ValueError, match=r"limits\.upper must be one number or 2, got \[1\.0, 2\.0, 3\.0\]"):
        Finger(table, Limits(upper=[1.0, 2.0, 3.0]))


def test_a_path_is_followed_within_the_rate_and_across_the_sides(table):
    finger = Finger(table, Limits(rate=400.0))
    angles = np.linspace(0, 2 * np.pi, 200)
    turning = [table.evaluate([45 * abs(np.cos(a)), 45 * abs(np.sin(a)), np.inf]).tip for a in angles]
    signs = [[1, np.sign(np.cos(a)) or 1, np.sign(np.sin(a)) or 1] for a in angles]
    path = [finger.rest + tip * sign for tip, sign in zip(turning, signs, strict=True)]
    motions = finger.follow(path, period=0.01, start=[45.0, 0.0])
    signed = np.array([motion.tensions * motion.sides for motion in motions])
    assert np.abs(np.diff(signed, axis=0)).max() <= 2 * 4.0  # [N] a period; from one side to the other through slack
    assert np.abs(np.diff(np.abs(signed), axis=0)).max() <= 4.0 + 1e-9
    assert {motion.sides for motion in motions} == {(1, 1), (1, -1), (-1, 1), (-1, -1)}
    assert np.mean([motion.converged for motion in motions]) > 0.95
    assert max(motion.residual for motion in motions) < 1e-3


def test_a_point_too_far_for_one_period_is_approached(table):
    finger = Finger(table, Limits(rate=100.0))
    goal = finger.rest + table.evaluate([60.0, 20.0, np.inf]).tip
    motions = finger.follow([goal] * 80, period=0.01)
    assert motions[0].status == "unreachable" and motions[0].tensions.max() <= 1.0 + 1e-9
    assert motions[-1].converged
    lost = finger.follow([goal, [np.nan] * 3, goal], period=0.01)
    assert [motion.status for motion in lost] == ["unreachable", "out_of_domain", "unreachable"]
    assert np.array_equal(lost[1].tensions, lost[0].tensions)
    with pytest.raises(ValueError, match="period must be above 0 s, got 0"):
        finger.follow([goal], period=0.0)


@pytest.mark.parametrize(("tensions", "distance"), [([50.0, 5.0], 0.012), ([70.0, 40.0], 0.006)])
def test_the_deviation_of_a_plane_is_what_noise_makes_of_it(rod_finger, tensions, distance):
    random, noise = np.random.default_rng(8), 0.05  # [N], far above the model's error
    true = float(rod_finger.model.evaluate([*tensions, distance]).contact_force)
    found = [rod_finger.locate(tensions, true + noise * random.standard_normal(), noise=noise) for _ in range(400)]
    assert np.std([motion.distance for motion in found]) == pytest.approx(found[0].deviation, rel=0.15)


def test_many_readings_make_a_plane_better_known(finger):
    random, noise, distance = np.random.default_rng(9), 0.03, 0.010
    tensions = np.column_stack([np.linspace(35, 60, 25), np.full(25, 10.0)])
    true = finger.model.evaluate(np.column_stack([tensions, np.full(25, distance)])).contact_force
    errors, deviations = [], []
    for _ in range(100):
        motion = finger.locate(tensions, true + noise * random.standard_normal(25), noise=noise)
        assert motion.status == "converged"
        errors.append(motion.distance - distance)
        deviations.append(motion.deviation)
    one = finger.locate(tensions[10], true[10], noise=noise).deviation
    assert np.std(errors) < 0.3 * one and np.std(errors) < 1.3 * np.mean(deviations)
    assert finger.locate(tensions, true[::-1], noise=noise).status == "unreachable"  # no plane feels like that


def contour(model, force, distance):
    """Tensions that press with a force, shape (n, 2) [N]: between neighbours along F1 of a grid, of linear answers."""
    axis = np.linspace(0, 100, 101)
    f2, f1 = np.meshgrid(axis, axis)
    points = np.column_stack([f1.ravel(), f2.ravel(), np.full(f1.size, distance)])
    more = model.evaluate(points).contact_force.reshape(f1.shape) - force
    i, k = np.nonzero(more[:-1] * more[1:] < 0)
    share = more[i, k] / (more[i, k] - more[i + 1, k])
    return np.column_stack([axis[i] + share, axis[k]])


def test_of_the_tensions_that_hold_those_near_the_present_are_taken(rod_finger):
    random, far = np.random.default_rng(3), []
    for distance in (0.006, 0.012):
        known = contour(rod_finger.model, 2.0, distance)
        for start in random.uniform(0, 100, (40, 2)):
            motion = rod_finger.hold(2.0, distance, start=start)
            assert motion.converged
            far.append(np.linalg.norm(motion.tensions - start) / np.linalg.norm(known - start, axis=1).min())
    assert np.median(far) < 1.01 and np.mean(np.array(far) < 1.05) > 0.9


def test_a_goal_just_within_the_plane_is_reached_without_touching_it(finger):
    random = np.random.default_rng(6)
    for tensions, inside in zip(random.uniform([25, 5], 95, (150, 2)), random.uniform(0, 3e-5, 150), strict=True):
        free = finger.model.evaluate([*tensions, np.inf])
        distance = float(free.touch_distance) - inside
        motion = finger.reach(finger.rest + free.tip, distance, start=tensions)
        assert finger.model.evaluate([*motion.tensions, np.inf]).touch_distance <= distance
        less = np.column_stack([np.linspace(0.9, 1, 201)[:, None] * tensions, np.full(201, np.inf)])
        ways = finger.model.evaluate(less)
        before = ways.touch_distance <= distance
        nearest = np.linalg.norm(ways.tip[before] - free.tip, axis=1).min()
        assert motion.converged or nearest > 0.9e-4
        assert motion.residual <= max(1e-4, 1.3 * nearest)


def test_a_plane_is_not_located_where_nothing_could_be_felt(finger):
    motion = finger.locate([[0.0, 0.0], [0.0, 0.0]], [50.0, 50.0])
    assert motion.status == "unreachable" and motion.residual == pytest.approx(50.0, rel=0.01)


def test_readings_in_any_memory_order_locate_the_same_plane(table):
    finger, tensions = Finger(table), np.array([[60.0, 10.0], [70.0, 20.0], [80.0, 15.0]])
    felt = table.evaluate(np.column_stack([tensions, np.full(3, 0.012)])).contact_force
    plain, turned = finger.locate(tensions, felt), finger.locate(np.asfortranarray(tensions), felt)
    assert plain.distance == turned.distance == pytest.approx(0.012, abs=1e-8)

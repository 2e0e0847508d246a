"""A path is moved in front of the surface, to which its speed falls to zero; it presses with a limited depth."""

from dataclasses import replace

import numpy as np
import pytest

import rom
from control import TrackingOptions
from control.tracking import circle
from control.tracking.inverse import inverse
from control.tracking.surface import PRESS, approached, limited, projected

PERIOD, BOUNDS, PRETENSION = 5e-3, (np.zeros(2), np.full(2, 100.0)), np.full(2, 5.0)
OPTIONS = TrackingOptions(period=PERIOD, density=1100.0, distance=0.010, most_force=0.4, approach=1e-6)
PATH = circle([0.010, 0.010], 0.004, 4.0, PERIOD, 1.5)


@pytest.fixture(scope="module")
def finger():
    return rom.load()


def test_an_approach_is_twice_smooth_and_ends_at_the_surface_without_speed():
    gaps = np.linspace(3.0, -3.0, 6001)
    found = approached(gaps, 1.0)
    assert found[gaps >= 1] == pytest.approx(gaps[gaps >= 1])
    assert found[gaps <= -1] == pytest.approx(0.0, abs=1e-12)
    slopes = np.diff(found) / np.diff(gaps)
    assert slopes.min() >= -1e-9 and np.abs(np.diff(slopes)).max() <= 1.01e-3  # the largest curvature is 1 / length


def test_a_depth_rises_like_the_path_and_stays_at_its_limit():
    depth = np.linspace(0.0, 5.0, 101)
    assert limited(depth, np.full(101, np.inf)) == pytest.approx(depth)
    found = limited(depth, np.ones(101))
    assert found[1] == pytest.approx(depth[1], rel=0.05)
    assert found[depth >= 2] == pytest.approx(1.0)


def test_tensions_of_the_projected_path_press_with_the_force_and_leave_the_tip_there(finger):
    found, deep = projected(finger, PATH, PRETENSION, BOUNDS, OPTIONS), int(np.argmax(PATH[:, 0]))
    assert found.tips[0] == pytest.approx(PATH[0])
    assert found.tips[deep, 0] < PATH[deep, 0] - 1e-3
    goal = found.approached[deep] + found.pressed[deep]
    answer = finger.evaluate([*inverse(finger, goal, PRETENSION, PRETENSION, BOUNDS), OPTIONS.distance])
    assert answer.contact_force == pytest.approx(PRESS * OPTIONS.most_force, rel=0.05)
    assert answer.tip[1:] == pytest.approx(found.tips[deep], abs=3e-5)


def test_a_slow_approach_leaves_the_path_before_the_surface_and_without_an_object_it_stays(finger):
    fast, slow = (projected(finger, PATH, PRETENSION, BOUNDS, replace(OPTIONS, approach=t)) for t in (1e-6, 0.02))
    assert slow.approached[:, 0].max() <= fast.tips[:, 0].max() + 1e-6
    assert np.abs(np.diff(slow.approached[:, 0], 2)).max() < 0.5 * np.abs(np.diff(fast.approached[:, 0], 2)).max()
    free = projected(finger, PATH, PRETENSION, BOUNDS, replace(OPTIONS, distance=np.inf))
    assert np.array_equal(free.approached, PATH) and not free.pressed.any()

"""The number of fingers that a solid is grasped with."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from control import Gripper
from control.mujoco.layouts import FINGERS, HEIGHTS, LOWEST, best_layout
from control.mujoco.solids import random_solid


@pytest.mark.parametrize("shape", ["box", "cone"])
def test_the_layout_leaves_most_room_between_dropping_and_crushing(model, shape):
    solid, rooms = random_solid(np.random.default_rng(3), shape), {}
    for fingers in FINGERS:
        gripper = Gripper(model, fingers)
        held = solid.turned(solid.best_turn(gripper.directions)).held(gripper.directions)
        targets = gripper.targets(held)
        rooms[fingers] = targets.most / targets.least
    best = best_layout(model, solid)
    assert best.room == pytest.approx(max(rooms.values())) and max(rooms.values()) > min(rooms.values())
    assert rooms[len(best.gripper.fingers)] == max(rooms.values())


def test_a_ball_is_grasped_at_the_height_that_leaves_most_room(model):
    ball = random_solid(np.random.default_rng(3), "sphere")
    best, rooms = best_layout(model, ball), []
    for added in HEIGHTS:
        one = replace(ball, grasped=ball.grasped + added)
        held = one.turned(best.turn).held(best.gripper.directions)
        rooms.append(best.gripper.targets(held).most / best.gripper.targets(held).least)
    assert best.solid.grasped >= LOWEST and best.room >= 0.99 * max(rooms) > 1.1 * min(rooms)


def test_a_box_is_no_matter_for_three_fingers(model):
    random = np.random.default_rng(4)
    for _ in range(3):
        assert len(best_layout(model, random_solid(random, "box")).gripper.fingers) in (2, 4)

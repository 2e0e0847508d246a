"""Random solids, and the faces that fingers meet: against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco")

from control.grasping.grasp_forces import GRAVITY, targets
from control.mujoco.solids import BELOW, POSE_ERROR, SHAPES, random_solid

ANGLES = 2 * np.pi * np.arange(3) / 3
THREE = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])


@pytest.mark.parametrize("shape", SHAPES)
def test_it_stands_where_it_is_grasped_and_is_the_same_for_a_seed(shape):
    solid, again = (random_solid(np.random.default_rng(7), shape) for _ in range(2))
    assert np.array_equal(solid.corners, again.corners) and solid.mass == again.mass
    assert solid.corners[:, 2].min() == pytest.approx(0.0, abs=1e-4)
    assert 0 < solid.grasped < solid.corners[:, 2].max()
    assert 0.01 <= solid.mass <= 0.3 and 0.3 <= solid.friction <= 1.0


def rises(solid) -> np.ndarray:
    """Angles by which the touched faces' inward normals rise above the horizontal, shape (samples, 3) [rad]."""
    return np.arcsin(-solid.faces(THREE)[:, :, 0])


def test_a_cylinder_s_faces_are_upright_and_a_cone_s_fall_as_much_as_it_narrows():
    cylinder, cone = (random_solid(np.random.default_rng(1), shape) for shape in ("cylinder", "cone"))
    assert np.abs(rises(cylinder)).max() < 1e-6
    foot, top = (
        np.linalg.norm(cone.corners[cone.corners[:, 2] == z, :2], axis=1).max() for z in (0, cone.corners[:, 2].max())
    )
    slope = np.arctan((foot - top) / cone.corners[:, 2].max())
    assert rises(cone) == pytest.approx(np.full((50, 3), -slope), rel=5e-3)


def test_a_ball_s_faces_rise_below_its_centre_and_fall_above():
    ball = random_solid(np.random.default_rng(2), "sphere")
    low, high = (np.arcsin((BELOW + sign * POSE_ERROR) / ball.radius) for sign in (-1, 1))
    assert low - 0.04 <= rises(ball).min() < 0 < np.arcsin(BELOW / ball.radius) < rises(ball).max() <= high + 0.04
    low, high = (rises(replace(ball, grasped=ball.radius + above)).mean() for above in (-0.004, 0.004))
    assert high < 0 < low


def test_a_finger_that_passes_a_solid_by_meets_a_face_that_carries_nothing():
    ball = random_solid(np.random.default_rng(2), "sphere")
    assert (replace(ball, grasped=3 * ball.radius).faces(THREE) == [1.0, 0.0, 0.0]).all()


def test_half_widths_are_those_of_the_faces_that_plates_touch():
    box, cone, ball = (random_solid(np.random.default_rng(2), shape) for shape in ("box", "cone", "sphere"))
    along = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    assert box.half_widths(along) == pytest.approx([box.size[0], box.size[1], box.size[0]], rel=1e-9)
    assert box.turned(np.pi / 2).half_widths(along) == pytest.approx([box.size[1], box.size[0], box.size[1]], rel=1e-9)
    assert cone.half_widths(THREE) == pytest.approx(np.full(3, cone.radius), rel=3e-3)
    aside = replace(ball, corners=np.add(ball.corners, [0.001, 0.0, 0.0]))
    assert aside.half_widths(along)[[0, 2]] - ball.half_widths(along)[[0, 2]] == pytest.approx([0.001, -0.001])
    assert (replace(ball, grasped=3 * ball.radius).half_widths(THREE) == -np.inf).all()


def test_a_box_tips_over_its_nearer_edge_and_a_solid_on_its_corner_falls():
    box, ball = (random_solid(np.random.default_rng(4), shape) for shape in ("box", "sphere"))
    assert box.tipping_force == pytest.approx(box.mass * GRAVITY * min(box.size[:2]) / box.grasped)
    assert ball.tipping_force == np.inf
    meshes = [random_solid(np.random.default_rng(seed), "mesh") for seed in range(10)]
    assert 0 < sum(mesh.tipping_force > 0 for mesh in meshes) < 10
    assert replace(box, corners=box.corners[:-1] + np.array([0.0, 0.0, 0.001])).tipping_force == 0


def test_a_box_is_turned_so_that_fingers_have_most_room():
    box = random_solid(np.random.default_rng(3), "box")
    rooms = [box.turned(turn).room(THREE) for turn in np.radians(np.arange(0, 120, 10))]
    assert box.turned(box.best_turn(THREE)).room(THREE) == pytest.approx(max(rooms), abs=1e-9)
    assert max(rooms) > min(rooms) + 0.2


@pytest.mark.parametrize("shape", ["cylinder", "cone"])
def test_the_estimated_room_is_that_of_the_balance_where_faces_lean_up_or_down_alone(shape):
    solid = random_solid(np.random.default_rng(1), shape)
    found = targets(THREE, solid.held(THREE))
    assert solid.room(THREE) == pytest.approx(found.most / found.least, rel=0.01)


@pytest.mark.parametrize("shape", SHAPES)
def test_no_layout_carries_more_than_the_bound_of_its_faces(shape):
    solid = replace(random_solid(np.random.default_rng(5), shape), admissible_force=1e3)
    least = targets(THREE, solid.held(THREE)).least
    assert 3 * solid.capacity * least >= solid.mass * GRAVITY * (1 - 1e-9)
    if shape in ("box", "cylinder"):
        assert solid.capacity == pytest.approx(solid.friction)


def test_there_is_no_torus():
    with pytest.raises(ValueError, match="shape must be one of box, sphere"):
        random_solid(np.random.default_rng(0), "torus")

"""Random solids, and how much the faces lean that fingers meet: against closed forms."""

import numpy as np
import pytest

pytest.importorskip("mujoco")

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


def test_a_cylinder_s_faces_do_not_lean_and_a_cone_s_as_much_as_it_narrows():
    cylinder, cone = (random_solid(np.random.default_rng(1), shape) for shape in ("cylinder", "cone"))
    assert cylinder.lean(THREE) < 1e-6
    foot, top = (
        np.linalg.norm(cone.corners[cone.corners[:, 2] == z, :2], axis=1).max() for z in (0, cone.corners[:, 2].max())
    )
    slope = np.arctan((foot - top) / cone.corners[:, 2].max())
    assert cone.lean(THREE) == pytest.approx(slope, rel=5e-3)


def test_a_ball_leans_as_far_as_its_pose_may_be_off():
    ball = random_solid(np.random.default_rng(2), "sphere")
    assert np.arcsin(BELOW / ball.radius) < ball.lean(THREE) <= np.arcsin((POSE_ERROR + BELOW) / ball.radius) + 0.04


def test_a_box_is_turned_so_that_its_faces_lean_least():
    box = random_solid(np.random.default_rng(3), "box")
    leans = [box.turned(turn).lean(THREE, samples=24) for turn in np.radians(np.arange(0, 120, 10))]
    assert box.turned(box.best_turn(THREE)).lean(THREE, samples=24) == pytest.approx(min(leans), abs=1e-9)
    assert max(leans) > min(leans) + 0.2


def test_there_is_no_torus():
    with pytest.raises(ValueError, match="shape must be one of box, sphere"):
        random_solid(np.random.default_rng(0), "torus")

"""The rigid motion of a plate by its two moments, and what wrenches in its frame do work on."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fingerfem.mechanics import rigid_plate

RANDOM = np.random.default_rng(3)
TURNED = Rotation.from_rotvec([0.4, -0.8, 1.1]).as_matrix()
STRETCH = np.diag([1.0, 2.0, 3.0]) + 0.1 * np.ones((3, 3))
AT = rigid_plate.pose(np.array([0.04, 0.02, 0.01]), TURNED @ STRETCH)
WRENCH = RANDOM.standard_normal(6)


def test_the_rotation_and_the_stretch_are_those_of_the_polar_decomposition():
    assert AT.rotation == pytest.approx(TURNED, abs=1e-14)
    assert AT.stretch == pytest.approx(STRETCH, abs=1e-13)
    assert AT.rotation @ AT.clamp == pytest.approx(-AT.centre)


def test_gradients_of_the_rotation_are_differences():
    change, h = RANDOM.standard_normal((3, 3)), 1e-6
    near = [rigid_plate.pose(AT.centre, TURNED @ STRETCH + sign * h * change).rotation for sign in (-1, 1)]
    spin = AT.rotation.T @ (near[1] - near[0]) / (2 * h)
    angles = [np.sum(gradient * change) for gradient in rigid_plate.rotation_gradients(AT)]
    assert rigid_plate.cross(np.array(angles)) == pytest.approx(spin, abs=1e-9)


def test_a_wrench_does_the_work_of_its_force_and_moment():
    on_centre, on_moment = rigid_plate.generalised_forces(AT, WRENCH)
    change = RANDOM.standard_normal((3, 3))
    turned = [np.sum(gradient * change) for gradient in rigid_plate.rotation_gradients(AT)]
    assert np.sum(on_moment * change) == pytest.approx(WRENCH[3:] @ turned)
    assert AT.rotation.T @ on_centre == pytest.approx(WRENCH[:3])


def test_following_forces_change_as_the_plate_turns():
    for axis, change in zip(np.eye(3), rigid_plate.changes_with_rotation(AT, WRENCH), strict=True):
        near = []
        for h in (-1e-6, 1e-6):
            turn = TURNED @ Rotation.from_rotvec(h * axis).as_matrix()
            near.append(rigid_plate.generalised_forces(rigid_plate.pose(AT.centre, turn @ STRETCH), WRENCH))
        for part in (0, 1):
            assert (near[1][part] - near[0][part]) / 2e-6 == pytest.approx(change[part], abs=1e-8)


def test_the_clamp_and_the_quaternion_seen_from_the_plate_change_as_it_moves():
    motion, h = RANDOM.standard_normal(6), 1e-6
    near = []
    for step in (-h, h):
        turn = TURNED @ Rotation.from_rotvec(step * motion[3:]).as_matrix()
        near.append(rigid_plate.pose(AT.centre + step * TURNED @ motion[:3], turn @ STRETCH))
    assert (near[1].clamp - near[0].clamp) / (2 * h) == pytest.approx(AT.clamp_change(motion), abs=1e-8)
    assert (near[1].quaternion - near[0].quaternion) / (2 * h) == pytest.approx(AT.quaternion_change(motion), abs=1e-8)
    assert Rotation.from_quat(AT.quaternion, scalar_first=True).as_matrix() == pytest.approx(AT.rotation)

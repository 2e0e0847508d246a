"""A plate moves as the rigid body nearest to what was predicted."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fingerfem.equilibrium.rigid_plates import Plate

POINTS = np.array([[x, y, z] for x in (0.049, 0.05) for y in (-0.005, 0.0, 0.005) for z in (-0.005, 0.005)])
ALL = np.arange(len(POINTS))


def plate() -> Plate:
    return Plate(MPI.COMM_SELF, ALL, np.ones(len(ALL), bool), POINTS, np.array([0.0, 1.0, 0.0]), mirrored=False)


def moved(rotation: Rotation, shift) -> np.ndarray:
    return rotation.apply(POINTS) + shift - POINTS


def test_a_rigid_motion_is_left_as_it_is():
    before = moved(Rotation.from_rotvec([0.1, -0.2, 0.5]), [0.01, 0.0, -0.02])
    after = moved(Rotation.from_rotvec([0.0, 0.3, 0.9]), [0.0, 0.02, 0.01])
    result = after.copy()
    plate().move_rigidly(before, result)
    assert result == pytest.approx(after, abs=1e-15)


def test_a_linearised_rotation_becomes_a_rotation_that_reaches_as_far():
    before = np.zeros_like(POINTS)
    linear = np.cross([0.0, 0.0, 0.4], POINTS - POINTS.mean(axis=0))
    result = linear.copy()
    plate().move_rigidly(before, result)
    distances = [np.linalg.norm((POINTS + u)[:, None] - (POINTS + u)[None], axis=2) for u in (before, result)]
    assert distances[1] == pytest.approx(distances[0], abs=1e-15)
    assert (POINTS + result)[:, 1].max() == pytest.approx((POINTS + linear)[:, 1].max(), abs=1e-15)


def test_what_strain_a_plate_has_it_keeps():
    """Only the step is made rigid: a plate in equilibrium is not pulled out of it."""
    strained = 1e-5 * np.random.default_rng(0).standard_normal(POINTS.shape)
    result = strained.copy()
    plate().move_rigidly(strained, result)
    assert result == pytest.approx(strained, abs=1e-15)

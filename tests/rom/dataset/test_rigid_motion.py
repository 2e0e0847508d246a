"""Small motions of poses and nearest rotations: differences, polar decompositions, and invariance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from rom.dataset.rigid_motion import motions, nearest_rotations, quaternion_changes, quaternions, rotations, turns

SEEDS = st.integers(0, 10_000)
STEP = 1e-6


def random_turns(random, n: int) -> np.ndarray:
    return Rotation.from_rotvec(random.uniform(-3, 3, (n, 3)) / 2).as_matrix()


def poses(centres: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """-R^T c and the quaternion of R, as they are defined."""
    places = -np.einsum("nji,nj->ni", turned, centres)
    return np.concatenate([places, Rotation.from_matrix(turned).as_quat(scalar_first=True)], axis=1)


@given(SEEDS, st.floats(0.5, 2.0))
def test_motions_are_recovered_from_changes_of_poses(seed, size):
    """Also of quaternions that are no unit vectors, with changes of any length."""
    random = np.random.default_rng(seed)
    centres, turned = random.standard_normal((6, 3)), random_turns(random, 6)
    move, turn = random.standard_normal((2, 6, 3))
    ends = []
    for sign in (1, -1):
        away = centres + sign * STEP * np.einsum("nij,nj->ni", turned, move)
        ends.append(poses(away, turned @ Rotation.from_rotvec(sign * STEP * turn).as_matrix()))
    here, change = poses(centres, turned), (ends[0] - ends[1])[..., None] / (2 * STEP)
    here[:, 3:] *= size
    change[:, 3:] *= size
    found = motions(here, change)[..., 0]
    assert found == pytest.approx(np.concatenate([move, turn], axis=1), abs=1e-6)
    assert rotations(here) == pytest.approx(turned, abs=1e-12)


@given(SEEDS)
def test_the_nearest_rotation_is_that_of_the_polar_decomposition_and_never_a_reflection(seed):
    random = np.random.default_rng(seed)
    moments = random.standard_normal((2, 5, 3, 3))
    turned, stretches = nearest_rotations(moments)
    assert turned @ stretches == pytest.approx(moments, abs=1e-12)
    assert stretches == pytest.approx(np.swapaxes(stretches, -1, -2), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(np.ones((2, 5)))
    for one, found in zip(moments.reshape(-1, 3, 3), turned.reshape(-1, 3, 3), strict=True):
        if np.linalg.det(one) > 1e-3:
            assert found == pytest.approx(polar(one)[0], abs=1e-6)


@given(SEEDS)
def test_of_a_flat_body_the_rotation_is_the_one_it_was_turned_by(seed):
    """A section's corners lie in a plane: their moment has rank 2."""
    random = np.random.default_rng(seed)
    turn = random_turns(random, 4)
    found, _ = nearest_rotations(turn @ np.diag([0.0, 2.0, 3.0]))
    assert found == pytest.approx(turn, abs=1e-9)


@given(SEEDS)
def test_turns_are_differences_of_the_nearest_rotations(seed):
    random = np.random.default_rng(seed)
    moments = random_turns(random, 5) @ (np.diag([1.0, 2.0, 3.0]) + 0.1 * random.standard_normal((5, 3, 3)))
    changes = random.standard_normal((5, 3, 3))
    turned, stretches = nearest_rotations(moments)
    after, before = (nearest_rotations(moments + sign * STEP * changes)[0] for sign in (1, -1))
    skew = np.swapaxes(turned, -1, -2) @ (after - before) / (2 * STEP)
    expected = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    assert turns(turned, stretches, changes) == pytest.approx(expected, abs=1e-6)


@given(SEEDS)
def test_quaternions_change_with_turns_as_differences_do_and_stay_unit_vectors(seed):
    random = np.random.default_rng(seed)
    turned, turn = random_turns(random, 6), random.standard_normal((6, 3))
    here = quaternions(turned)
    assert (here[:, 0] >= 0).all() and rotations(np.hstack([turn, here])) == pytest.approx(turned, abs=1e-12)
    after, before = (quaternions(turned @ Rotation.from_rotvec(s * STEP * turn).as_matrix()) for s in (1, -1))
    found = quaternion_changes(here, turn)
    assert found == pytest.approx((after - before) / (2 * STEP), abs=1e-6)
    assert np.sum(found * here, axis=1) == pytest.approx(np.zeros(6), abs=1e-12)
    assert quaternions(turned.reshape(2, 3, 3, 3)).shape == (2, 3, 4)

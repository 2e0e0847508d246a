"""Rodrigues vectors: the same rotations as SciPy's, and changes that are their derivatives."""

import numpy as np
from scipy.spatial.transform import Rotation

from rom.elements import rotation_vectors

RANDOM = np.random.default_rng(3)
VECTORS = RANDOM.uniform(-0.5, 0.5, (20, 3))


def test_a_vector_and_its_matrix_are_each_others_inverse_and_scipys():
    angles = 2 * np.arctan(np.linalg.norm(VECTORS, axis=1, keepdims=True))
    wanted = Rotation.from_rotvec(angles * VECTORS / np.linalg.norm(VECTORS, axis=1, keepdims=True)).as_matrix()
    np.testing.assert_allclose(rotation_vectors.matrices(VECTORS), wanted, atol=1e-15)
    np.testing.assert_allclose(rotation_vectors.vectors(wanted), VECTORS, atol=1e-15)


def test_changes_with_small_turns_are_derivatives_and_turns_are_their_inverse():
    turns = RANDOM.uniform(-1, 1, (20, 3, 4))
    changes = rotation_vectors.changes(VECTORS, turns)
    np.testing.assert_allclose(rotation_vectors.turns(VECTORS, changes), turns, atol=1e-14)
    h, matrices = 1e-6, rotation_vectors.matrices(VECTORS)
    for k in range(4):
        after, before = (
            rotation_vectors.vectors(Rotation.from_rotvec(sign * h * turns[:, :, k]).as_matrix() @ matrices)
            for sign in (1, -1)
        )
        np.testing.assert_allclose(changes[:, :, k], (after - before) / (2 * h), atol=1e-9)

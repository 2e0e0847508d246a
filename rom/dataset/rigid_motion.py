"""Poses of plates and cross-sections, and their small motions in their own frames; and how a base moves.

With a plate's centre c and rotation R, its pose is q = -R^T c [m] and the unit quaternion r of R. A motion is
v = R^T dc [m] and the turn t = R^T dtheta [rad]: dq = q x t - v, and t = 2 vec(r* dr).

The rotation nearest to a body's motion is that of the polar decomposition of its moment M = R U, which turns by

    t = (tr U 1 - U)^-1 k(R^T dM),    k(A) = (A32 - A23, A13 - A31, A21 - A12).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from rom.brief import brief


@brief
class BaseMotion(NamedTuple):
    """Motion of the base in its own axes: acceleration [m/s^2], angular velocity [rad/s] and its rate [rad/s^2]."""

    acceleration: np.ndarray
    spin: np.ndarray
    spin_rate: np.ndarray


def rotations(poses: np.ndarray) -> np.ndarray:
    """Rotation matrices of poses, shapes (n, 7), (n, 3, 3) [-]."""
    return np.asarray(Rotation.from_quat(poses[:, [4, 5, 6, 3]]).as_matrix()).reshape(-1, 3, 3)


def motions(poses: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Motions of plates, shape (n, 6, k) [m, rad], by changes of their poses, shape (n, 7, k)."""
    size = np.linalg.norm(poses[:, 3:], axis=1)[:, None, None]
    scalar, vector = poses[:, 3, None, None] / size, poses[:, 4:, None] / size
    along, turning = changes[:, 3:4] / size, changes[:, 4:] / size
    turn = 2 * (scalar * turning - along * vector - np.cross(vector, turning, axis=1))
    move = np.cross(poses[:, :3, None], turn, axis=1) - changes[:, :3]
    return np.concatenate([move, turn], axis=1)


def nearest_rotations(moments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations R [-] and symmetric U of the polar decompositions M = R U, shapes (..., 3, 3).

    R is a rotation, never a reflection, and unique where M has at least rank 2.
    """
    left, sizes, right = np.linalg.svd(moments)
    signs = np.ones_like(sizes)
    signs[..., 2] = np.sign(np.linalg.det(left @ right))
    back = np.swapaxes(right, -1, -2)
    return (left * signs[..., None, :]) @ right, (back * (signs * sizes)[..., None, :]) @ right


def turns(rotations: np.ndarray, stretches: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Turns R^T dtheta, shape (..., 3) [rad], by changes of the moments M = R U; shapes (..., 3, 3)."""
    turned = np.swapaxes(rotations, -1, -2) @ changes
    skew = np.stack([turned[..., i, j] - turned[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=-1)
    inertia = np.trace(stretches, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - stretches
    return np.asarray(np.linalg.solve(inertia, skew[..., None])[..., 0])


def quaternions(rotations: np.ndarray) -> np.ndarray:
    """Unit quaternions of rotations, scalar part first and not negative, shapes (..., 3, 3) and (..., 4) [-]."""
    units = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat(canonical=True, scalar_first=True)
    return np.asarray(units).reshape(*rotations.shape[:-2], 4)


def quaternion_changes(quaternions: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Changes r (0, t) / 2 of quaternions, shape (..., 4) [-], with turns, shape (..., 3) [rad]."""
    scalar, vector = quaternions[..., :1], quaternions[..., 1:]
    along = -np.sum(vector * turns, axis=-1, keepdims=True)
    return np.concatenate([along, scalar * turns + np.cross(vector, turns)], axis=-1) / 2

"""A plate's pose as its clamp seen from it, and its small motions in its own frame.

With the plate's centre c and rotation R, the pose is q = -R^T c [m] and the unit quaternion r of R. A motion is
v = R^T dc [m] and the turn t = R^T dtheta [rad]: dq = q x t - v, and t = 2 vec(r* dr).
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


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


def gaps(poses: np.ndarray, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """How far points of the plates, in their frames, lie along directions of space, shapes (n, 3); shape (n,) [m]."""
    places = np.einsum("nij,nj->ni", rotations(poses), points - poses[:, :3])
    return np.asarray(np.sum(normals * places, axis=1))

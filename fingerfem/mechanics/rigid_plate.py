"""The rigid motion of a plate, and the forces of a wrench that follows it.

A plate is given by two moments of its mesh: the mean place c [m] and M = int (x - c) (X - C)^T dX [m^5], both linear in
the displacement. Steel leaves M = R U with a rotation R and a U that hardly changes. Virtual work of a moment m = R m_b
about c is m . dtheta with

    R^T dtheta = (tr U 1 - U)^-1 k(R^T dM),    k(A) = (A32 - A23, A13 - A31, A21 - A12),

so what does that work on dM is N = R [w]x with w = (tr U 1 - U)^-1 m_b, and on dc it is f = R f_b.
"""

from dataclasses import dataclass

import numpy as np

from rom.dataset import rigid_motion


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Position and rotation of a plate.

    Attributes:
        centre: mean place of its material, shape (3,) [m].
        rotation: of the plate's frame, shape (3, 3) [-].
        stretch: U of M = R U, symmetric, shape (3, 3) [m^5].
    """

    centre: np.ndarray
    rotation: np.ndarray
    stretch: np.ndarray

    @property
    def clamp(self) -> np.ndarray:
        """The clamp's centre seen from the plate, R^T (0 - c), shape (3,) [m]."""
        return -self.rotation.T @ self.centre

    @property
    def quaternion(self) -> np.ndarray:
        """Rotation of the plate as a unit quaternion, its scalar part first and not negative, shape (4,) [-]."""
        return rigid_motion.quaternions(self.rotation)

    def clamp_change(self, motion: np.ndarray) -> np.ndarray:
        """Change of the clamp seen from the plate [m] with R^T dc and R^T dtheta, shape (6,) [m, rad]."""
        return cross(self.clamp) @ motion[3:] - motion[:3]

    def quaternion_change(self, motion: np.ndarray) -> np.ndarray:
        """The quaternion's change with the same motion, q (0, R^T dtheta) / 2, shape (4,) [-]."""
        return rigid_motion.quaternion_changes(self.quaternion, motion[3:])


def pose(centre: np.ndarray, moment: np.ndarray) -> Pose:
    """The pose of a plate from its moments c, shape (3,), and M, shape (3, 3), by the polar decomposition M = R U."""
    rotation, stretch = rigid_motion.nearest_rotations(moment)
    return Pose(centre=centre, rotation=rotation, stretch=stretch)


def cross(vector: np.ndarray) -> np.ndarray:
    """[v]x, with [v]x a = v x a, shape (3, 3)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def generalised_forces(at: Pose, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces on c and M by a wrench in the plate's frame, force [N] and moment about its centre [N m], shape (6,).

    Returns:
        the force on c, shape (3,) [N], and on M, shape (3, 3) [N/m^4].
    """
    turned = np.linalg.solve(_inertia(at), wrench[3:])
    return at.rotation @ wrench[:3], at.rotation @ cross(turned)


def changes_with_rotation(at: Pose, wrench: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Changes of the generalised forces by rotations of the plate about its axes, the stretch kept [.../rad]."""
    force, moment = wrench[:3], cross(np.linalg.solve(_inertia(at), wrench[3:]))
    return [(at.rotation @ cross(axis) @ force, at.rotation @ cross(axis) @ moment) for axis in np.eye(3)]


def rotation_gradients(at: Pose) -> list[np.ndarray]:
    """Derivatives of the plate's rotation about its own axes, R^T dtheta, by M: three of shape (3, 3) [rad/m^5]."""
    return [at.rotation @ cross(row) for row in np.linalg.inv(_inertia(at))]


def _inertia(at: Pose) -> np.ndarray:
    return np.trace(at.stretch) * np.eye(3) - at.stretch

"""Motion and rotation of the base of a moving finger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from rom.brief import brief
from rom.dataset.rigid_motion import BaseMotion
from rom.files.checked_file import ModelError

FASTEST = 0.3  # largest rotation of the base in a step; larger steps are halved [rad]
RESTING = BaseMotion(np.zeros(3), np.zeros(3), np.zeros(3))


@brief
class Base(NamedTuple):
    """The base at one time: its motion, and its rotation, shape (3, 3)."""

    motion: BaseMotion
    rotation: np.ndarray

    def after(self, goal: BaseMotion, share: float, length: float) -> Base | None:
        """Return the base after a time [s], at a share [-] between this motion and the goal; None above FASTEST.

        It rotates at the mean angular velocity.
        """
        now = BaseMotion(*(share * end + (1 - share) * begin for begin, end in zip(self.motion, goal, strict=True)))
        turn = length * (self.motion.spin + now.spin) / 2
        if not turn.any():
            return Base(now, self.rotation)
        if np.linalg.norm(turn) > FASTEST:
            return None
        return Base(now, self.rotation @ Rotation.from_rotvec(turn).as_matrix())

    def numbers(self, gravity: np.ndarray) -> np.ndarray:
        """Return the input of compiled code, shape (9,), see segment.h, for gravity in space, shape (3,) [m/s^2]."""
        acceleration, spin, rate = self.motion
        return np.concatenate([self.rotation.T @ gravity - acceleration, spin, rate])


def checked(base: BaseMotion) -> BaseMotion:
    """Return a motion as arrays.

    Raises:
        ModelError: a field is not three finite numbers.
    """
    found = BaseMotion(*(np.array(one, float) for one in base))
    for name, one in zip(BaseMotion._fields, found, strict=True):
        if one.shape != (3,) or not np.isfinite(one).all():
            raise ModelError(f"base.{name} must be three finite numbers, got {one.tolist()}")
    return found

"""The base of a moving finger: how it moves, and how it is turned in space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from rom.brief import brief
from rom.dataset.rigid_motion import BaseMotion
from rom.files.checked_file import ModelError

FASTEST = 0.3  # turn of the base in a step, above which the step is halved [rad]
RESTING = BaseMotion(np.zeros(3), np.zeros(3), np.zeros(3))


@brief
class Base(NamedTuple):
    """The base at one time: how it moves, and its rotation, shape (3, 3)."""

    motion: BaseMotion
    rotation: np.ndarray

    def after(self, goal: BaseMotion, share: float, length: float) -> Base | None:
        """The base at a share of the way to another motion [-], a time later [s]; None if it turns too far.

        It turns by its mean angular velocity.
        """
        now = BaseMotion(*(share * end + (1 - share) * begin for begin, end in zip(self.motion, goal, strict=True)))
        turn = length * (self.motion.spin + now.spin) / 2
        if not turn.any():
            return Base(now, self.rotation)
        if np.linalg.norm(turn) > FASTEST:
            return None
        return Base(now, self.rotation @ Rotation.from_rotvec(turn).as_matrix())

    def numbers(self, gravity: np.ndarray) -> np.ndarray:
        """What compiled code takes, shape (9,), see segment.h; `gravity` is that in space, shape (3,) [m/s^2]."""
        acceleration, spin, rate = self.motion
        return np.concatenate([self.rotation.T @ gravity - acceleration, spin, rate])


def checked(base: BaseMotion) -> BaseMotion:
    """The same as arrays.

    Raises:
        ModelError: not three numbers each.
    """
    found = BaseMotion(*(np.array(one, float) for one in base))
    for name, one in zip(BaseMotion._fields, found, strict=True):
        if one.shape != (3,) or not np.isfinite(one).all():
            raise ModelError(f"base.{name} must be three finite numbers, got {one.tolist()}")
    return found

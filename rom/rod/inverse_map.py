"""The inverse of a segment: the pose of its plate -> the wrench on it, for simulators that move plates themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of
from rom.rod.segment import Segment


@brief
@dataclass
class InverseMap:
    """The wrench on the plate of one finger, followed from pose to pose.

    Every call begins at the wrench found last, so that it takes two or three evaluations of the map.

    Attributes:
        wrench: force and moment about the plate's centre, in its frame, shape (6,) [N, N m]: what holds the plate
            where it is. Rubber and tendons pull at it with the opposite.
        stiffness: how it changes as the plate moves by R^T dc and turns by R^T dtheta, shape (6, 6).
        inside: whether tensions and wrench lie where the map was trained.
        converged: whether the map has such a pose; if not, the wrench is that of the nearest pose that was found.

    Args:
        segment: the segment.

    Example:
        >>> inverse = InverseMap(Rod.load("finger.h5").segments[0])
        >>> inverse.find([20.0, 0.0], [0.047, 0.012, 0.0], [0.97, 0.0, 0.0, 0.24])
        >>> inverse.wrench
    """

    segment: Segment

    def __post_init__(self) -> None:
        self.wrench, self.stiffness = np.zeros(6), np.zeros((6, 6))
        self.inside, self.converged = True, True
        self._tensions, self._centre, self._quaternion = np.zeros(self.segment.tensions), np.zeros(3), np.zeros(4)
        self._inside = np.zeros(1, np.int32)
        arrays = (self._tensions, self._centre, self._quaternion, self.wrench, self.stiffness)
        self._given = [pointer(array) for array in arrays] + [pointer(self._inside, "int32_t[]")]
        self._given.insert(3, memory_of(self.segment.struct))
        self._spring = np.zeros(6), np.zeros((6, 6))
        self._spring_given = [*map(pointer, arrays[2:]), *map(pointer, self._spring)]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its map and what it found last, without addresses."""
        last = self.wrench.copy(), self.stiffness.copy(), self.inside, self.converged
        return type(self), (self.segment,), (last, self._quaternion.copy())

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        (self.wrench[:], self.stiffness[:], self.inside, self.converged), self._quaternion[:] = state

    def find(self, tensions: ArrayLike, centre: ArrayLike, quaternion: ArrayLike) -> int:
        """Find the wrench of a pose.

        Args:
            tensions: shape (t,) [N].
            centre: of the plate, seen from the clamp, shape (3,) [m].
            quaternion: of its frame, w first, shape (4,) [-].

        Returns:
            evaluations of the map.
        """
        self._tensions[:], self._centre[:], self._quaternion[:] = tensions, centre, quaternion
        evaluations = int(LIBRARY.functions.fingerfem_bear(self.segment.struct, *self._given))
        self.inside, self.converged = bool(self._inside[0]), evaluations > 0
        return abs(evaluations)

    def spring(self) -> tuple[np.ndarray, np.ndarray]:
        """The pose found last as a spring, by motions along the clamp's axes and turns about the plate's own.

        Returns:
            force, shape (6,) [N, N m]; stiffness, shape (6, 6), symmetric, without what would push the plate away.
        """
        LIBRARY.functions.fingerfem_spring(self.segment.struct, *self._spring_given)
        return self._spring[0].copy(), self._spring[1].copy()

    def forget(self) -> None:
        """Begin without a wrench."""
        self.wrench[:] = 0.0

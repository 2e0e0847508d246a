"""The inverse of a segment, as MuJoCo's elements call it (control/native/sections.c): pose of the plate -> wrench."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of


class Inverse(NamedTuple):
    """The wrench that holds a plate, shape (6,) [N, N m], and its stiffness, shape (6, 6); see rom/native/segment.h."""

    wrench: np.ndarray
    stiffness: np.ndarray
    inside: bool
    evaluations: int


def inverse(
    struct: Any, tensions: ArrayLike, centre: ArrayLike, quaternion: ArrayLike, start: ArrayLike = (0,) * 6
) -> Inverse:
    """From a start; evaluations are negative without a solution."""
    given = [np.array(one, float) for one in (tensions, centre, quaternion)]
    wrench, stiffness, inside = np.array(start, float), np.zeros((6, 6)), np.zeros(1, np.int32)
    pointers = [*map(pointer, given), memory_of(struct), pointer(wrench), pointer(stiffness)]
    evaluations = LIBRARY.functions.fingerfem_bear(struct, *pointers, pointer(inside, "int32_t[]"))
    return Inverse(wrench, stiffness, bool(inside[0]), int(evaluations))


def spring(struct: Any, quaternion: ArrayLike, found: Inverse) -> tuple[np.ndarray, np.ndarray]:
    """Force, shape (6,), and stiffness, shape (6, 6), by motions along the clamp's axes and turns about the plate's."""
    force, stiffness = np.zeros(6), np.zeros((6, 6))
    arrays = np.array(quaternion, float), found.wrench, found.stiffness, force, stiffness
    LIBRARY.functions.fingerfem_spring(struct, *map(pointer, arrays))
    return force, stiffness

"""The plates of a finger alone: where an object touches these first, whatever the rubber does."""

import numpy as np

from rom import TouchedSegment
from rom.native import SEGMENT, pointer
from rom.rod import native


def touch_of_plates(model: TouchedSegment, point: np.ndarray) -> float:
    """The touch distance of the plates at tensions and any d, shape (t + 1,); [m]."""
    t, n = len(model.names) - 1, len(model.rod.segments)
    wrench, out, jacobian, inside = np.zeros(6 * n), np.empty(5), np.empty((5, t + 1)), np.empty(1, np.int32)
    given = [*map(pointer, (wrench, out, jacobian)), pointer(inside, "int32_t[]")]
    memory = native.memory_of(model.rod.struct)
    SEGMENT.functions.fingerfem_press(model.touching, pointer(np.array(point, float)), memory, *given)
    return float(out[4])

"""The plates of a finger alone, as if its rubber could not be touched."""

from dataclasses import replace

import numpy as np

from rom import Rod, TouchedSegment


def bare(rod: Rod) -> Rod:
    """The same finger without a surface of its rubber."""
    found = replace(rod)
    found.__dict__["segments"] = [replace(one, outlines=None) for one in rod.segments]
    return found


def touch_of_plates(model: TouchedSegment, point: np.ndarray) -> float:
    """The touch distance of the plates at tensions and any d, shape (t + 1,); [m]."""
    return float(replace(model, rod=bare(model.rod)).outputs(np.array(point, float)[None])[0, 4])

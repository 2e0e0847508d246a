"""The plates of a finger alone, as if its rubber could not be touched."""

from dataclasses import replace

import numpy as np

from rom import Rod, TouchedSegment
from rom.rod.compiled import struct

_bare: dict[int, tuple[Rod, Rod]] = {}  # by the identity of a finger, which is kept


def bare(rod: Rod) -> Rod:
    """The same finger without a surface of its rubber."""
    if id(rod) not in _bare:
        found = replace(rod)
        found.__dict__["segments"] = [replace(one) for one in rod.segments]
        for one in found.segments:
            one.__dict__["struct"] = struct(replace(one.condensed, outlines=None, depths=None))
        _bare[id(rod)] = rod, found
    return _bare[id(rod)][1]


def touch_of_plates(model: TouchedSegment, point: np.ndarray) -> float:
    """The touch distance of the plates at tensions and any d, shape (t + 1,); [m]."""
    return float(replace(model, rod=bare(model.rod)).outputs(np.array(point, float)[None])[0, 4])

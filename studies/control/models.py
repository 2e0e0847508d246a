"""The model that the controllers are measured with."""

from __future__ import annotations

from dataclasses import replace

from rom import TouchedSegment
from rom.rod.objects.shapes import facing_plane

TARGET = 1.0  # [N]
DISTANCES = 0.001, 0.031  # [m] of the paper's plane
PAPER_US = 7160.0  # mean solve of Chenevier et al., PLoS ONE 2018, table 1, one segment [us]


def finger() -> TouchedSegment:
    """The bundled finger, before the paper's plane."""
    touched = TouchedSegment.load()
    return replace(touched, obstacle=facing_plane(touched.scene["geometry"]["side"], DISTANCES))

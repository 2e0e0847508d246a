"""Bound of the height by which pressure in a chamber lifts the face over it: a rod's model has no contact there.

A chamber grows mostly towards the face over its thinnest wall, along which it is wide. Its growth per length, over its
width, is at least the mean height of that wall; SHAPE times that bounds the height of the middle. In 80 held-out states
of scenes/pressed_chambers.toml heights are at most 0.9 of this growth at the highest pressure, and at lower ones below
the bound of rom/native/contact/bulged.c.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rom.dataset.geometry import tip_at_rest
from rom.dataset.sections.section import extent
from rom.elements.law import POSE, ElementMap

SHAPE = 1.1  # height of the middle over growth per length and width [-]
THIN = 0.5  # thickness of a wall over the chamber's width along it, above which its face stays flat [-]


def bulges_of(
    elements: Sequence[ElementMap], scene: Mapping[str, Any], size: float, trained: Sequence[int], length: float
) -> np.ndarray:
    """Heights of faces across y and across z under the highest pressures, shape (t, 2) [m].

    They are negative at -y and -z, and 0 of tendons and of faces over thick walls.

    Args:
        elements: of a segment, by its loads.
        scene: the elements' own, as plain data.
        size: of the segment over the trained one's [-].
        trained: which of the elements' loads every load is.
        length: of the segment from its clamp to its plate's centre [m].
    """
    heights, tendons = np.zeros((len(trained), 2)), len(scene["tendons"])
    for j, k in enumerate(trained):
        if k < tendons:
            continue
        chamber, half = scene["chambers"][k - tendons], extent(scene) / 2
        inputs = np.zeros((1, len(trained) + 6))
        inputs[0, j] = elements[0].tensions[1, j]
        growth = sum(float(one.value(inputs)[0, POSE + k]) for one in elements)
        beyond = tip_at_rest(scene["geometry"])[0] - (chamber["x"][1] - chamber["x"][0])  # of the trained finger
        span = length - size * beyond
        for axis in (0, 1):
            width = chamber["size"][1 - axis]
            wall = half - abs(chamber["centre"][axis]) - chamber["size"][axis] / 2
            if wall < THIN * width:
                height = SHAPE * max(growth, 0.0) / (span * size * width)
                heights[j, axis] = np.copysign(height, chamber["centre"][axis])
    return heights

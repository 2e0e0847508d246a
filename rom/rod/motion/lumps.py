"""The mass of a finger at its plates and sections.

The rubber within half an element of a section moves with it as a rigid body.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.rod.rod import Rod


@brief
class Lumps(NamedTuple):
    """The mass of a finger at its bodies: plates from clamp to tip, then sections as loads have them.

    Attributes:
        masses: shape (n,) [kg].
        moments: first moments about the bodies' centres, in their frames, shape (n, 3) [kg m].
        inertias: likewise moments of inertia, shape (n, 3, 3) [kg m^2].
    """

    masses: np.ndarray
    moments: np.ndarray
    inertias: np.ndarray


def lumps_of(rod: Rod, density: float, plate_density: float) -> Lumps:
    """The mass of a finger by densities of its rubber and plates [kg/m^3]: halves of elements are their sections'."""
    side, plates, sections = rod.scene["geometry"]["side"], list[np.ndarray](), list[np.ndarray]()
    for segment, own in zip(rod.segments, rod.pieces, strict=True):
        half, begins = segment.half_lengths[0], [segment.half_lengths[0], *[0.0] * (len(own) - 1)]
        thick, width, height = 2 * segment.half_lengths
        bodies = [_bar(plate_density, thick, width, height, -half)]
        for piece, behind in zip(own, begins, strict=True):
            length = (piece.length - behind) / 2  # an element of the plate begins at its centre, the rubber at its back
            distal, proximal = (side * size for size in piece.ends)
            bodies[-1] = bodies[-1] + _bar(density, length, distal, distal, -behind - length)
            bodies.append(_bar(density, length, proximal, proximal, 0.0))
        if plates:  # rubber at the segment's clamp moves with the plate before, of which it lies in front
            front = rod.segments[len(plates) - 1].half_lengths[0]
            proximal = side * own[-1].ends[1]
            plates[-1] = plates[-1] + _bar(density, own[-1].length / 2, proximal, proximal, front)
        plates.append(bodies[0])
        sections += bodies[1:-1]
    found = np.array(plates + sections)
    return Lumps(found[:, 0], found[:, 1:4], found[:, 4:].reshape(-1, 3, 3))


def _bar(density: float, length: float, width: float, height: float, begin: float) -> np.ndarray:
    """Mass, first moment and moments of inertia, shape (13,), of a bar along x that begins at x [m]."""
    mass, middle = density * length * width * height, begin + length / 2
    along = length**2 / 12 + middle**2
    y, z = width**2 / 12, height**2 / 12
    return np.concatenate([[mass], [mass * middle, 0, 0], mass * np.diag([y + z, along + z, along + y]).ravel()])

"""The mass of a finger at its plates and sections.

The rubber within half an element of a section moves with it as a rigid body.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.dataset.sections.section import area, mean_squares
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
    whole, squares = area(rod.scene), mean_squares(rod.scene)

    def bar(of: float, length: float, size: float, begin: float) -> np.ndarray:
        """A prism of the section at a size [-], see `_prism`."""
        return _prism(of * length * whole * size**2, length, squares * size**2, begin)

    plates, sections = list[np.ndarray](), list[np.ndarray]()
    for segment, own in zip(rod.segments, rod.pieces, strict=True):
        half, begins = segment.half_lengths[0], [segment.half_lengths[0], *[0.0] * (len(own) - 1)]
        bodies = [bar(plate_density, 2 * half, own[0].ends[0], -half)]
        for piece, behind in zip(own, begins, strict=True):
            length = (piece.length - behind) / 2  # an element of the plate begins at its centre, the rubber at its back
            distal, proximal = piece.ends
            bodies[-1] = bodies[-1] + bar(density, length, distal, -behind - length)
            bodies.append(bar(density, length, proximal, 0.0))
        if plates:  # rubber at the segment's clamp moves with the plate before, of which it lies in front
            front = rod.segments[len(plates) - 1].half_lengths[0]
            plates[-1] = plates[-1] + bar(density, own[-1].length / 2, own[-1].ends[1], front)
        plates.append(bodies[0])
        sections += bodies[1:-1]
    found = np.array(plates + sections)
    return Lumps(found[:, 0], found[:, 1:4], found[:, 4:].reshape(-1, 3, 3))


def _prism(mass: float, length: float, squares: np.ndarray, begin: float) -> np.ndarray:
    """Mass, first moment and moments of inertia, shape (13,), of a prism along x that begins at x [m].

    `squares` are the means of y^2 and z^2 over its section, shape (2,) [m^2].
    """
    middle, (y, z) = begin + length / 2, squares
    along = length**2 / 12 + middle**2
    return np.concatenate([[mass], [mass * middle, 0, 0], mass * np.diag([y + z, along + z, along + y]).ravel()])

"""A finger at rest as bodies on a line: its clamp, then a section or plate after every element.

The rubber within half an element of a section moves with it as a rigid body, as in `rom.rod.motion.lumps`. Without the
mass that elements have between their sections, the first three frequencies of the bundled finger across its axis are
0.1, 1.5 and 6 % too low (tests/control/mujoco/test_sections.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rom import Rod
from rom.brief import brief
from rom.dataset.sections.section import area, mean_squares
from rom.rod.motion.lumps import prism
from rom.rod.scene.materials_of_rod import line_mass


class Block(NamedTuple):
    """A prism of a body.

    Attributes:
        begin, end: on the body's x axis [m].
        size: of its section over that of a finger without taper [-].
        is_plate: whether it is steel.
        material: another than the rubber, along a part of the axis.
    """

    begin: float
    end: float
    size: float
    is_plate: bool = False
    material: str | None = None


@brief
class Body(NamedTuple):
    """A moving section with its rigid parts.

    Attributes:
        offset: from the previous body, along the axis [m].
        length: of the element between both, which begins at a plate's front [m].
        blocks: from clamp to tip.
    """

    offset: float
    length: float
    blocks: list[Block]

    @property
    def is_plate(self) -> bool:
        """True if it contains a plate."""
        return any(block.is_plate for block in self.blocks)

    def inertia(self, rod: Rod, density: float) -> tuple[float, np.ndarray, np.ndarray]:
        """Mass [kg], centre, shape (3,) [m], and moments of inertia about it, shape (3,) [kg m^2]."""
        whole, total, steel = area(rod.scene), np.zeros(13), (density, mean_squares(rod.scene))
        for block in self.blocks:
            own, squares = steel if block.is_plate else line_mass(rod.scene, density, block.material)
            length, square = block.end - block.begin, block.size**2
            total += prism(own * length * whole * square, length, squares * square, block.begin)
        mass, centre = float(total[0]), total[1:4] / total[0]
        moments = np.diag(total[4:].reshape(3, 3)) - mass * (centre @ centre - centre**2)
        return mass, centre, moments


def bodies_of(rod: Rod) -> list[Body]:
    """Return the clamp and all sections of a finger, from clamp to tip."""
    bodies = [Body(0.0, 0.0, [])]
    for segment, own in zip(rod.segments, rod.pieces, strict=True):
        half = segment.half_lengths[0]
        front = half if len(bodies) > 1 else 0.0  # a plate's centre lies half a plate before the clamp of the next
        for k, piece in reversed(list(enumerate(own))):
            behind = 0.0 if k else half
            length, (distal, proximal) = (piece.length - behind) / 2, piece.ends
            before = bodies[-1].blocks
            if before and not bodies[-1].is_plate and before[-1].material == piece.material:
                before[-1] = before[-1]._replace(end=length)
            else:
                before.append(Block(front, front + length, proximal, material=piece.material))
            distal_half = Block(-behind - length, -behind, distal, material=piece.material)
            bodies.append(Body(front + piece.length, piece.length, [distal_half]))
            front = 0.0
        bodies[-1].blocks.append(Block(-half, half, own[0].ends[0], is_plate=True))
    return bodies

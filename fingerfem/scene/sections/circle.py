"""Circles and rings: tables and measures; `polar` makes their meshes."""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from fingerfem.scene.scene_table import Length
from fingerfem.scene.sections.plane_mesh import PlaneMesh
from fingerfem.scene.sections.polar import polar_mesh
from fingerfem.scene.sections.section import Column, Section, Wanted

NEAREST = 1.0  # offset of a tendon beside the axis over its channel's width, at least [-]
BESIDE = 1.5  # the same where another tendon is on the axis [-]
THINNEST = 0.02  # wall of a ring over its diameter, at least [-]


class Round(Section):
    """Base of circle and ring; the axis is in the middle."""

    diameter: Length

    @property
    def hollow(self) -> float:
        """Diameter of the bore [m]."""
        return 0.0

    @property
    def is_round(self) -> bool:
        """True: the border consists of circles."""
        return True

    @property
    def extents(self) -> tuple[float, float]:
        """Height along y and width along z [m]."""
        return self.diameter, self.diameter

    @property
    def area(self) -> float:
        """Area of the section [m^2]."""
        return math.pi / 4 * (self.diameter**2 - self.hollow**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area [m^4]."""
        return math.pi / 64 * (self.diameter**4 - self.hollow**4)

    def refusal(self, column: Column, width: float) -> str | None:
        """The rule that a tendon's channel breaks, if any."""
        radius, most = float(np.hypot(*column.offset)), (self.diameter - width) / 2
        least = self.hollow / 2 + width / 2 if self.hollow else NEAREST * width
        if radius > most * (1 + 1e-9):
            return f"must keep its channel inside the section (at most {most:g} m from the axis)"
        if self.hollow and radius < least * (1 - 1e-9):
            return f"must keep its channel or hole outside the bore (at least {least:g} m from the axis)"
        if 0 < radius < least * (1 - 1e-9):
            return f"must be on the axis or at least the channel's width, {width:g} m, from it"
        return None

    def are_apart(self, one: Column, other: Column, width: float) -> bool:
        """True if two channels, sectors about the axis, have no cells in common."""
        radii = [float(np.hypot(*column.offset)) for column in (one, other)]
        if min(radii) == 0:
            return max(radii) >= BESIDE * width * (1 - 1e-9)
        if abs(radii[0] - radii[1]) >= width * (1 - 1e-9):
            return True
        angles = [math.atan2(column.offset[1], column.offset[0]) for column in (one, other)]
        between = abs(math.remainder(angles[0] - angles[1], 2 * math.pi))
        return between >= sum(width / 2 / radius for radius in radii) * (1 - 1e-9)

    def mesh(self, wanted: Wanted) -> PlaneMesh:
        """Mesh by radial lines and circles."""
        whole = polar_mesh(wanted, self.diameter / 2, self.hollow / 2)
        return whole.half() if wanted.half else whole


class Circle(Round):
    """A circle."""

    shape: Literal["circle"]


class Ring(Round):
    """A circle with a concentric bore, through all plates too, unless a chamber closes it."""

    chamber_region: ClassVar[str | None] = "bore"
    shape: Literal["ring"]
    bore: Length  # its diameter

    @property
    def hollow(self) -> float:
        """Diameter of the bore [m]."""
        return self.bore

    @property
    def channel_width(self) -> float:
        """Width of a channel, unless the scene gives it [m]."""
        return min(self.diameter / 5, (self.diameter - self.bore) / 4)

    @model_validator(mode="after")
    def _has_a_wall(self) -> Ring:
        most = self.diameter * (1 - 2 * THINNEST)
        if self.bore > most:
            raise ValueError(
                f"bore must be at most {most:g} m, to leave a wall of at least {THINNEST} diameters, got {self.bore}"
            )
        return self

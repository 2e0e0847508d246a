"""Other materials of a finger: layers, fibres, a skeleton, joints, each in a region of the rubber."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from fingerfem.scene.laws import NamedLaw
from fingerfem.scene.tables import Placed, Position


class Material(Placed):
    """A region of the rubber that is of another material. Plates stay steel, and chambers void.

    Its region in the section is the whole section, a rectangle, or the group `material NAME` of a file.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    region: Literal["section", "rectangle", "group"]
    x: Annotated[list[Position], Field(min_length=2, max_length=2)] | None = None  # from, to at rest [m]; None: all
    density: Annotated[float, Field(gt=0, le=3e4)] | None = None  # [kg/m^3]; the rubber's if absent
    material: NamedLaw

"""Parts placed in the rubber: pressure chambers, and other materials such as layers, fibres, a skeleton."""

from typing import Annotated, Literal

from pydantic import Field

from fingerfem.scene.laws import NamedLaw
from fingerfem.scene.tables import Placed, Position, RubberDensity

Pressure = Annotated[float, Field(ge=0, le=1e8)]  # above that around the finger [Pa]


class Chamber(Placed):
    """A closed void, whose gas presses on its wall.

    Its region in the section is a rectangle, the bore of a ring, or the group `chamber NAME` of a file. Beyond its ends
    the region is filled with rubber or steel.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    region: Literal["rectangle", "bore", "group"]
    x: Annotated[list[Position], Field(min_length=2, max_length=2)]  # from, to along the axis at rest [m]
    pressure: Annotated[list[Pressure], Field(min_length=2, max_length=2)]  # [lowest, highest] [Pa]


class Material(Placed):
    """A region of the rubber that is of another material. Plates stay steel, and chambers void.

    Its region in the section is the whole section, a rectangle, or the group `material NAME` of a file.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    region: Literal["section", "rectangle", "group"]
    x: Annotated[list[Position], Field(min_length=2, max_length=2)] | None = None  # from, to at rest [m]; None: all
    density: RubberDensity | None = None  # [kg/m^3]; the rubber's if absent
    material: NamedLaw

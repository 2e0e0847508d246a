"""Pressure chambers: closed voids in a segment's rubber."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from fingerfem.scene.tables import Placed, Position

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

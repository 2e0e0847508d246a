"""Pressure chambers: closed voids in a segment's rubber."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fingerfem.scene.scene_table import Length, SceneTable
from fingerfem.scene.tables import Offset, Position

Pressure = Annotated[float, Field(ge=0, le=1e8)]  # above that around the finger [Pa]


class Chamber(SceneTable):
    """A closed void, whose gas presses on its wall.

    Its region in the section is a rectangle, the bore of a ring, or the group `chamber NAME` of a file. Beyond its ends
    the region is filled with rubber or steel.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    region: Literal["rectangle", "bore", "group"]
    centre: Annotated[list[Offset], Field(min_length=2, max_length=2)] | None = None  # of a rectangle, (y, z) [m]
    size: Annotated[list[Length], Field(min_length=2, max_length=2)] | None = None  # of it, along y and z [m]
    x: Annotated[list[Position], Field(min_length=2, max_length=2)]  # from, to along the axis at rest [m]
    pressure: Annotated[list[Pressure], Field(min_length=2, max_length=2)]  # [lowest, highest] [Pa]

    @property
    def is_mirrored(self) -> bool:
        """Whether it is its own mirror image in z = 0; of a group, the file decides."""
        return self.centre is None or self.centre[1] == 0

    @model_validator(mode="after")
    def _is_placed(self) -> Chamber:
        for key in ("centre", "size"):
            given = getattr(self, key)
            if self.region == "rectangle" and given is None:
                raise ValueError(f"{key} must be given for a chamber whose region is a rectangle, got none")
            if self.region != "rectangle" and given is not None:
                raise ValueError(f"{key} must be left out where region is {self.region!r}, got {given}")
        return self

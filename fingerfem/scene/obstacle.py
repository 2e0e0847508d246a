"""Obstacle that a finger may touch: one rigid body, or several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from fingerfem.scene.scene_table import SceneTable
from fingerfem.scene.tables import Length, Pad

Distance = Annotated[float, Field(ge=-1.0, le=1.0)]  # [m]
Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Coordinate = Annotated[float, Field(ge=-8.0, le=8.0)]  # [m], as far as eight segments reach
Place = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]  # [m]


def unit(vector: Sequence[float]) -> tuple[float, ...]:
    """The unit vector of a vector of any length, also of one whose square is no number; exact along an axis."""
    largest = max(map(abs, vector))
    scaled = [part / largest for part in vector]
    length = float(np.linalg.norm(scaled))
    return tuple(part / length for part in scaled)


# Keys that place an obstacle, and those that every shape needs or may have. A plane without any is y = side/2 + d.
PLACING = ("shape", "centre", "direction", "normal", "axis", "radius", "sides", "rotation", "rounding")
NEEDS = {"plane": (), "sphere": ("centre", "radius"), "cylinder": ("centre", "axis", "radius")}
NEEDS |= {"box": ("centre", "sides", "rounding")}
MAY_HAVE = {"plane": ("centre", "normal"), "sphere": (), "cylinder": (), "box": ("rotation",)}


class Shape(SceneTable):
    """A rigid body: the plane y = side/2 + d, or another shape that d moves along `direction`."""

    shape: Literal["plane", "sphere", "cylinder", "box"] = "plane"
    centre: Place | None = None  # position at d = 0 [m]; of a plane, a point on it
    direction: Vector | None = None  # along which d moves it away [-]; if absent y, or against the plane's normal
    normal: Vector | None = None  # of a plane, towards the finger [-]; -y if absent
    axis: Vector | None = None  # of a cylinder, which has no ends [-]
    radius: Length | None = None  # of a sphere or a cylinder [m]
    sides: Annotated[list[Length], Field(min_length=3, max_length=3)] | None = None  # of a box [m]
    rotation: Vector | None = None  # of a box, about its centre: axis times angle [rad]
    rounding: Length | None = None  # radius of a box's edges [m]

    @model_validator(mode="after")
    def _is_placed(self) -> Shape:
        for name in NEEDS[self.shape]:
            if getattr(self, name) is None:
                raise ValueError(f"{name} must be given for a {self.shape}, got none")
        for name in set(PLACING) - {"shape", "direction", *NEEDS[self.shape], *MAY_HAVE[self.shape]}:
            if getattr(self, name) is not None:
                raise ValueError(f"{name} must be left out of a {self.shape}, got {getattr(self, name)}")
        for name in ("direction", "normal", "axis"):
            value = getattr(self, name)
            if value is not None and not any(value):
                raise ValueError(f"{name} must be a vector of some length, got {value}")
        if self.normal is not None and self.centre is None:
            raise ValueError(f"centre must be given for a plane with a normal, got none beside {self.normal}")
        if self.sides is not None and self.rounding is not None and 2 * self.rounding > min(self.sides):
            raise ValueError(
                f"rounding must be at most half the shortest side, {min(self.sides) / 2:g} m, got {self.rounding}"
            )
        self._check_direction()
        return self

    def _check_direction(self) -> None:
        along = self.leaving
        if self.shape == "plane":
            normal = self.normal or [0.0, -1.0, 0.0]
            if -np.dot(unit(along), unit(normal)) < 0.1:
                raise ValueError(f"direction must lead the plane away, against its normal {normal}, got {along}")
        if self.axis is not None and abs(np.dot(unit(along), unit(self.axis))) > 0.995:
            raise ValueError(f"direction must not be along the cylinder's axis {self.axis}, got {along}")

    @model_serializer(mode="wrap")
    def _without_its_usual_place(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omits keys that place the plane y = side/2 + d: its scenes are those from before there were other shapes."""
        table = serialise(self)
        return {
            key: value
            for key, value in table.items()
            if not (self.faces and key in PLACING) and (key != "others" or value)
        }

    @property
    def leaving(self) -> list[float]:
        """The direction along which d moves it away [-], of any length."""
        if self.direction is not None:
            return self.direction
        return [0.0, 1.0, 0.0] if self.normal is None else [-part for part in self.normal]

    @property
    def faces(self) -> bool:
        """True if the body is the plane y = side/2 + d."""
        return self.shape == "plane" and self.centre is None and self.direction is None

    @property
    def is_mirrored(self) -> bool:
        """True if the body is its own mirror image in z = 0, wherever d moves it."""
        across = [vector[2] for vector in (self.centre, self.direction, self.normal) if vector is not None]
        if self.axis is not None:
            across.append(self.axis[2] and (self.axis[0] or self.axis[1]))
        if self.rotation is not None:
            across += self.rotation[:2]
        return not any(across)


class Obstacle(Shape):
    """Rigid bodies that the finger touches without friction. d moves all of them, each along its own direction."""

    distance: Annotated[list[Distance], Field(min_length=2, max_length=2)]  # [nearest, farthest] [m]
    method: Literal["penalty", "nitsche"] = "penalty"
    stiffness: Annotated[float, Field(ge=1, le=1e6)] | None = None  # of contact, times mesh size over a modulus [-]
    pad: Pad | None = None
    others: Annotated[list[Shape], Field(max_length=7)] = []  # further bodies: [[obstacle.others]]

    @model_validator(mode="after")
    def _is_beyond_the_side(self) -> Obstacle:
        if any(one.faces for one in self.bodies) and self.distance[0] <= 0:
            raise ValueError(f"distance.0 must be above 0 m for the plane y = side/2 + d, got {self.distance[0]}")
        if self.pad is not None and not self.is_facing_plane:
            raise ValueError("pad must be left out unless the obstacle is the plane y = side/2 + d alone")
        return self

    @property
    def bodies(self) -> list[Shape]:
        """All of them."""
        return [self, *self.others]

    @property
    def is_facing_plane(self) -> bool:
        """True if the obstacle is the plane y = side/2 + d alone."""
        return self.faces and not self.others

    @property
    def stiffness_factor(self) -> float:
        """The stiffness asked for, or the method's own [-]."""
        return self.stiffness or {"penalty": 2000.0, "nitsche": 1000.0}[self.method]

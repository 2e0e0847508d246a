"""Rigid objects that a plate may touch, each moved by a distance d along a direction away from the finger."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Object:
    """A rigid object.

    Attributes:
        centre: of it at d = 0, in the finger's axes [m]; of a plane any point on it.
        direction: along which d moves it away from the finger, of any length [-].
        distances: nearest and farthest d [m].
    """

    shape: ClassVar[int]
    centre: Vector
    direction: Vector
    distances: tuple[float, float] = (-1.0, 1.0)

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not np.isfinite(value).all():
                raise ValueError(f"{name} must be finite, got {value}")
        for name in ("direction", "normal", "axis"):
            if not np.linalg.norm(getattr(self, name, (1.0,))) > 0:
                raise ValueError(f"{name} must be a vector of some length, got {getattr(self, name)}")
        if not getattr(self, "radius", 1.0) > 0:
            raise ValueError(f"radius must be above 0 m, got {getattr(self, 'radius', None)}")

    def numbers(self) -> dict[str, Any]:
        """What the compiled solve knows of it, the fields of fingerfem_object."""
        axis = getattr(self, "axis", getattr(self, "normal", (0.0, 0.0, 0.0)))
        return {
            "shape": self.shape,
            "centre": list(map(float, self.centre)),
            "direction": _unit(self.direction),
            "axis": _unit(axis),
            "radius": float(getattr(self, "radius", 0.0)),
            "nearest": float(self.distances[0]),
            "farthest": float(self.distances[1]),
        }


@dataclass(frozen=True, kw_only=True)
class Plane(Object):
    """A half space; `normal` points out of it, towards the finger [-]."""

    shape = 0
    normal: Vector


@dataclass(frozen=True, kw_only=True)
class Sphere(Object):
    """A ball of a radius [m]."""

    shape = 1
    radius: float


@dataclass(frozen=True, kw_only=True)
class Cylinder(Object):
    """A cylinder without ends, of a radius [m], along `axis` through its centre [-]."""

    shape = 2
    radius: float
    axis: Vector = field(default=(0.0, 0.0, 1.0))


def facing_plane(side: float, distances: tuple[float, float]) -> Plane:
    """The plane y = side/2 + d of scenes that do not say more."""
    return Plane(centre=(0.0, side / 2, 0.0), direction=(0.0, 1.0, 0.0), normal=(0.0, -1.0, 0.0), distances=distances)


def _unit(vector: Vector) -> list[float]:
    length = float(np.linalg.norm(vector))
    return [float(part) / length if length else 0.0 for part in vector]

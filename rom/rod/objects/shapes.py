"""Rigid objects that a plate may touch, each moved by a distance d along a direction away from the finger."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from rom.brief import brief
from rom.rod.objects.polyhedron import polyhedron

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class RigidObject:
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
            if not np.any(getattr(self, name, (1.0,))):
                raise ValueError(f"{name} must be a vector of some length, got {getattr(self, name)}")
        if not getattr(self, "radius", 1.0) > 0:
            raise ValueError(f"radius must be above 0 m, got {getattr(self, 'radius', None)}")

    def numbers(self) -> dict[str, Any]:
        """Numbers of the object for the compiled solve, the fields of fingerfem_object."""
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
class Plane(RigidObject):
    """A half space; `normal` points out of it, towards the finger [-]."""

    shape = 0
    normal: Vector


@dataclass(frozen=True, kw_only=True)
class Sphere(RigidObject):
    """A ball of a radius [m]."""

    shape = 1
    radius: float


@dataclass(frozen=True, kw_only=True)
class Cylinder(RigidObject):
    """A cylinder without ends, of a radius [m], along `axis` through its centre [-]."""

    shape = 2
    radius: float
    axis: Vector = field(default=(0.0, 0.0, 1.0))


@brief
@dataclass(frozen=True, kw_only=True)
class Hull(RigidObject):
    """The convex hull of `vertices`, given from its centre, shape (n, 3) [m], rounded by a radius [m] all around.

    A small radius keeps contact at sharp edges smooth; the body is larger by it than the hull.
    """

    shape = 3
    vertices: Sequence[Vector]
    rounding: float = 1e-4

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.ndim(self.vertices) != 2 or np.shape(self.vertices)[1] != 3:
            raise ValueError(f"vertices must have shape (n, 3), got {np.shape(self.vertices)}")
        if not self.rounding > 0:
            raise ValueError(f"rounding must be above 0 m, got {self.rounding}")
        self.numbers()

    def numbers(self) -> dict[str, Any]:
        """The fields of fingerfem_object."""
        return super().numbers() | {"radius": float(self.rounding)} | polyhedron(np.asarray(self.vertices, float))


def box(
    *,
    centre: Vector,
    sides: Vector,
    direction: Vector,
    rotation: Vector = (0.0, 0.0, 0.0),
    rounding: float = 1e-4,
    distances: tuple[float, float] = (-1.0, 1.0),
) -> Hull:
    """A box with rounded edges.

    Args:
        centre: of it at d = 0 [m].
        sides: its lengths, the rounded edges included [m].
        direction: along which d moves it away from the finger [-].
        rotation: about its centre, axis times angle [rad].
        rounding: radius of its edges [m].
        distances: nearest and farthest d [m].

    Raises:
        ValueError: numbers that are not finite, or rounding that is not below half the shortest side.
    """
    for name, value in (("sides", sides), ("rotation", rotation)):
        if np.shape(value) != (3,) or not np.isfinite(value).all():
            raise ValueError(f"{name} must be three finite numbers, got {value}")
    inner = np.asarray(sides, float) / 2 - rounding
    if not (inner > 0).all():
        raise ValueError(f"rounding must be below half the shortest side, {min(sides) / 2:g} m, got {rounding}")
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    vertices = (signs * inner) @ Rotation.from_rotvec(rotation).as_matrix().T
    return Hull(
        centre=centre,
        direction=direction,
        distances=distances,
        vertices=[tuple(vertex) for vertex in vertices.tolist()],
        rounding=rounding,
    )


def facing_plane(side: float, distances: tuple[float, float]) -> Plane:
    """The plane y = side/2 + d of scenes that do not say more."""
    return Plane(centre=(0.0, side / 2, 0.0), direction=(0.0, 1.0, 0.0), normal=(0.0, -1.0, 0.0), distances=distances)


def _unit(vector: Vector) -> list[float]:
    scaled = np.asarray(vector, float) / (np.abs(vector).max() or 1.0)  # its square may underflow
    return [float(part) for part in scaled / (np.linalg.norm(scaled) or 1.0)]

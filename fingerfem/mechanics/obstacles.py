"""Rigid obstacles as signed distances [m], positive outside, of points in space.

An obstacle at d = 0 stands where its scene puts it; at d it is moved by d along `direction`, away from the finger. One
formula serves the compiled forms, where coordinates are UFL expressions, and NumPy, where they are arrays.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np
import ufl
from scipy.spatial.transform import Rotation

from fingerfem.scene.obstacle import Obstacle, Shape, unit

Vector = tuple[float, ...]  # of three
Coordinates = Any  # x, y, z: UFL scalars, or arrays of shape (n,) [m]
TINY = 1e-9  # of a length under a root, so that its derivative exists [-]
MARCHES, CLOSE = 1000, 1e-12  # steps towards a body; distance over its reach that counts as touching [-]


@dataclass(frozen=True)
class Maths:
    """Functions of UFL or NumPy for a formula; `number` makes a constant of the compiled forms, or leaves it."""

    sqrt: Callable[[Any], Any]
    maximum: Callable[[Any, Any], Any]
    minimum: Callable[[Any, Any], Any]
    number: Callable[[float], Any]


NUMPY = Maths(np.sqrt, np.maximum, np.minimum, float)


def in_ufl(number: Callable[[float], Any]) -> Maths:
    """Functions of UFL, with constants made by `number`."""
    return Maths(ufl.sqrt, ufl.max_value, ufl.min_value, number)


@dataclass(frozen=True, kw_only=True)
class Body(ABC):
    """A rigid body.

    Attributes:
        centre: a point of it at d = 0 [m]; of a plane, any point on it.
        direction: unit vector along which it is moved by d [-].
    """

    centre: Vector
    direction: Vector

    @property
    def is_flat(self) -> bool:
        """True if the body touches convex ones at their corners alone."""
        return isinstance(self, Plane)

    @abstractmethod
    def distance_from_centre(self, x: Coordinates, maths: Maths) -> Any:
        """Signed distance of points given from the centre [m]."""

    def signed_distance(self, x: Coordinates, d: Any, maths: Maths) -> Any:
        """Signed distance [m] of points from the body moved by d [m]."""
        moved = zip(x, self.centre, self.direction, strict=True)
        arms = [_plus(value - maths.number(c), -e, d, maths) for value, c, e in moved]
        return self.distance_from_centre(arms, maths)

    @abstractmethod
    def normal_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """Gradient of the signed distance at points given from the centre, shapes (n, 3) [m], [-]."""

    def normal_at(self, points: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Unit normals of the body moved by d, shape (n,) [m], at points, shape (n, 3) [m]; shape (n, 3) [-]."""
        return self.normal_from_centre(points - np.array(self.centre) - np.outer(d, self.direction))

    @abstractmethod
    def curvature_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """The normal's gradient there, shape (n, 3, 3) [1/m]."""

    def curvature_at(self, points: np.ndarray, d: np.ndarray) -> np.ndarray:
        """The normals' gradients by the place, of the body moved by d, as `normal_at`; shape (n, 3, 3) [1/m]."""
        return self.curvature_from_centre(points - np.array(self.centre) - np.outer(d, self.direction))

    @property
    def reach(self) -> float:
        """Radius of a ball about the centre that contains the body [m]."""
        return np.inf

    def touch_distance(self, points: np.ndarray) -> np.ndarray:
        """Largest d at which the body touches points, shape (n, 3) [m]; -inf where it passes by; shape (n,) [m].

        Sphere tracing (Hart, The Visual Computer 12, 1996): the body comes nearer by its distance until it touches.
        """
        along = (points - np.array(self.centre)) @ self.direction
        distance = along + self.reach
        for _ in range(MARCHES):
            gap = self.signed_distance(points.T, distance, NUMPY)
            is_apart = (gap > CLOSE * self.reach) & (distance > along - self.reach)
            if not is_apart.any():
                break
            distance = np.where(is_apart, distance - gap, distance)
        return np.where(distance > along - self.reach, distance, -np.inf)


def _plus(value: Any, factor: float, other: Any, maths: Maths) -> Any:
    """Value + factor * other, with only the operations that the factor asks for."""
    if factor == 0:
        return value
    if abs(factor) == 1:
        return value + other if factor > 0 else value - other
    return value + maths.number(factor) * other


def _dot(vector: Sequence[float], x: Coordinates, maths: Maths) -> Any:
    return sum(maths.number(factor) * value for factor, value in zip(vector, x, strict=True))


def _norm(x: Coordinates, maths: Maths, size: float) -> Any:
    """2-norm, differentiable at zero by a length that no answer shows."""
    return maths.sqrt(sum(value * value for value in x) + maths.number((TINY * size) ** 2))


@dataclass(frozen=True, kw_only=True)
class Plane(Body):
    """A half space. `normal` is the unit vector that points out of it, towards the finger [-]."""

    normal: Vector

    def distance_from_centre(self, x: Coordinates, maths: Maths) -> Any:
        """Distance along the normal, n . x."""
        distance: Any = 0
        for factor, value in zip(self.normal, x, strict=True):
            distance = _plus(distance, factor, value, maths)
        return distance

    def normal_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """The normal."""
        return np.tile(self.normal, (len(arms), 1))

    def curvature_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """None."""
        return np.zeros((len(arms), 3, 3))

    def touch_distance(self, points: np.ndarray) -> np.ndarray:
        """See Body: where n . (x - c - d e) = 0."""
        return np.asarray((points - np.array(self.centre)) @ self.normal / np.dot(self.normal, self.direction))


@dataclass(frozen=True, kw_only=True)
class Sphere(Body):
    """A ball of a radius [m]."""

    radius: float

    def distance_from_centre(self, x: Coordinates, maths: Maths) -> Any:
        """Distance from the centre less the radius, |x| - R."""
        return _norm(x, maths, self.radius) - maths.number(self.radius)

    def normal_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """The direction from the centre."""
        return _normalised(arms)

    def curvature_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """(1 - n n^T) / |x|."""
        return _round(arms, np.eye(3))

    def touch_distance(self, points: np.ndarray) -> np.ndarray:
        """See Body: the larger root of |x - c - d e| = R."""
        return _larger_root(points - np.array(self.centre), np.array(self.direction), self.radius)


@dataclass(frozen=True, kw_only=True)
class Cylinder(Body):
    """A cylinder without ends, of a radius [m], along the unit vector `axis` through its centre."""

    radius: float
    axis: Vector

    def distance_from_centre(self, x: Coordinates, maths: Maths) -> Any:
        """Distance from the axis less the radius, |x - (a . x) a| - R."""
        along = _dot(self.axis, x, maths)
        across = [value - maths.number(a) * along for value, a in zip(x, self.axis, strict=True)]
        return _norm(across, maths, self.radius) - maths.number(self.radius)

    def normal_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """The part of x across the axis, normalised."""
        return _normalised(arms - np.outer(arms @ self.axis, self.axis))

    def curvature_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """Curvature as of a sphere, across the axis."""
        across = np.eye(3) - np.outer(self.axis, self.axis)
        return _round(arms @ across, across)

    def touch_distance(self, points: np.ndarray) -> np.ndarray:
        """See Body: as of a sphere, seen along the axis."""
        across = np.eye(3) - np.outer(self.axis, self.axis)
        return _larger_root((points - np.array(self.centre)) @ across, across @ self.direction, self.radius)


@dataclass(frozen=True, kw_only=True)
class Box(Body):
    """A box with rounded edges.

    Attributes:
        sides: lengths along its own axes, roundings included, shape (3,) [m].
        axes: its own axes as rows, shape (3, 3) [-].
        rounding: radius of its edges [m].
    """

    sides: Vector
    axes: tuple[Vector, ...]
    rounding: float

    def distance_from_centre(self, x: Coordinates, maths: Maths) -> Any:
        """|max(|q| - b, 0)| + min(max(|q| - b), 0) - r, b = half the sides less r (Quilez's exact box distance)."""
        own = [_dot(axis, x, maths) for axis in self.axes]
        halves = [side / 2 - self.rounding for side in self.sides]
        beyond = [abs(value) - maths.number(half) for value, half in zip(own, halves, strict=True)]
        outside = _norm([maths.maximum(value, 0.0) for value in beyond], maths, self.rounding)
        inside = maths.minimum(maths.maximum(maths.maximum(beyond[0], beyond[1]), beyond[2]), 0.0)
        return outside + inside - maths.number(self.rounding)

    def normal_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """Normal from the nearest point of the box without its rounding; for a point inside, from its nearest face."""
        own, beyond = self._beyond(arms)
        outwards = np.maximum(beyond, 0.0)
        inside = ~outwards.any(axis=1)
        outwards[inside] = beyond[inside] == beyond[inside].max(axis=1, keepdims=True)
        return _normalised(outwards * np.sign(own)) @ np.array(self.axes)

    def curvature_from_centre(self, arms: np.ndarray) -> np.ndarray:
        """Curvature as of a sphere, in the axes along which the point is beyond the unrounded box; inside none."""
        own, beyond = self._beyond(arms)
        outwards = np.maximum(beyond, 0.0) * np.sign(own)
        curvatures, axes = np.zeros((len(arms), 3, 3)), np.array(self.axes)
        out = outwards.any(axis=1)
        curvatures[out] = axes.T @ _round(outwards[out], np.eye(3) * (beyond[out] > 0)[:, None]) @ axes
        return curvatures

    def _beyond(self, arms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points along the box's own axes, and how far beyond it without its rounding, shapes (n, 3) [m]."""
        own = arms @ np.array(self.axes).T
        return own, np.abs(own) - (np.array(self.sides) / 2 - self.rounding)

    @property
    def reach(self) -> float:
        """Half its diagonal."""
        return float(np.linalg.norm(self.sides)) / 2


def _normalised(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _round(arms: np.ndarray, across: np.ndarray) -> np.ndarray:
    """(across - n n^T) / |r| of arms r, shape (n, 3): how normals n = r / |r| turn [1/m]."""
    length = np.linalg.norm(arms, axis=1)[:, None, None]
    normals = _normalised(arms)
    return np.asarray((across - normals[:, :, None] * normals[:, None]) / length)


def _larger_root(arms: np.ndarray, direction: np.ndarray, radius: float) -> np.ndarray:
    """The larger d with |r - d e| = R, of arms r, shape (n, 3); -inf where there is none."""
    a, b = direction @ direction, arms @ direction
    inside = b**2 - a * (np.sum(arms**2, axis=1) - radius**2)
    return np.where(inside >= 0, (b + np.sqrt(np.maximum(inside, 0.0))) / a, -np.inf)


def bodies(obstacle: Obstacle | None, top: float) -> list[Body]:
    """The bodies of a scene's obstacle; without one, the plane y = top + d beyond the section's largest y."""
    return [body(one, top) for one in (obstacle.bodies if obstacle else [Shape()])]


@singledispatch
def body(obstacle: Shape, top: float) -> Body:
    """The body of a shape; a plane stands on the section's largest y [m], unless its centre is given."""
    direction = unit(obstacle.leaving)
    centre = tuple(obstacle.centre or (0.0, top, 0.0))
    if obstacle.shape == "plane":
        return Plane(centre=centre, direction=direction, normal=unit(obstacle.normal or (0.0, -1.0, 0.0)))
    if obstacle.shape == "box":
        assert obstacle.sides is not None and obstacle.rounding is not None
        rows = Rotation.from_rotvec(obstacle.rotation or (0.0, 0.0, 0.0)).as_matrix().T
        axes = tuple(tuple(0.0 if abs(value) < 1e-15 else float(value) for value in row) for row in rows)
        sides, rounding = tuple(obstacle.sides), obstacle.rounding
        return Box(centre=centre, direction=direction, sides=sides, axes=axes, rounding=rounding)
    assert obstacle.radius is not None
    if obstacle.shape == "sphere":
        return Sphere(centre=centre, direction=direction, radius=obstacle.radius)
    assert obstacle.axis is not None
    return Cylinder(centre=centre, direction=direction, radius=obstacle.radius, axis=unit(obstacle.axis))

"""The outline of a section at rest: a convex curve, the Minkowski sum of a polygon and a disc."""

from __future__ import annotations

from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.files import checked_file

MOST_VERTICES = 64  # of the polygon
STRAIGHT = 1e-9  # least sine at a vertex, and least half of the box over the other one [-]
BOX = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # corners, counterclockwise [-]


@brief
@dataclass(frozen=True, kw_only=True)
class SectionOutline:
    """All points within `radius` of a convex polygon, in the section's plane (y, z), seen against the finger's axis.

    A circle is one vertex and its radius; a rectangle is four vertices and no radius.

    Attributes:
        vertices: of the polygon, counterclockwise, shape (m, 2) [m]; m is 1 for a point, 2 for a line.
        radius: of the disc [m].

    Example:
        >>> SectionOutline.circle(0.01).box.tolist()
        [0.01, 0.01]

    Raises:
        ModelError: vertices or radius that give no convex outline around the axis.
    """

    vertices: np.ndarray
    radius: float = 0.0

    def __post_init__(self) -> None:
        """Check it."""
        object.__setattr__(self, "vertices", np.array(self.vertices, float))
        count = len(self.vertices) if self.vertices.ndim == 2 else 0
        checked_file.require(
            1 <= count <= MOST_VERTICES and self.vertices.shape == (count, 2),
            f"vertices of a section must have shape (1 to {MOST_VERTICES}, 2)",
            self.vertices.shape,
        )
        finite = bool(np.isfinite(self.vertices).all()) and 0 <= self.radius < np.inf
        checked_file.require(
            finite, "vertices and radius of a section must be finite, radius at least 0 m", self.radius
        )
        sides = self.sides
        following = np.roll(sides, -1, axis=0)
        products = np.linalg.norm(sides, axis=1) * np.linalg.norm(following, axis=1)
        convex = count < 3 or bool((_cross(sides, following) > STRAIGHT * products).all())
        around = count < 3 or abs(_turns(sides) - 1) < 0.5
        checked_file.require(
            convex and around,
            "vertices of a section must be a convex polygon, counterclockwise",
            self.vertices.tolist(),
        )
        solid = count >= 3 or self.radius > 0
        checked_file.require(solid, "radius of a section of one or two vertices must be above 0 m", self.radius)
        checked_file.require(self._has_axis, "outline of a section must enclose the axis", self.vertices.tolist())

    @classmethod
    def rectangle(cls, half_y: float, half_z: float) -> SectionOutline:
        """A rectangle about the axis, by the halves of its sides [m]."""
        return cls(vertices=BOX * [half_y, half_z])

    @classmethod
    def circle(cls, radius: float) -> SectionOutline:
        """A circle about the axis [m]."""
        return cls(vertices=np.zeros((1, 2)), radius=radius)

    @classmethod
    def hull(cls, points: ArrayLike) -> SectionOutline:
        """The convex hull of points, shape (n, 2) [m].

        Raises:
            ModelError: it has more than MOST_VERTICES, or does not enclose the axis.
        """
        return cls(vertices=_hull(np.asarray(points, float)))

    @property
    def sides(self) -> np.ndarray:
        """Vectors from every vertex to the next one, shape (m, 2) [m]."""
        return np.asarray(np.roll(self.vertices, -1, axis=0) - self.vertices)

    @property
    def box(self) -> np.ndarray:
        """Halves along y and z of the smallest box about the axis that holds it, shape (2,) [m]."""
        return np.asarray(np.abs(self.vertices).max(axis=0) + self.radius)

    @property
    def is_rectangle(self) -> bool:
        """True if the outline is a rectangle, its own bounding box."""
        return self.radius == 0 and self.vertices.shape == (4, 2) and bool((np.abs(self.vertices) == self.box).all())

    @property
    def perimeter(self) -> float:
        """Length of the outline [m]."""
        return float(np.linalg.norm(self.sides, axis=1).sum() + 2 * np.pi * self.radius)

    @property
    def area(self) -> float:
        """Area within [m^2]: that of the polygon, its perimeter times r, and pi r^2 (Steiner's formula)."""
        following = np.roll(self.vertices, -1, axis=0)
        polygon = _cross(self.vertices, following).sum() / 2
        return float(polygon + np.linalg.norm(self.sides, axis=1).sum() * self.radius + np.pi * self.radius**2)

    def support(self, directions: ArrayLike) -> np.ndarray:
        """The farthest points in some directions, both of shape (n, 2) [-, m]."""
        given = np.asarray(directions, float)
        unit = given / np.linalg.norm(given, axis=1, keepdims=True)
        return np.asarray(self.vertices[np.argmax(unit @ self.vertices.T, axis=1)] + self.radius * unit)

    def points(self, count: int) -> np.ndarray:
        """Points around it at equal distances along it, shape (count, 2) [m]."""
        lengths = np.linalg.norm(self.sides, axis=1)
        normals = np.array([[1.0, 0.0]])
        if len(self.vertices) > 1:
            normals = np.column_stack([self.sides[:, 1], -self.sides[:, 0]]) / lengths[:, None]
        angles = np.arctan2(normals[:, 1], normals[:, 0])
        turns = (np.roll(angles, -1) - angles) % (2 * np.pi) if len(angles) > 1 else np.array([2 * np.pi])
        # Side k, then the arc about its end.
        parts = np.column_stack([lengths, self.radius * turns]).ravel()
        ends = np.append(0.0, np.cumsum(parts))
        along = ends[-1] * np.arange(count) / count
        part = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(parts) - 1)
        rest, side = along - ends[part], part // 2
        share = rest / np.where(lengths[side] > 0, lengths[side], 1.0)
        straight = self.vertices[side] + share[:, None] * self.sides[side] + self.radius * normals[side]
        turned = angles[side] + (rest / self.radius if self.radius > 0 else 0.0)
        arc = np.roll(self.vertices, -1, axis=0)[side] + self.radius * np.column_stack([np.cos(turned), np.sin(turned)])
        return np.where((part % 2 == 0)[:, None], straight, arc)

    def scaled(self, size: float) -> SectionOutline:
        """The same outline `size` times as large."""
        return SectionOutline(vertices=self.vertices * size, radius=self.radius * size)

    def table(self) -> dict[str, object]:
        """Numbers of the outline as plain data [m]; `SectionOutline(**table)` is the same."""
        return {"vertices": self.vertices.tolist(), "radius": self.radius}

    def write(self, group: h5py.Group) -> None:
        """Write it into a group of an open file."""
        checked_file.dataset(group, "vertices", self.vertices, "m")
        group.attrs["radius"] = self.radius

    @classmethod
    def read(cls, group: h5py.Group) -> SectionOutline:
        """The outline in a group of an open file.

        Raises:
            ModelError: it is none.
        """
        return cls(vertices=group["vertices"][:].astype(float), radius=float(group.attrs["radius"]))

    @property
    def _has_axis(self) -> bool:
        """True if the axis lies within."""
        normals = np.column_stack([self.sides[:, 1], -self.sides[:, 0]])
        lengths = np.linalg.norm(self.sides, axis=1)
        if len(self.vertices) > 2:
            return bool(((normals * self.vertices).sum(axis=1) + self.radius * lengths > 0).all())
        share = np.clip(-(self.vertices[0] @ self.sides[0]) / max(lengths[0] ** 2, 1e-300), 0.0, 1.0)
        return bool(np.linalg.norm(self.vertices[0] + share * self.sides[0]) < self.radius)


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _turns(sides: np.ndarray) -> float:
    """Turning number of a closed line, counterclockwise [-]."""
    following = np.roll(sides, -1, axis=0)
    angles = np.arctan2(_cross(sides, following), (sides * following).sum(axis=1))
    return float(angles.sum() / (2 * np.pi))


def _hull(points: np.ndarray) -> np.ndarray:
    """Vertices of the convex hull, counterclockwise, without those on straight sides (Andrew's monotone chain)."""
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))]
    size = float(np.abs(points).max(initial=0.0))
    vertices: list[np.ndarray] = []
    for line in (ordered, ordered[::-1]):
        first = len(vertices)
        for point in line:
            while len(vertices) >= first + 2 and not _turns_left(vertices[-2], vertices[-1], point, size):
                vertices.pop()
            vertices.append(point)
        vertices.pop()
    return np.array(vertices)


def _turns_left(one: np.ndarray, two: np.ndarray, three: np.ndarray, size: float) -> bool:
    first, second = two - one, three - two
    return bool(first[0] * second[1] - first[1] * second[0] > STRAIGHT * size**2)

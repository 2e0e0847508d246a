"""A section's mesh of quadrilaterals in the plane (y, z), with its areas, moments and quality."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from rom.dataset.grid import SHARE

AROUND = [0, 1, 3, 2]  # corners in the order around a quadrilateral, of those in tensor order
RUBBER = -1  # tag of what belongs to no tendon


@dataclass(frozen=True, kw_only=True)
class PlaneMesh:
    """Quadrilaterals. Their sides are straight, but those that are arcs of a border of circles, see `curved`.

    Attributes:
        points: (y, z), shape (points, 2) [m].
        quads: corners in tensor order, right-handed, shape (quads, 4).
        tags: RUBBER, or the first tendon whose channel or hole it belongs to, shape (quads,).
        copies: how often the section has what is meshed: 2 of a half, else 1.
        curved: whether sides of the border are arcs about the axis: parabolas through the arcs' middles, as cells of
            order 2 have them.
    """

    points: np.ndarray
    quads: np.ndarray
    tags: np.ndarray
    copies: int = 1
    curved: bool = False

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners of the quadrilaterals, in the order around them, shape (quads, 4, 2) [m]."""
        return np.asarray(self.points[self.quads[:, AROUND]])

    @cached_property
    def bulges(self) -> np.ndarray:
        """Distances of the middles of quadrilaterals' sides from their chords, shape (quads, 4, 2) [m]."""
        here, after = self.corners, np.roll(self.corners, -1, axis=1)
        middle, radius = (here + after) / 2, np.linalg.norm(here, axis=2)
        if not self.curved:
            return np.zeros_like(middle)
        is_cut = np.maximum(np.abs(here[..., 1]), np.abs(after[..., 1])) == 0
        is_arc = self._on_border & ~is_cut & (np.abs(np.linalg.norm(after, axis=2) - radius) < SHARE * radius)
        length = np.where(is_arc, np.linalg.norm(middle, axis=2), 1.0)
        return np.where(is_arc, radius / length - 1, 0.0)[..., None] * middle

    @cached_property
    def _segments(self) -> np.ndarray:
        """Areas between the sides and their chords, two thirds of chord times bulge, shape (quads, 4) [m^2]."""
        return np.asarray(2 / 3 * _cross(self.bulges, np.roll(self.corners, -1, axis=1) - self.corners))

    @cached_property
    def areas(self) -> np.ndarray:
        """Areas of the quadrilaterals, shape (quads,) [m^2]: half the cross product of the diagonals plus segments."""
        a, b, c, d = self.corners.transpose(1, 0, 2)
        return np.asarray(_cross(c - a, d - b) / 2 + self._segments.sum(axis=1))

    @cached_property
    def centroids(self) -> np.ndarray:
        """Centroids of the quadrilaterals, shape (quads, 2) [m]."""
        here, after = self.corners, np.roll(self.corners, -1, axis=1)
        middle = here.mean(axis=1, keepdims=True)  # about which small cells far from the axis lose no digits
        here, after = here - middle, after - middle
        first = (_cross(here, after)[..., None] * (here + after)).sum(axis=1) / 6
        # The centroid of a parabola's segment is at 2/5 of its height.
        first += (self._segments[..., None] * ((here + after) / 2 + 0.4 * self.bulges)).sum(axis=1)
        return np.asarray(middle[:, 0] + first / self.areas[:, None])

    @cached_property
    def area(self) -> float:
        """Area of the whole section [m^2]."""
        return self.copies * float(self.areas.sum())

    def column_area(self, tag: int) -> float:
        """Area of the whole channel or hole with a tag [m^2]."""
        return self.copies * float(self.areas[self.tags == tag].sum())

    def column_centroid(self, tag: int) -> np.ndarray:
        """Centroid of the meshed part of a channel or hole, shape (2,) [m]; nan without cells."""
        own = self.tags == tag
        weights = self.areas[own, None]
        return np.asarray((weights * self.centroids[own]).sum(axis=0) / (weights.sum() if own.any() else np.nan))

    @property
    def centroid(self) -> np.ndarray:
        """Centroid of the meshed part, shape (2,) [m]."""
        return np.asarray((self.areas[:, None] * self.centroids).sum(axis=0) / self.areas.sum())

    @cached_property
    def second_moments(self) -> np.ndarray:
        """Integrals of y^2, z^2 and y z over a whole mesh of straight sides, about its centroid, shape (3,) [m^4]."""
        here = self.corners - self.centroid
        after = np.roll(here, -1, axis=1)
        cross = _cross(here, after)
        squares = here**2 + here * after + after**2
        (y, z), (yn, zn) = here.transpose(2, 0, 1), after.transpose(2, 0, 1)
        product = (y * zn + 2 * y * z + 2 * yn * zn + yn * z) / 2
        return np.array([(cross * part).sum() / 12 for part in (squares[..., 0], squares[..., 1], product)])

    @cached_property
    def edges(self) -> np.ndarray:
        """Lengths around every quadrilateral, shape (quads, 4) [m]."""
        along = np.roll(self.corners, -1, axis=1) - self.corners
        return np.hypot(along[..., 0], along[..., 1])

    @cached_property
    def scaled_jacobians(self) -> np.ndarray:
        """Least sine at a corner of every quadrilateral, negative where it is turned over, shape (quads,) [-]."""
        along = np.roll(self.corners, -1, axis=1) - self.corners
        lengths = np.maximum(self.edges, np.finfo(float).tiny)
        before = np.roll(along, 1, axis=1)
        return np.asarray((_cross(before, along) / (lengths * np.roll(lengths, 1, axis=1))).min(axis=1))

    @property
    def has_rectangles(self) -> bool:
        """True if all quadrilaterals are rectangles along y and z."""
        along = np.roll(self.corners, -1, axis=1) - self.corners
        return bool((np.abs(along).min(axis=2) <= 1e-12 * self.edges.max()).all())

    @cached_property
    def _sides(self) -> np.ndarray:
        """Ends of the sides around quadrilaterals, shape (quads, 4, 2)."""
        around = self.quads[:, AROUND]
        return np.stack([around, np.roll(around, -1, axis=1)], axis=2)

    @cached_property
    def _on_border(self) -> np.ndarray:
        """Which of these are of one quadrilateral alone, shape (quads, 4)."""
        pairs = np.sort(self._sides.reshape(-1, 2), axis=1)
        _, where, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
        return np.asarray(count[where.ravel()] == 1).reshape(-1, 4)

    @cached_property
    def border(self) -> np.ndarray:
        """Edges of one quadrilateral alone, in its own direction, shape (edges, 2)."""
        return np.asarray(self._sides[self._on_border])

    def of_order_2(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodes of cells of order 2, shape (nodes, 2) [m], and of quadrilaterals in tensor order, shape (quads, 9)."""
        count, quads = len(self.points), len(self.quads)
        pairs = np.sort(self._sides.reshape(-1, 2), axis=1)
        _, first, side = np.unique(pairs, axis=0, return_index=True, return_inverse=True)
        middles = (self.corners + np.roll(self.corners, -1, axis=1)) / 2 + self.bulges
        centres = self.corners.mean(axis=1) + self.bulges.sum(axis=1) / 2
        cells = np.empty((quads, 9), int)
        cells[:, [0, 2, 6, 8]] = self.quads
        cells[:, [1, 5, 7, 3]] = count + side.reshape(quads, 4)
        cells[:, 4] = count + len(first) + np.arange(quads)
        return np.concatenate([self.points, middles.reshape(-1, 2)[first], centres]), cells

    def contains(self, point: np.ndarray, tag: int) -> bool:
        """True if a point, shape (2,) [m], lies in a quadrilateral with a tag."""
        corners = self.corners[self.tags == tag]
        sides = _cross(np.roll(corners, -1, axis=1) - corners, point - corners)
        return bool((sides >= -1e-9 * self.edges.max() ** 2).all(axis=1).any())

    @cached_property
    def is_mirrored(self) -> bool:
        """True if z = 0 divides the mesh along its edges into two mirror images."""
        tolerance = SHARE * float(np.ptp(self.points, axis=0).max())
        mirror = self.points * [1, -1]
        away, _ = cKDTree(self.points).query(mirror)
        apart, other = cKDTree(self.centroids).query(self.centroids * [1, -1])
        z = self.corners[..., 1]
        crossed = (z.min(axis=1) < -tolerance) & (z.max(axis=1) > tolerance)
        alike = (self.tags == self.tags[other]).all()
        return bool(max(away.max(), apart.max()) < tolerance and not crossed.any() and alike)

    def half(self) -> PlaneMesh:
        """Half of the mesh, z >= 0, with z = 0 exactly at the cut."""
        quads, tags = self.quads[self.centroids[:, 1] > 0], self.tags[self.centroids[:, 1] > 0]
        used, renumbered = np.unique(quads, return_inverse=True)
        points = self.points[used].copy()
        points[np.abs(points[:, 1]) < SHARE * np.abs(self.points).max(), 1] = 0.0
        return replace(self, points=points, quads=renumbered.reshape(quads.shape), tags=tags, copies=2)

    def divided(self, parts: int) -> PlaneMesh:
        """The same with every quadrilateral divided into parts x parts."""
        if parts == 1:
            return self
        s = np.linspace(0.0, 1.0, parts + 1)
        t, s = np.meshgrid(s, s, indexing="ij")  # s, the first, runs fastest
        weights = np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t]).reshape(4, -1)
        points = np.einsum("cp,qci->qpi", weights, self.points[self.quads]).reshape(-1, 2)
        first = np.arange(len(points))
        pairs = cKDTree(points).query_pairs(1e-3 * float(self.edges.min()) / parts, output_type="ndarray")
        np.minimum.at(first, pairs[:, 1], pairs[:, 0])
        used, numbers = np.unique(first, return_inverse=True)
        local = np.arange(len(points)).reshape(-1, parts + 1, parts + 1)
        small = [local[:, :-1, :-1], local[:, :-1, 1:], local[:, 1:, :-1], local[:, 1:, 1:]]
        quads = numbers[np.stack(small, axis=-1).reshape(-1, 4)]
        return replace(self, points=points[used], quads=quads, tags=np.repeat(self.tags, parts**2))


def oriented(quads: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Quadrilaterals in tensor order, turned over where they are left-handed."""
    a, b, c, d = points[quads[:, AROUND]].transpose(1, 0, 2)
    return np.where((_cross(c - a, d - b) < 0)[:, None], quads[:, [0, 2, 1, 3]], quads)


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])

"""Squares and rectangles: a grid of lines along y and z that meet the channels' faces."""

import contextlib
import math
from typing import ClassVar, Literal

import numpy as np

from fingerfem.scene.scene_table import Length
from fingerfem.scene.sections.plane_mesh import RUBBER, PlaneMesh
from fingerfem.scene.sections.section import Column, Section, Wanted
from fingerfem.scene.subdivision import EQUAL, SLIVER, merged, subdivide

MORE = 40  # lines that are tried across the shorter side where fewer do not fit


class Rectangular(Section):
    """Base of square and rectangle; the axis is in the middle."""

    chamber_region: ClassVar[str | None] = "rectangle"

    @property
    def area(self) -> float:
        """Area of the section [m^2]."""
        return self.extents[0] * self.extents[1]

    @property
    def second_moment(self) -> float:
        """The least second moment of area [m^4]."""
        return max(self.extents) * min(self.extents) ** 3 / 12

    @property
    def depth(self) -> float:
        """The shorter side [m]."""
        return min(self.extents)

    @property
    def has_face(self) -> bool:
        """True if the section is flat at its top."""
        return True

    def refusal(self, column: Column, width: float) -> str | None:
        """The rule that a tendon's channel breaks, if any."""
        reach = (np.array(self.extents) - width) / 2
        if (np.abs(column.offset) <= reach * (1 + 1e-9)).all():
            return None
        limits = f"{reach[0]:g}" if self.is_square else f"{reach[0]:g} m along y and {reach[1]:g}"
        return f"must keep its channel inside the section (at most {limits} m from the axis)"

    def are_apart(self, one: Column, other: Column, width: float) -> bool:
        """True if two channels have no cells in common."""
        return bool(np.abs(one.offset - other.offset).max() >= width * (1 - 1e-9))

    @property
    def is_square(self) -> bool:
        """True for a square: then lines along y and z are the same if tendons pull in both directions."""
        return self.extents[0] == self.extents[1]

    def lines(self, wanted: Wanted) -> tuple[np.ndarray, np.ndarray]:
        """Grid lines along y and z [m]; z begins at 0 where a half is meshed.

        Raises:
            ValueError: as in `mesh`.
        """
        if self.is_square and not wanted.is_planar:
            # The same for both, so that mirrored pulls give mirrored states.
            y = _fitted(_both(self._edges(wanted, 0, 1)), wanted.across, is_longest=True)
            return y, y
        along_y, along_z = (math.ceil(wanted.across * length / self.extent * (1 - EQUAL)) for length in self.extents)
        y = _fitted(_both(self._edges(wanted, 0)), along_y, is_longest=along_y == wanted.across)
        edges, is_longest = self._edges(wanted, 1), along_z == wanted.across
        if not wanted.is_planar:
            return y, _fitted(_both(edges), along_z, is_longest)
        half = _fitted(np.unique([0.0, *edges]), (along_z + 1) // 2, is_longest, is_symmetric=False)
        return y, half if wanted.half else np.concatenate([-half[:0:-1], half])

    def mesh(self, wanted: Wanted) -> PlaneMesh:
        """Grid as quadrilaterals: y runs fastest."""
        y, z = self.lines(wanted)
        points = np.stack(np.meshgrid(y, z), axis=-1).reshape(-1, 2)
        at = np.arange(len(points)).reshape(len(z), len(y))
        quads = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]], axis=-1).reshape(-1, 4)
        centres, tags = points[quads].mean(axis=1), np.full(len(quads), RUBBER)
        for column in wanted.columns:
            tags[(np.abs(centres - column.offset) < wanted.width / 2).all(axis=1)] = column.tag
        for cavity in wanted.cavities:
            tags[(np.abs(centres - cavity.centre) < cavity.size / 2).all(axis=1)] = cavity.tag
        return PlaneMesh(points=points, quads=quads, tags=tags, copies=2 if wanted.half else 1)

    def _edges(self, wanted: Wanted, *axes: int) -> list[float]:
        """Distances from the axis, along y (0) or z (1) or both, that must lie on grid lines, ascending [m].

        The axis itself is one of them, 0, where a channel ends there.
        """
        blocks = [(column.offset, np.full(2, wanted.width)) for column in wanted.columns]
        blocks += [(cavity.centre, cavity.size) for cavity in wanted.cavities]
        blocks += [(inlay.centre, inlay.size) for inlay in wanted.inlays if inlay.region == "rectangle"]
        edges = [
            abs(float(middle[axis] + side * size[axis] / 2))
            for axis in axes
            for middle, size in blocks
            for side in (-1, 1)
        ]
        if 1 in axes and wanted.pad is not None:
            edges.append(wanted.pad / 2)
        equal = EQUAL * self.extent
        lines = merged([0.0, self.extents[axes[0]] / 2], sorted(edges), equal)
        return lines if min(edges) <= equal else lines[1:]


class Square(Rectangular):
    """A square: the same as `geometry.side`."""

    shape: Literal["square"] = "square"
    side: Length

    @property
    def extents(self) -> tuple[float, float]:
        """Height along y and width along z [m]."""
        return self.side, self.side


class Rectangle(Rectangular):
    """A rectangle."""

    shape: Literal["rectangle"]
    height: Length  # along y
    width: Length  # along z

    @property
    def extents(self) -> tuple[float, float]:
        """Height along y and width along z [m]."""
        return self.height, self.width


def _fitted(breakpoints: np.ndarray, cells: int, is_longest: bool, is_symmetric: bool = True) -> np.ndarray:
    """Grid lines for a number of cells; across the shorter side, for the fewest from there on that fit."""
    for more in range(0 if is_longest else MORE):
        with contextlib.suppress(ValueError):
            return _no_slivers(subdivide(breakpoints, cells + more, symmetric=is_symmetric))
    return _no_slivers(subdivide(breakpoints, cells, symmetric=is_symmetric))


def _both(edges: list[float]) -> np.ndarray:
    """Distances from the axis on both sides of it."""
    return np.array([-edge for edge in reversed(edges) if edge > 0] + edges)


def _no_slivers(lines: np.ndarray) -> np.ndarray:
    thinnest, mean = np.diff(lines).min(), (lines[-1] - lines[0]) / (len(lines) - 1)
    if thinnest < mean / SLIVER:
        raise ValueError(
            f"must not be forced to cells thinner than 1/{SLIVER} of the mean, {mean:.3g} m, by channels, chambers, "
            f"materials or a pad that almost touch, got {thinnest:.3g} m"
        )
    return lines

"""Base of all sections: a table of a scene that has its measures and makes its mesh."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fingerfem.scene.scene_table import SceneTable
from fingerfem.scene.sections.plane_mesh import AROUND, PlaneMesh

POOREST = 0.2  # least sine at a corner of a quadrilateral that is meshed [-]


@dataclass(frozen=True, kw_only=True)
class Column:
    """Cells of the section's mesh for a tendon: those of its channel, or of its hole in a plate.

    Attributes:
        name, path: the tendon's.
        offset: (y, z), shape (2,) [m].
        tag: the first tendon that has the same cells.
    """

    name: str
    path: str
    offset: np.ndarray
    tag: int


@dataclass(frozen=True, kw_only=True)
class Inside:
    """Part inside a section that is no tendon's.

    Attributes:
        name: the chamber's or the material's.
        region: "rectangle", "bore", "group" or "section".
        centre, size: of a rectangle along (y, z), shape (2,) [m].
        tag: below RUBBER, of the cells that are a chamber's or a group's alone.
    """

    name: str
    region: str
    centre: np.ndarray
    size: np.ndarray
    tag: int


class Cavity(Inside):
    """Cells of the section's mesh for a chamber, which the finger lacks along the chamber.

    Chambers of one region have the tag of the first.
    """


class Inlay(Inside):
    """Cells of the section's mesh for another material; it may share them with a tendon, unless it is a group."""


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """Requirements on a section's mesh.

    Attributes:
        columns: of the tendons.
        width: of a channel [m].
        across: cells across the largest extent; of a file, parts of every edge.
        pad: width of the pad [m], if it has one of its own.
        half: whether the half z >= 0 is meshed.
        cavities: of the chambers.
        inlays: of the other materials.
        curved: whether cells may have curved sides, as those of order 2.
    """

    columns: Sequence[Column]
    width: float
    across: int
    pad: float | None = None
    half: bool = False
    cavities: Sequence[Cavity] = ()
    inlays: Sequence[Inlay] = ()
    curved: bool = False

    @property
    def is_planar(self) -> bool:
        """True if everything inside makes the section's two halves mirror images."""
        inside: list[Inside] = [*self.cavities, *self.inlays]
        mirrored = all(one.centre[1] == 0 for one in inside)
        return mirrored and all(column.offset[1] == 0 for column in self.columns)


class Section(SceneTable):
    """A section of the finger; measures are those at the clamp.

    A new shape is a class with these members, named in `sections.SHAPES`.
    """

    meshed_by: ClassVar[str] = "mesh.cells[1]"  # the key that errors of its mesh name
    chamber_region: ClassVar[str | None] = None  # the region that a chamber may have, if any
    shape: str

    @property
    def extents(self) -> tuple[float, float]:
        """Height along y and width along z [m]."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Area of the section [m^2]."""
        raise NotImplementedError

    @property
    def second_moment(self) -> float:
        """The least second moment of area [m^4]."""
        raise NotImplementedError

    @property
    def channel_width(self) -> float:
        """Width of a channel, unless the scene gives it [m]."""
        return min(self.extents) / 5

    @property
    def extent(self) -> float:
        """The largest extent [m], which steps, tolerances and shortest cells are measured against."""
        return max(self.extents)

    @property
    def depth(self) -> float:
        """sqrt(12 I / A), the side of a square that bends alike [m]: cells along the axis lock in bending by it."""
        return math.sqrt(12 * self.second_moment / self.area)

    @property
    def top(self) -> float:
        """The largest y [m], on which the plane y = top + d faces the finger."""
        return self.extents[0] / 2

    @property
    def is_square(self) -> bool:
        """True for a square."""
        return False

    @property
    def is_round(self) -> bool:
        """True if the border consists of circles, which cells of order 2 follow."""
        return False

    @property
    def has_face(self) -> bool:
        """True if the section is flat at its top, so that a pad may lie there."""
        return False

    @property
    def is_mirrored(self) -> bool:
        """True if z = 0 divides its meshes into mirror images, where all tendons lie there."""
        return True

    def refusal(self, column: Column, width: float) -> str | None:
        """The rule that a tendon's channel breaks in this section, if any."""
        raise NotImplementedError

    def are_apart(self, one: Column, other: Column, width: float) -> bool:
        """True if two channels have no cells in common."""
        raise NotImplementedError

    def mesh(self, wanted: Wanted) -> PlaneMesh:
        """Mesh of the section.

        Raises:
            ValueError: rule and value of what does not fit, to be put after `meshed_by`.
        """
        raise NotImplementedError


def check_quality(mesh: PlaneMesh) -> PlaneMesh:
    """The same mesh.

    Raises:
        ValueError: a quadrilateral is too far from a rectangle.
    """
    quality = mesh.scaled_jacobians
    if quality.min() < POOREST:
        y, z = mesh.centroids[int(quality.argmin())]
        raise ValueError(
            f"must give quadrilaterals with a sine of at least {POOREST} at every corner, as more cells may do, "
            f"got {quality.min():.3g} at y = {y:.3g}, z = {z:.3g} m"
        )
    return mesh


def check_cavities(mesh: PlaneMesh, cavities: Sequence[Cavity]) -> PlaneMesh:
    """The same mesh.

    Raises:
        ValueError: a chamber has no cells, lies at the border, or touches another one.
    """
    if not cavities:
        return mesh
    outside = mesh.border[np.abs(mesh.points[mesh.border, 1]).max(axis=1) > 1e-9 * np.abs(mesh.points).max()]
    points = {one.tag: np.unique(mesh.quads[mesh.tags == one.tag]) for one in cavities}
    for one in cavities:
        around, own = mesh.quads[:, AROUND], mesh.tags == one.tag
        sides = np.sort(np.stack([around, np.roll(around, -1, axis=1)], axis=2)[own].reshape(-1, 2), axis=1)
        open_sides = (np.sort(outside, axis=1)[:, None] == sides[None]).all(axis=2).any(axis=1)
        if not own.any() or open_sides.any():
            raise ValueError(
                f"must have cells of chamber {one.name}, with rubber all around them, got {int(own.sum())} cells, "
                f"{int(open_sides.sum())} of their edges at the border"
            )
        for other in cavities:
            if other.tag != one.tag and np.intersect1d(points[one.tag], points[other.tag]).size:
                raise ValueError(f"must have rubber between chambers, got {one.name} beside {other.name}")
    return mesh


def material_of(mesh: PlaneMesh, inlay: Inlay) -> np.ndarray:
    """True for quadrilaterals of another material where it is present, shape (quads,).

    Raises:
        ValueError: it has none.
    """
    if inlay.region == "section":
        return np.ones(len(mesh.quads), bool)
    inside = mesh.tags == inlay.tag
    if inlay.region == "rectangle":
        inside = (np.abs(mesh.centroids - inlay.centre) < inlay.size / 2).all(axis=1)
    if not inside.any():
        raise ValueError(f"must have cells of material {inlay.name}, as more cells or a larger size may do, got none")
    return np.asarray(inside)

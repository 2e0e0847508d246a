"""The tables of a scene. Leave one out and it is not modelled, sampled or stored."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from fingerfem.scene.scene_table import Length, SceneTable
from fingerfem.scene.sections import FromFile, Section, Square
from rom.dataset import geometry

Offset = Annotated[float, Field(ge=-1.0, le=1.0)]  # [m]
Position = Annotated[float, Field(ge=0, le=8.0)]  # [m], on eight segments at most
Force = Annotated[float, Field(ge=0, le=1e4)]  # [N]


STEEPEST = 0.5  # change of the side per length of a segment's rubber [-]


class Geometry(SceneTable):
    """The finger along x, clamped at x = 0; each segment ends in a plate.

    Side, plate, channel and the tendons' offsets are those at the clamp. A tapered section is scaled as a whole. The
    scene puts in the section that it has a table of; the side is then its largest extent.
    """

    section: Section | None = Field(default=None, exclude=True)
    side: Length
    segments: Annotated[list[Length], Field(min_length=1, max_length=8)]
    plate: Length
    channel: Length | None = None  # width of the block of cells that carries a tendon; side / 5 of a square if absent
    taper: list[Annotated[float, Field(gt=0)]] | None = None  # of a segment: its side at the end over that at its begin

    @property
    def shape(self) -> Section:
        """The section; without a table of its own, the square of the given side."""
        return Square(side=self.side) if self.section is None else self.section

    @property
    def channel_width(self) -> float:
        """Width of a tendon's channel [m]."""
        return self.shape.channel_width if self.channel is None else self.channel

    @property
    def sizes(self) -> np.ndarray:
        """Sizes of the segments' plates over those of a finger without taper, shape (segments,) [-]."""
        return geometry.sizes_of(self.model_dump())[1:]

    @property
    def thinnest(self) -> float:
        """Least size of a section over that at the clamp [-]."""
        return float(self.sizes.min(initial=1.0))

    @property
    def thinnest_area(self) -> float:
        """Least area of a section [m^2]."""
        return self.shape.area * self.thinnest**2

    @property
    def is_tapered(self) -> bool:
        """True if sections differ in size."""
        return bool((self.sizes != 1).any())

    @property
    def plates(self) -> list[tuple[float, float]]:
        """Start and end of every segment's plate along x [m]."""
        return [(float(begin), float(end)) for begin, end in geometry.plates_of(self.model_dump())]

    def size_at(self, x: np.ndarray) -> np.ndarray:
        """Size of the sections at x [m] over that at the clamp [-]: linear along the rubber, constant in plates."""
        return geometry.size_at(self.model_dump(), x)

    @property
    def half_lengths(self) -> np.ndarray:
        """Half lengths of every plate along its own axes, shape (segments, 3) [m]."""
        return np.outer(self.sizes, [self.plate, *self.shape.extents]) / 2

    @property
    def length(self) -> float:
        """Length of the whole finger [m]."""
        return sum(self.segments)

    @model_validator(mode="before")
    @classmethod
    def _has_the_section_s_extent(cls, table: Any) -> Any:
        if not isinstance(table, dict) or not isinstance(table.get("section"), Section):
            return table
        if "side" in table:
            raise ValueError(f"side must be left out where [section] gives the section, got {table['side']}")
        return table | {"side": table["section"].extent}

    @model_validator(mode="after")
    def _nothing_vanishes(self) -> Geometry:
        if isinstance(self.section, FromFile) and self.channel is not None:
            raise ValueError(f"channel must be left out where section.file has the channels, got {self.channel}")
        for name, value in (("plate", self.plate), ("channel", self.channel_width)):
            if value < self.side / 100:
                raise ValueError(f"{name} must be at least a hundredth of the side ({self.side} m), got {value}")
        return self

    @model_validator(mode="after")
    def _plate_fits(self) -> Geometry:
        if self.taper is not None and len(self.taper) != len(self.segments):
            raise ValueError(f"taper must have one ratio per segment ({len(self.segments)}), got {len(self.taper)}")
        begin = 1.0
        for length, size in zip(self.segments, self.sizes.tolist(), strict=True):
            if size * self.plate >= length:
                raise ValueError(f"plate must be shorter than every segment ({length} m), got {size * self.plate}")
            slope = self.side * abs(size - begin) / (length - size * self.plate)
            if slope > STEEPEST:
                raise ValueError(f"taper must change the side by at most {STEEPEST} m per m of rubber, got {slope:.3g}")
            begin = size
        return self

    @model_serializer(mode="wrap")
    def _without_taper(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """A finger without taper is as it was before there was any; a section that is no square has a table."""
        left_out = {"taper"} if self.taper is None else set()
        left_out |= set() if self.shape.is_square else {"side"}
        return {key: value for key, value in serialise(self).items() if key not in left_out}


class Placed(SceneTable):
    """Part with a region in the section: a rectangle has a centre and a size, others have neither."""

    region: str
    centre: Annotated[list[Offset], Field(min_length=2, max_length=2)] | None = None  # of a rectangle, (y, z) [m]
    size: Annotated[list[Length], Field(min_length=2, max_length=2)] | None = None  # of it, along y and z [m]

    @property
    def is_mirrored(self) -> bool:
        """True if the part is its own mirror image in z = 0; for a group, the file decides."""
        return self.centre is None or self.centre[1] == 0

    @model_validator(mode="after")
    def _is_placed(self) -> Placed:
        for key in ("centre", "size"):
            given = getattr(self, key)
            if self.region == "rectangle" and given is None:
                raise ValueError(f"{key} must be given where region is 'rectangle', got none")
            if self.region != "rectangle" and given is not None:
                raise ValueError(f"{key} must be left out where region is {self.region!r}, got {given}")
        return self


class Tendon(SceneTable):
    """A tendon parallel to the axis, anchored in the clamp and in a segment's plate.

    In its channel it slides without friction; a straight one runs freely from the plate to the clamp.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    path: Literal["channel", "straight"] = "channel"
    offset: Annotated[list[Offset], Field(min_length=2, max_length=2)]  # (y, z) [m]
    segment: Annotated[int, Field(ge=1)]
    tension: Annotated[list[Force], Field(min_length=2, max_length=2)]  # [lowest, highest] [N]


class Pad(SceneTable):
    """A tactile pad: a patch of the face towards the plane, across the finger or centred of the given width."""

    name: str
    x: Annotated[list[Position], Field(min_length=2, max_length=2)]  # from, to along the axis at rest [m]
    width: Length | None = None


RubberDensity = Annotated[float, Field(ge=10, le=3e4)]  # [kg/m^3]; below, it is meant in g/cm^3
PlateDensity = Annotated[float, Field(ge=0, le=3e4)]  # [kg/m^3]
STEEL_DENSITY = 7850.0  # [kg/m^3]


class Density(SceneTable):
    """Densities [kg/m^3], of which weight and inertia are."""

    rubber: RubberDensity
    plates: PlateDensity = STEEL_DENSITY


class Gravity(SceneTable):
    """The weight of the finger: a dead load on rubber and plates, which is there before any tension.

    Densities stand here, or in a table [density].
    """

    density: RubberDensity | None = None
    plate_density: PlateDensity = STEEL_DENSITY
    direction: Annotated[list[float], Field(min_length=3, max_length=3)]  # in which weight pulls, of any length [-]
    acceleration: Annotated[float, Field(ge=0, le=1e4)] = 9.80665  # standard gravity [m/s^2]

    @property
    def vector(self) -> np.ndarray:
        """Acceleration as a vector seen from the clamp, shape (3,) [m/s^2]."""
        return self.acceleration * np.array(self.direction) / np.linalg.norm(self.direction)

    @model_validator(mode="after")
    def _points_somewhere(self) -> Gravity:
        if not 1e-6 < np.linalg.norm(self.direction) < 1e6:
            raise ValueError(f"direction must have a length from 1e-6 to 1e6, got {self.direction}")
        return self


WRENCH = (("fx", "N"), ("fy", "N"), ("fz", "N"), ("mx", "N m"), ("my", "N m"), ("mz", "N m"))


class Load(SceneTable):
    """Loads of the plates, in place of an obstacle: forces of any direction, anywhere on a plate."""

    force: Annotated[float, Field(gt=0, le=1e4)]  # largest on a plate [N]
    friction_angle: Annotated[float, Field(ge=0, le=1.5)] = 0.0  # most between a force and its surface's normal [rad]
    reach: Annotated[float, Field(ge=0, le=1.0)] = 0.0  # of a segment that follows, through which forces act too [m]
    moment: Annotated[float, Field(ge=0, le=1e4)] = 0.0  # largest beside a force, as a longer finger transmits [N m]

    def parameters(self, geometry: Geometry) -> list[dict[str, Any]]:
        """Name, unit, lowest and highest value of the wrenches' components, plate by plate from clamp to tip."""
        arms = np.maximum(geometry.half_lengths, self.reach)
        highest = self.force * np.array([[1, 1, 1, *(np.hypot(*np.delete(own, i)) for i in range(3))] for own in arms])
        highest[:, 3:] = np.maximum(highest[:, 3:], self.moment)
        plates = [str(k + 1) for k in range(len(geometry.segments))] if len(geometry.segments) > 1 else [""]
        return [
            {"name": name + plate, "unit": unit, "lower": -float(most), "upper": float(most)}
            for plate, own in zip(plates, highest, strict=True)
            for (name, unit), most in zip(WRENCH, own, strict=True)
        ]


class Mesh(SceneTable):
    """Hexahedra: cells along the longest segment, cells across the side, Lagrange order."""

    cells: Annotated[list[Annotated[int, Field(ge=1, le=4000)]], Field(min_length=2, max_length=2)]
    order: Annotated[int, Field(ge=1, le=2)] = 1
    symmetry: bool | None = None  # model the half z >= 0; if absent, wherever all tendons lie in the plane z = 0


Quantity = Literal["displacement", "pad_pressure", "channel_shortening"]


class Sampling(SceneTable):
    """Density of the parameters' sampling for training: nodes along every tension and along contact, a grid.

    A scene with a load has `lines` at tensions of their own in place of a grid, each of a free state and of `wrenches`
    pressed ones. Tip, contact force and touch distance of a state, or its plates' poses, are always kept; `store` says
    what else.
    """

    lines: Annotated[int, Field(ge=3, le=10_000)] | None = None
    tension_nodes: Annotated[int, Field(ge=4, le=101)] = 9
    contact_nodes: Annotated[int, Field(ge=4, le=101)] = 12
    wrenches: Annotated[int, Field(ge=1, le=100)] = 4
    store: list[Quantity] = ["displacement"]


class Coarse(SceneTable):
    """A mesh on which states are cheap: `--coarse` solves them; those on the scene's own mesh begin at or correct them.

    `lines` is how many; if absent, as many as the scene's sampling has.
    """

    cells: Annotated[list[Annotated[int, Field(ge=1, le=4000)]], Field(min_length=2, max_length=2)]
    order: Annotated[int, Field(ge=1, le=2)] = 1
    lines: Annotated[int, Field(ge=3, le=10_000)] | None = None


class Expected(SceneTable):
    """Expected error and cost of the mesh and lines that an accuracy, a budget or a preset chose, see presets.

    The error is relative [-], of the contact force or, where nothing touches, of the displacement, at the 95th
    percentile of states on the finger that the front was measured on. No error is expected with more tendons than were
    measured. A scene without a load has no cost here: its error is that of rod elements on this mesh.
    """

    quantity: Literal["contact_force", "displacement"]
    error: float | None = None
    core_seconds: float | None = None
    states: int | None = None

    @model_validator(mode="before")
    @classmethod
    def _known(cls, table: Any) -> Any:
        """Sets and models of older versions have more."""
        return {key: table[key] for key in cls.model_fields if key in table} if isinstance(table, dict) else table

    def __str__(self) -> str:
        quantity = self.quantity.replace("_", " ")
        promise = f"no error of the {quantity} is promised with so many tendons: rom build estimates it"
        if self.error is not None:
            promise = f"{quantity} within {100 * self.error:.2g} % at the 95th percentile"
        if self.core_seconds is None:
            return f"of rod elements on this mesh: {promise}"
        return f"{promise}, {self.states} states, {self.core_seconds / 60:.2g} core-minutes"

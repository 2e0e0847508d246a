"""The tables of a scene. Leave one out and it is not modelled, sampled or stored."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from fingerfem.scene.laws import Table

Length = Annotated[float, Field(ge=1e-6, le=1.0)]  # [m]; a length above 1 m is a length in mm
Distance = Annotated[float, Field(gt=0, le=1.0)]  # [m]
Offset = Annotated[float, Field(ge=-1.0, le=1.0)]  # [m]
Position = Annotated[float, Field(ge=0, le=2.0)]  # [m]
Force = Annotated[float, Field(ge=0, le=1e4)]  # [N]


class Geometry(Table):
    """The finger along x, clamped at x = 0, of square section; each segment ends in a plate."""

    side: Length
    segments: Annotated[list[Length], Field(min_length=1, max_length=2)]
    plate: Length
    channel: Length | None = None  # width of the square column of cells that carries a tendon; side / 5 if absent

    @property
    def channel_width(self) -> float:
        """Width of a tendon's channel [m]."""
        return self.side / 5 if self.channel is None else self.channel

    @property
    def length(self) -> float:
        """Length of the whole finger [m]."""
        return sum(self.segments)

    @model_validator(mode="after")
    def _nothing_vanishes(self) -> Geometry:
        for name, value in (("plate", self.plate), ("channel", self.channel_width)):
            if value < self.side / 100:
                raise ValueError(f"{name} must be at least a hundredth of the side ({self.side} m), got {value}")
        return self

    @model_validator(mode="after")
    def _plate_fits(self) -> Geometry:
        for length in self.segments:
            if self.plate >= length:
                raise ValueError(f"plate must be shorter than every segment ({length} m), got {self.plate}")
        return self


class Tendon(Table):
    """A tendon parallel to the axis, anchored in the clamp and in a segment's plate.

    In its channel it slides without friction; a straight one runs freely from the plate to the clamp.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
    path: Literal["channel", "straight"] = "channel"
    offset: Annotated[list[Offset], Field(min_length=2, max_length=2)]  # (y, z) [m]
    segment: Annotated[int, Field(ge=1)]
    tension: Annotated[list[Force], Field(min_length=2, max_length=2)]  # [lowest, highest] [N]


class Pad(Table):
    """A tactile pad: a patch of the face towards the plane, across the finger or centred of the given width."""

    name: str
    x: Annotated[list[Position], Field(min_length=2, max_length=2)]  # from, to along the axis at rest [m]
    width: Length | None = None


class Obstacle(Table):
    """A frictionless rigid plane y = side/2 + d."""

    distance: Annotated[list[Distance], Field(min_length=2, max_length=2)]  # [nearest, farthest] [m]
    method: Literal["penalty", "nitsche"]
    stiffness: Annotated[float, Field(ge=1, le=1e6)] | None = None  # of contact, times mesh size over a modulus [-]
    pad: Pad | None = None

    @property
    def stiffness_factor(self) -> float:
        """The stiffness asked for, or the method's own [-]."""
        return self.stiffness or {"penalty": 2000.0, "nitsche": 1000.0}[self.method]


class Mesh(Table):
    """Hexahedra: cells per segment along the axis, cells across the side, Lagrange order."""

    cells: Annotated[list[Annotated[int, Field(ge=1, le=4000)]], Field(min_length=2, max_length=2)]
    order: Annotated[int, Field(ge=1, le=2)] = 1
    symmetry: bool | None = None  # model the half z >= 0; if absent, wherever all tendons lie in the plane z = 0


Quantity = Literal["displacement", "pad_pressure", "channel_shortening"]


class Sampling(Table):
    """How finely the parameters are sampled for training: nodes along every tension and along contact.

    Or `lines` of states at scattered tensions, whose number does not grow like a grid's; three or more tensions are
    sampled by these unless `tension_nodes` are given. Tip, contact force and touch distance of a state are always kept;
    `store` says what else.
    """

    lines: Annotated[int, Field(ge=3, le=10_000)] | None = None
    tension_nodes: Annotated[int, Field(ge=4, le=101)] = 9
    contact_nodes: Annotated[int, Field(ge=4, le=101)] = 12
    store: list[Quantity] = ["displacement"]


class Expected(Table):
    """What the mesh, sampling and terms that an accuracy, a budget or a preset chose are expected to give, see presets.

    Errors are relative [-], of the contact force or, without an obstacle, of the displacement, at the 95th
    percentile of states on the finger that the front was measured on.
    """

    quantity: Literal["contact_force", "displacement"]
    error: float
    error_of_mesh: float
    error_of_surrogate: float
    core_seconds: float
    states: int
    tolerance: float

    def __str__(self) -> str:
        shares = [f"{100 * share:.2g} %" for share in (self.error, self.error_of_mesh, self.error_of_surrogate)]
        return (
            f"{self.quantity.replace('_', ' ')} within {shares[0]} at the 95th percentile ({shares[1]} of the mesh, "
            f"{shares[2]} of the surrogate), {self.states} states, {self.core_seconds / 60:.2g} core-minutes"
        )


class Outline(NamedTuple):
    """What the mesh's grid lines have to meet, and who lies where between them."""

    geometry: Geometry
    tendons: Sequence[Tendon]
    pad: Pad | None

    @property
    def is_planar(self) -> bool:
        """Whether all tendons lie in the plane z = 0, so that the finger's two halves are mirror images."""
        return all(tendon.offset[1] == 0 for tendon in self.tendons)

    @property
    def plates(self) -> list[tuple[float, float]]:
        """Where every segment's plate begins and ends along x [m]."""
        ends = accumulate(self.geometry.segments)
        return [(end - self.geometry.plate, end) for end in ends]

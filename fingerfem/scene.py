"""What is modelled: a scene and its rules. Leave a table out and it is not modelled, sampled or stored."""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from fingerfem.choice import KEYS, chosen
from fingerfem.grid import fitting, grid_lines
from fingerfem.laws import Law, MooneyRivlin, NeoHookean, SaintVenantKirchhoff, Table

Length = Annotated[float, Field(ge=1e-6, le=1.0)]  # [m]; a length above 1 m is a length in mm
Distance = Annotated[float, Field(gt=0, le=1.0)]  # [m]
Offset = Annotated[float, Field(ge=-1.0, le=1.0)]  # [m]
Position = Annotated[float, Field(ge=0, le=2.0)]  # [m]
Force = Annotated[float, Field(ge=0, le=1e4)]  # [N]


NOT_OF_THE_FINGER = {"name", "sampling", "expected", *KEYS}


class SceneError(ValueError):
    """A scene that breaks a rule: one line naming file, field, rule and value."""


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
    """What the mesh, sampling and terms that an accuracy, a budget or a preset chose are expected to give, see choice.

    Errors are relative [-], of the contact force or, without an obstacle, of the displacement, and kept by 95 % of
    states on the finger that the front was measured on.
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
            f"{self.quantity.replace('_', ' ')} within {shares[0]} in 95 % of states ({shares[1]} of the mesh, "
            f"{shares[2]} of the surrogate), {self.states} states, {self.core_seconds / 60:.2g} core-minutes"
        )


class Scene(Table):
    """One scene: everything the full-order model needs to know.

    In place of mesh and sampling it may have `accuracy` ("1 %" of the contact force), `budget` ("20min" of core time)
    or `preset`; what these chose is then `mesh`, `sampling` and `expected`.
    """

    name: str
    accuracy: str | None = None
    budget: str | None = None
    preset: str | None = None
    expected: Expected | None = None
    geometry: Geometry
    material: Annotated[NeoHookean | MooneyRivlin | SaintVenantKirchhoff, Field(discriminator="law")]
    tendons: Annotated[list[Tendon], Field(min_length=1, max_length=8)]
    obstacle: Obstacle | None = None
    mesh: Mesh
    sampling: Sampling = Sampling()

    @model_validator(mode="before")
    @classmethod
    def _choose(cls, table: Any) -> Any:
        if not isinstance(table, dict):
            return table
        if table.get("expected") is not None:  # it was chosen when it was written
            if not any(table.get(key) for key in KEYS):
                raise ValueError(f"expected must be left out where no {' or '.join(KEYS)} chooses it, got a table")
            return table
        return chosen(table, lambda cells: cls._fitting(table, cells))

    @classmethod
    def _fitting(cls, table: dict[str, Any], across: int) -> int:
        """The fewest cells across, from the given number on, that fit this finger's channels and pad."""
        try:
            finger = cls.model_construct(
                geometry=Geometry.model_validate(table["geometry"]),
                tendons=[Tendon.model_validate(tendon) for tendon in table["tendons"]],
                obstacle=Obstacle.model_validate(table["obstacle"]) if table.get("obstacle") else None,
            )
        except (KeyError, TypeError, ValueError):
            return across  # what is wrong with the finger is told as such
        return fitting(finger, across)

    @model_validator(mode="after")
    def _tables_agree(self) -> Scene:
        names = [tendon.name for tendon in self.tendons]
        width = self.geometry.channel_width
        reach = self.geometry.side / 2 - width / 2
        for k, tendon in enumerate(self.tendons):
            if tendon.name == "d" or names.count(tendon.name) > 1:
                raise ValueError(f"tendons.{k}.name must be unique and not d, got {tendon.name}")
            if tendon.segment > len(self.geometry.segments):
                raise ValueError(
                    f"tendons.{k}.segment must be at most {len(self.geometry.segments)}, the number of segments, "
                    f"got {tendon.segment}"
                )
            if max(abs(value) for value in tendon.offset) > reach * (1 + 1e-9):
                raise ValueError(
                    f"tendons.{k}.offset must keep its channel inside the section (at most {reach:g} m from the axis), "
                    f"got {tendon.offset}"
                )
            for other in self.tendons[:k]:
                apart = max(abs(a - b) for a, b in zip(tendon.offset, other.offset, strict=True))
                if apart < width * (1 - 1e-9):
                    raise ValueError(
                        f"tendons.{k}.offset must keep channels apart (geometry.channel is {width:g} m wide), "
                        f"got {tendon.offset} beside {other.name} at {other.offset}"
                    )
            _ordered(f"tendons.{k}.tension", tendon.tension)
        if self.mesh.symmetry and not self.planar:
            raise ValueError("mesh.symmetry must be false where a tendon is off the plane z = 0, got true")
        if self.obstacle is not None:
            self._check_obstacle(self.obstacle)
        grid_lines(self)
        return self

    @model_validator(mode="after")
    def _pressure_has_a_pad(self) -> Scene:
        if "pad_pressure" in self.sampling.store and (self.obstacle is None or self.obstacle.pad is None):
            raise ValueError("sampling.store must not ask for pad_pressure of a scene without obstacle.pad")
        return self

    def _check_obstacle(self, obstacle: Obstacle) -> None:
        _ordered("obstacle.distance", obstacle.distance)
        if obstacle.method == "nitsche" and self.material.is_mixed:
            raise ValueError(
                "obstacle.method must be penalty where the rubber is nearly incompressible: its stress on the surface, "
                "which nitsche needs, is not that of the displacements, got nitsche"
            )
        if obstacle.method == "nitsche" and obstacle.stiffness_factor < 20:
            raise ValueError(
                "obstacle.stiffness must be at least 20 for nitsche, below which its potential has no minimum, "
                f"got {obstacle.stiffness_factor:g}"
            )
        if obstacle.pad is not None:
            _ordered("obstacle.pad.x", obstacle.pad.x)
            least = self.geometry.side / 100
            if min(obstacle.pad.x[1] - obstacle.pad.x[0], obstacle.pad.width or least) < least * (1 - 1e-9):
                raise ValueError(
                    f"obstacle.pad must be at least a hundredth of the side long and wide ({least:g} m), "
                    f"got x {obstacle.pad.x}, width {obstacle.pad.width}"
                )
            if obstacle.pad.x[1] > self.geometry.length * (1 + 1e-9):
                raise ValueError(
                    f"obstacle.pad.x must lie on the finger, [0, {self.geometry.length:g}] m, got {obstacle.pad.x}"
                )
            if (obstacle.pad.width or 0) > self.geometry.side:
                raise ValueError(
                    f"obstacle.pad.width must be at most the side, {self.geometry.side:g} m, got {obstacle.pad.width}"
                )

    @property
    def planar(self) -> bool:
        """Whether all tendons lie in the plane z = 0, so that the finger's two halves are mirror images."""
        return all(tendon.offset[1] == 0 for tendon in self.tendons)

    @property
    def is_half(self) -> bool:
        """Whether only the half z >= 0 is modelled."""
        return self.planar if self.mesh.symmetry is None else self.mesh.symmetry

    @property
    def law(self) -> Law:
        """The rubber's law."""
        return self.material

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lowest and highest value of every parameter, in the order every layer uses: tensions, then d."""
        listed = [
            {"name": tendon.name, "unit": "N", "lower": tendon.tension[0], "upper": tendon.tension[1]}
            for tendon in self.tendons
        ]
        if self.obstacle is not None:
            lower, upper = self.obstacle.distance
            listed.append({"name": "d", "unit": "m", "lower": lower, "upper": upper})
        return listed

    @property
    def parameter_names(self) -> list[str]:
        """Names of the parameters, in their order."""
        return [parameter["name"] for parameter in self.parameters]

    def fingerprint(self) -> str:
        """Hash of all that changes the finger's answers; name and sampling do not."""
        text = json.dumps(self.model_dump(exclude=NOT_OF_THE_FINGER), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def _ordered(field: str, limits: list[float]) -> None:
    if limits[0] >= limits[1]:
        raise ValueError(f"{field} must be [lowest, highest] with lowest < highest, got {limits}")

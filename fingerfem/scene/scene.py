"""What is modelled: a scene, which is its tables and the rules between them."""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any

from pydantic import (
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from fingerfem.scene.grid_lines import fitting, grid_lines
from fingerfem.scene.laws import REGISTERED, Law
from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.presets import KEYS, chosen
from fingerfem.scene.tables import (
    Coarse,
    Expected,
    Geometry,
    Gravity,
    GridOutline,
    Load,
    Mesh,
    Sampling,
    SceneTable,
    Tendon,
)

NOT_OF_THE_FINGER = {"name", "sampling", "expected", "coarse", *KEYS}


class SceneError(ValueError):
    """A scene that breaks a rule: one line naming file, field, rule and value."""


class Scene(SceneTable):
    """One scene: all inputs of the full-order model.

    In place of mesh and lines of states it may have `accuracy` ("1 %" of the contact force), `budget` ("20min" of core
    time) or `preset`; what these chose is then `mesh` and `expected`, and with a load `coarse` and `sampling.lines`.
    """

    name: str
    accuracy: str | None = None
    budget: str | None = None
    preset: str | None = None
    expected: Expected | None = None
    geometry: Geometry
    material: SerializeAsAny[Law]
    tendons: Annotated[list[Tendon], Field(min_length=1, max_length=8)]
    gravity: Gravity | None = None
    obstacle: Obstacle | None = None
    load: Load | None = None
    mesh: Mesh
    coarse: Coarse | None = None
    sampling: Sampling = Sampling()

    @field_validator("material", mode="wrap")
    @classmethod
    def _by_law(cls, table: Any, check: Any) -> Law:
        if isinstance(table, Law) or not isinstance(table, dict):
            return check(table)
        name = table.get("law")
        if name is None:
            raise ValueError("law is required and missing")
        if name not in REGISTERED:
            raise ValueError(f"law must be {' or '.join(map(repr, REGISTERED))}, got {name!r}")
        return REGISTERED[name].model_validate(table)

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
            obstacle = Obstacle.model_validate(table["obstacle"]) if table.get("obstacle") else None
            outline = GridOutline(
                Geometry.model_validate(table["geometry"]),
                [Tendon.model_validate(tendon) for tendon in table["tendons"]],
                obstacle.pad if obstacle else None,
            )
        except (KeyError, TypeError, ValueError):
            return across  # the finger's own check reports what is wrong with it
        return fitting(outline, across)

    @model_validator(mode="after")
    def _tables_agree(self) -> Scene:
        width = self.geometry.channel_width
        reach = self.geometry.side / 2 - width / 2
        for k, tendon in enumerate(self.tendons):
            if self.parameter_names.count(tendon.name) > 1 or tendon.name == "d":
                raise ValueError(f"tendons.{k}.name must be unique and no other parameter's, got {tendon.name}")
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
                shared = tendon.path == other.path == "channel" and tendon.segment != other.segment
                if apart < width * (1 - 1e-9) and not (shared and apart <= width * 1e-9):
                    raise ValueError(
                        f"tendons.{k}.offset must keep channels apart (geometry.channel is {width:g} m wide), or share "
                        f"the channel of a tendon that ends at another plate, "
                        f"got {tendon.offset} beside {other.name} at {other.offset}"
                    )
            _ordered(f"tendons.{k}.tension", tendon.tension)
        if self.mesh.symmetry and not self.outline.is_planar:
            raise ValueError("mesh.symmetry must be false where a tendon is off the plane z = 0, got true")
        if self.load is not None and (self.obstacle is not None or self.mesh.symmetry):
            where = "obstacle" if self.obstacle is not None else "mesh.symmetry"
            raise ValueError(f"{where} must be left out where load says what may press, got both")
        if self.obstacle is not None:
            self._check_obstacle(self.obstacle)
        if self.mesh.symmetry and not self._is_mirrored:
            raise ValueError(
                "mesh.symmetry must be false where obstacle or weight is not its own mirror image, got true"
            )
        if self.load is not None and self.gravity is not None:
            raise ValueError("gravity must be left out of a scene with a load: elements carry weight by section")
        grid_lines(self.outline, self.mesh, self.is_half)
        if self.coarse is not None:
            try:
                grid_lines(self.outline, self._coarse_mesh(self.coarse), self.is_half)
            except ValueError as error:
                raise ValueError(str(error).replace("mesh.", "coarse.", 1)) from None
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
    def outline(self) -> GridOutline:
        """What the mesh's grid lines have to meet."""
        return GridOutline(self.geometry, self.tendons, self.obstacle.pad if self.obstacle else None)

    @property
    def _is_mirrored(self) -> bool:
        """Whether what may touch, and weight, are their own mirror images in z = 0."""
        if self.gravity is not None and self.gravity.direction[2]:
            return False
        return self.obstacle is None or all(one.is_mirrored for one in self.obstacle.bodies)

    @property
    def is_half(self) -> bool:
        """Whether only the half z >= 0 is modelled."""
        if self.mesh.symmetry is not None:
            return self.mesh.symmetry
        return self.outline.is_planar and self.load is None and self._is_mirrored

    @property
    def law(self) -> Law:
        """The rubber's law."""
        return self.material

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lowest and highest value of every parameter: tensions, then d or the wrenches' components."""
        listed = [
            {"name": tendon.name, "unit": "N", "lower": tendon.tension[0], "upper": tendon.tension[1]}
            for tendon in self.tendons
        ]
        if self.obstacle is not None:
            lower, upper = self.obstacle.distance
            listed.append({"name": "d", "unit": "m", "lower": lower, "upper": upper})
        if self.load is not None:
            listed += self.load.parameters(self.geometry)
        return listed

    @property
    def parameter_names(self) -> list[str]:
        """Names of the parameters, in their order."""
        return [parameter["name"] for parameter in self.parameters]

    @model_serializer(mode="wrap")
    def _without_what_is_not_named(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """A scene without a load, weight or a coarse mesh is as it was before there were any."""
        later = "load", "coarse", "gravity"
        return {key: value for key, value in serialise(self).items() if key not in later or value is not None}

    def on_coarse_mesh(self) -> Scene:
        """The same scene on its coarse mesh, with the lines of that.

        Raises:
            SceneError: it has none.
        """
        if self.coarse is None:
            raise SceneError("coarse must name a mesh (cells, order, lines) for states on it, got a scene without")
        table = self.model_dump(mode="json", exclude_unset=True, exclude={"coarse", "expected", *KEYS})
        lines = {} if self.coarse.lines is None else {"lines": self.coarse.lines}
        table["sampling"] = table.get("sampling", {}) | lines
        return Scene.model_validate(table | {"mesh": self._coarse_mesh(self.coarse)})

    def _coarse_mesh(self, coarse: Coarse) -> Mesh:
        return self.mesh.model_copy(update={"cells": coarse.cells, "order": coarse.order})

    def fingerprint(self) -> str:
        """Hash of all that changes the finger's answers; name and sampling do not."""
        text = json.dumps(self.model_dump(exclude=NOT_OF_THE_FINGER), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def _ordered(field: str, limits: list[float]) -> None:
    if limits[0] >= limits[1]:
        raise ValueError(f"{field} must be [lowest, highest] with lowest < highest, got {limits}")

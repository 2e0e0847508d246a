"""Scene, the description of a model: its tables and the rules between them."""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any

from pydantic import (
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)

from fingerfem.scene.grid_lines import fitting, lines_along, section_mesh
from fingerfem.scene.laws import Law, NamedLaw
from fingerfem.scene.obstacle import Obstacle
from fingerfem.scene.outline import GridOutline
from fingerfem.scene.placed import Chamber, Material
from fingerfem.scene.presets import KEYS, chosen
from fingerfem.scene.rules import (
    check_chambers,
    check_density,
    check_materials,
    check_obstacle,
    check_section,
    ordered,
)
from fingerfem.scene.sections import SHAPES, FromFile, Section
from fingerfem.scene.tables import (
    Coarse,
    Density,
    Expected,
    Geometry,
    Gravity,
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
    section: SerializeAsAny[Section] | None = None  # before geometry, which it is put into
    geometry: Geometry
    material: NamedLaw
    materials: Annotated[list[Material], Field(max_length=8)] = []
    tendons: Annotated[list[Tendon], Field(min_length=1, max_length=8)]
    chambers: Annotated[list[Chamber], Field(max_length=8)] = []
    density: Density | None = None
    gravity: Gravity | None = None
    obstacle: Obstacle | None = None
    load: Load | None = None
    mesh: Mesh
    coarse: Coarse | None = None
    sampling: Sampling = Sampling()

    @field_validator("section", mode="wrap")
    @classmethod
    def _by_shape(cls, table: Any, check: Any, info: ValidationInfo) -> Section | None:
        if isinstance(table, Section) or not isinstance(table, dict):
            return check(table)
        shape = table.get("shape")
        if "file" in table:
            return FromFile.model_validate(table, context=info.context)
        if shape is None:
            raise ValueError("shape is required and missing, or file in its place")
        if not isinstance(shape, str) or shape not in SHAPES:
            raise ValueError(f"shape must be {' or '.join(map(repr, SHAPES))}, got {shape!r}")
        return SHAPES[shape].model_validate(table)

    @field_validator("geometry", mode="before")
    @classmethod
    def _with_section(cls, table: Any, info: ValidationInfo) -> Any:
        section = info.data.get("section")
        if not isinstance(table, dict) or (section is None and "section" not in table):
            return table
        if "section" in table:
            raise ValueError(f"section must be a table [section] of its own, got {table['section']!r} in geometry")
        return table | {"section": section}

    @model_validator(mode="before")
    @classmethod
    def _choose(cls, table: Any) -> Any:
        if not isinstance(table, dict):
            return table
        if table.get("materials"):
            table = {key: value for key, value in table.items() if key != "rubber"}  # written by the program
        if table.get("expected") is not None:  # it was chosen when it was written
            if not any(table.get(key) for key in KEYS):
                raise ValueError(f"expected must be left out where no {' or '.join(KEYS)} chooses it, got a table")
            return table
        key = next((key for key in KEYS if table.get(key)), None)
        if key and table.get("section"):
            raise ValueError(
                f"{key} must be left out with [section]: meshes are measured on square fingers; give mesh.cells, "
                f"got {table[key]!r}"
            )
        for name in ("chambers", "materials"):
            if key and table.get(name):
                raise ValueError(
                    f"{key} must be left out with [[{name}]]: meshes are measured on fingers without; give mesh.cells, "
                    f"got {table[key]!r}"
                )
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
        check_section(self)
        for k, tendon in enumerate(self.tendons):
            if self.parameter_names.count(tendon.name) > 1 or tendon.name == "d":
                raise ValueError(f"tendons.{k}.name must be unique and no other parameter's, got {tendon.name}")
            if tendon.segment > len(self.geometry.segments):
                raise ValueError(
                    f"tendons.{k}.segment must be at most {len(self.geometry.segments)}, the number of segments, "
                    f"got {tendon.segment}"
                )
            ordered(f"tendons.{k}.tension", tendon.tension)
        check_chambers(self)
        check_density(self)
        check_materials(self)
        if self.mesh.symmetry and not self.outline.is_planar:
            raise ValueError(
                "mesh.symmetry must be false where a tendon, chamber or material is off the plane z = 0, got true"
            )
        if self.load is not None and (self.obstacle is not None or self.mesh.symmetry):
            where = "obstacle" if self.obstacle is not None else "mesh.symmetry"
            raise ValueError(f"{where} must be left out where load says what may press, got both")
        if self.obstacle is not None:
            check_obstacle(self, self.obstacle)
        if self.mesh.symmetry and not self._is_mirrored:
            raise ValueError(
                "mesh.symmetry must be false where obstacle or weight is not its own mirror image, got true"
            )
        if self.load is not None and self.gravity is not None:
            raise ValueError("gravity must be left out of a scene with a load: elements carry weight by section")
        self._check_mesh(self.mesh)
        if self.coarse is not None:
            try:
                self._check_mesh(self._coarse_mesh(self.coarse))
            except ValueError as error:
                raise ValueError(str(error).replace("mesh.", "coarse.", 1)) from None
        return self

    def _check_mesh(self, mesh: Mesh) -> None:
        lines_along(self.outline, mesh)
        section_mesh(self.outline, mesh.cells[1], self.is_half, mesh.order)

    @model_validator(mode="after")
    def _pressure_has_a_pad(self) -> Scene:
        if "pad_pressure" in self.sampling.store and (self.obstacle is None or self.obstacle.pad is None):
            raise ValueError("sampling.store must not ask for pad_pressure of a scene without obstacle.pad")
        return self

    @property
    def outline(self) -> GridOutline:
        """Boundaries that the mesh's grid lines must follow."""
        pad = self.obstacle.pad if self.obstacle else None
        return GridOutline(self.geometry, self.tendons, pad, self.chambers, self.materials)

    @property
    def _is_mirrored(self) -> bool:
        """True if obstacle and weight are their own mirror images in z = 0."""
        if self.gravity is not None and self.gravity.direction[2]:
            return False
        return self.obstacle is None or all(one.is_mirrored for one in self.obstacle.bodies)

    @property
    def is_half(self) -> bool:
        """True if only the half z >= 0 is modelled."""
        if self.mesh.symmetry is not None:
            return self.mesh.symmetry
        return self.outline.is_planar and self.load is None and self._is_mirrored and self.geometry.shape.is_mirrored

    @property
    def law(self) -> Law:
        """The rubber's law."""
        return self.material

    @property
    def densities(self) -> tuple[list[float], float] | None:
        """Densities of the rubber and the other materials, and of plates [kg/m^3]; None if the scene gives none."""
        if self.density is not None:
            rubber, plates = self.density.rubber, self.density.plates
        elif self.gravity is not None and self.gravity.density is not None:
            rubber, plates = self.gravity.density, self.gravity.plate_density
        else:
            return None
        return [rubber, *(one.density or rubber for one in self.materials)], plates

    @property
    def laws(self) -> list[Law]:
        """The rubber's law, then those of the other materials."""
        return [self.material, *(one.material for one in self.materials)]

    @property
    def actuators(self) -> list[str]:
        """Names of the tendons, then of the chambers."""
        return [tendon.name for tendon in self.tendons] + [chamber.name for chamber in self.chambers]

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Name, unit, lowest and highest value of every parameter: tensions, pressures, then d or the wrenches."""
        listed = [
            {"name": tendon.name, "unit": "N", "lower": tendon.tension[0], "upper": tendon.tension[1]}
            for tendon in self.tendons
        ]
        listed += [
            {"name": chamber.name, "unit": "Pa", "lower": chamber.pressure[0], "upper": chamber.pressure[1]}
            for chamber in self.chambers
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
        """A scene without what came later is as before; a square is geometry.side's."""
        later = "load", "coarse", "density", "gravity", "section"
        written = {key: value for key, value in serialise(self).items() if key not in later or value is not None}
        for name in ("chambers", "materials"):
            if not getattr(self, name):
                written.pop(name, None)
        if self.materials:  # for rod elements, whose own stiffness is not the rubber's
            written["rubber"] = {"E": self.material.young_modulus, "nu": self.material.poisson}
        if self.section is not None and self.section.is_square:
            written.pop("section", None)
        return written

    def on_coarse_mesh(self) -> Scene:
        """The same scene on its coarse mesh, with the lines of that.

        Raises:
            SceneError: it has none.
        """
        if self.coarse is None:
            raise SceneError("coarse must be a table of the scene with the cells of a coarse mesh, got none")
        table = self.model_dump(mode="json", exclude_unset=True, exclude={"coarse", "expected", *KEYS})
        lines = {} if self.coarse.lines is None else {"lines": self.coarse.lines}
        table["sampling"] = table.get("sampling", {}) | lines
        return Scene.model_validate(table | {"mesh": self._coarse_mesh(self.coarse)})

    def _coarse_mesh(self, coarse: Coarse) -> Mesh:
        return self.mesh.model_copy(update={"cells": coarse.cells, "order": coarse.order})

    def fingerprint(self) -> str:
        """Hash of all that changes the finger's answers; name and sampling do not."""
        table = self.model_dump(exclude=NOT_OF_THE_FINGER)
        table.get("section", {}).pop("file", None)  # its digest counts
        text = json.dumps(table, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

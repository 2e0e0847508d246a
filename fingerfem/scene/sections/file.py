"""A section from a file of Gmsh: quadrilaterals with named groups."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import ValidationInfo, computed_field, model_validator
from scipy.spatial import ConvexHull

from fingerfem.scene.sections.gmsh_file import FileMesh, read_gmsh
from fingerfem.scene.sections.plane_mesh import RUBBER, PlaneMesh
from fingerfem.scene.sections.section import Column, Inside, Section, Wanted
from rom.dataset.sections.section_outline import MOST_VERTICES

INLAY = "material "  # before the name of another material, the name of its group
GROUPS = {"channel": "channel", "straight": "hole"}  # of a tendon's path: the first word of its group's name


class FromFile(Section):
    """A section whose quadrilaterals are those of a file; the axis of the finger is y = z = 0."""

    shape: Literal["file"] = "file"
    meshed_by: ClassVar[str] = "section.file"
    chamber_region: ClassVar[str | None] = "group"
    file: str  # seen from the scene's folder; absolute in what the program writes
    digest: str | None = None  # of the file's content; written by the program, as `measures` are

    @model_validator(mode="before")
    @classmethod
    def _is_found(cls, table: Any, info: ValidationInfo) -> Any:
        if not isinstance(table, dict) or not isinstance(table.get("file"), str):
            return table
        path = Path((info.context or {}).get("folder", "."), table["file"]).absolute()
        try:
            content = path.read_bytes()
        except OSError as error:
            raise ValueError(f"file must be a mesh of Gmsh, got {path}: {error.strerror or error}") from None
        digest = hashlib.sha256(content).hexdigest()[:16]
        table = {key: value for key, value in table.items() if key != "measures"}
        if table.get("digest") not in (None, digest):
            raise ValueError(f"file must be what it was when the scene was written, got another content of {path}")
        return table | {"file": str(path), "digest": digest}

    @model_validator(mode="after")
    def _is_read(self) -> FromFile:
        _ = self._read
        return self

    @property
    def _read(self) -> FileMesh:
        return _of_content(self.file, self.digest)[0]

    @computed_field  # type: ignore[prop-decorator]
    @property
    def measures(self) -> dict[str, Any]:
        """Measures for rod elements, see `rom.dataset.sections.section`; of many corners of its hull the farthest."""
        hull = self._read.points[ConvexHull(self._read.points).vertices]
        if len(hull) > MOST_VERTICES:
            angles = 2 * np.pi * np.arange(MOST_VERTICES) / MOST_VERTICES
            hull = hull[np.unique((hull @ [np.cos(angles), np.sin(angles)]).argmax(axis=0))]
        squares = (self._plain.second_moments[:2] / self.area).tolist()
        measures = {"area": self.area, "mean_squares": squares, "hull": hull.tolist()}
        groups = {name.removeprefix(INLAY): own for name, own in self._read.groups.items() if name.startswith(INLAY)}
        return measures | ({"materials": {name: self._measured(own) for name, own in groups.items()}} if groups else {})

    def _measured(self, quads: np.ndarray) -> dict[str, Any]:
        """Area [m^2], centroid [m] and means of y^2 and z^2 [m^2] of a group of quadrilaterals."""
        own = PlaneMesh(points=self._plain.points, quads=self._plain.quads[quads], tags=self._plain.tags[quads])
        squares = own.second_moments[:2] / own.area + own.centroid**2
        return {"area": own.area, "centroid": own.centroid.tolist(), "mean_squares": squares.tolist()}

    @property
    def _plain(self) -> PlaneMesh:
        return _of_content(self.file, self.digest)[1]

    @property
    def is_mirrored(self) -> bool:
        """True if edges along z = 0 divide the section and its groups into mirror images."""
        return self._plain.is_mirrored

    @property
    def extents(self) -> tuple[float, float]:
        """Height along y and width along z [m]."""
        height, width = np.ptp(self._read.points, axis=0).tolist()
        return height, width

    @property
    def top(self) -> float:
        """The largest y [m]."""
        return float(self._read.points[:, 0].max())

    @property
    def area(self) -> float:
        """Area of the section [m^2]."""
        return self._plain.area

    @property
    def second_moment(self) -> float:
        """The least second moment of area [m^4]."""
        yy, zz, yz = self._plain.second_moments
        return float(np.linalg.eigvalsh([[yy, yz], [yz, zz]])[0])

    def refusal(self, column: Column, width: float) -> str | None:
        """The rule that a tendon breaks, if any: it has a group, and lies in it."""
        return None

    def are_apart(self, one: Column, other: Column, width: float) -> bool:
        """True if two channels have no cells in common: groups have none."""
        return one.tag != other.tag

    def mesh(self, wanted: Wanted) -> PlaneMesh:
        """The file's mesh, every edge divided into as many parts as cells are asked for."""
        columns = {f"{GROUPS[one.path]} {one.name}": one for one in reversed(wanted.columns)}
        names: dict[str, Column | Inside] = {**columns, **{f"chamber {one.name}": one for one in wanted.cavities}}
        names |= {f"{INLAY}{one.name}": one for one in wanted.inlays if one.region == "group"}
        shared = {
            f"{GROUPS[one.path]} {one.name}" for one in wanted.columns if wanted.columns[one.tag].name != one.name
        }
        groups, read = self._read.groups, self._read
        where = self.file
        missing = [name for name in names if name not in groups and name not in shared]
        if missing:
            raise ValueError(f"{where}: must have a physical group {missing[0]!r}, got {', '.join(map(repr, groups))}")
        unknown = [name for name in groups if name not in names and name != "rubber"]
        if unknown:
            known = ", ".join(map(repr, ["rubber", *names]))
            raise ValueError(f"{where}: must have no physical groups but {known}, got {unknown[0]!r}")
        tags = np.full(len(read.quads), RUBBER)
        for name, own in groups.items():
            if name != "rubber":
                tags[own] = names[name].tag
        whole = PlaneMesh(points=read.points, quads=read.quads, tags=tags)
        for name, column in columns.items():
            if not whole.contains(column.offset, column.tag):
                raise ValueError(
                    f"{where}: group {name!r} must contain its tendon's offset, got {column.offset.tolist()}"
                )
        if wanted.half and not whole.is_mirrored:
            raise ValueError(
                f"{where}: must be parted into mirror images by edges along z = 0 for mesh.symmetry = true"
            )
        return (whole.half() if wanted.half else whole).divided(wanted.across)


@lru_cache(maxsize=4)
def _of_content(file: str, digest: str | None) -> tuple[FileMesh, PlaneMesh]:
    """A file's content, and its mesh with a tag for every group."""
    if hashlib.sha256(Path(file).read_bytes()).hexdigest()[:16] != digest:
        raise ValueError(f"{file}: must have the content it had when the scene was read; read the scene again")
    read = read_gmsh(Path(file))
    tags = np.full(len(read.quads), RUBBER)
    for k, own in enumerate(read.groups.values()):
        tags[own] = k
    return read, PlaneMesh(points=read.points, quads=read.quads, tags=tags)

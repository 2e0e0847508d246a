"""Sections of the finger, a file each: measures, rules for channels, mesh. `SHAPES` names those a scene accepts."""

from fingerfem.scene.sections.circle import Circle, Ring
from fingerfem.scene.sections.file import FromFile
from fingerfem.scene.sections.plane_mesh import RUBBER, PlaneMesh
from fingerfem.scene.sections.rectangle import Rectangle, Square
from fingerfem.scene.sections.section import Cavity, Column, Inlay, Inside, Section, Wanted, check_cavities, material_of

SHAPES: dict[str, type[Section]] = {"square": Square, "rectangle": Rectangle, "circle": Circle, "ring": Ring}

__all__ = [
    "RUBBER",
    "SHAPES",
    "Cavity",
    "Circle",
    "Column",
    "FromFile",
    "Inlay",
    "Inside",
    "PlaneMesh",
    "Rectangle",
    "Ring",
    "Section",
    "Square",
    "Wanted",
    "check_cavities",
    "material_of",
]

"""Geoms of a MuJoCo model near the rubber of a finger, as compiled code reads them."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from control.native import CONTROL
from rom.native import LIBRARY, pointer
from rom.rod.objects.polyhedron import MOST_CORNERS, polyhedron

KINDS, NUMBERS = mujoco.mjtGeom, LIBRARY.constants
HULL = NUMBERS.FINGERFEM_HULL
SHAPES = {  # of rom.native, by those of MuJoCo
    int(KINDS.mjGEOM_PLANE): NUMBERS.FINGERFEM_PLANE,
    int(KINDS.mjGEOM_SPHERE): NUMBERS.FINGERFEM_SPHERE,
    int(KINDS.mjGEOM_CAPSULE): NUMBERS.FINGERFEM_SPHERE,
    int(KINDS.mjGEOM_CYLINDER): NUMBERS.FINGERFEM_CYLINDER,
    int(KINDS.mjGEOM_BOX): HULL,
    int(KINDS.mjGEOM_MESH): HULL,
}
VECTORS = "vertices", "along", "normals"  # of a hull
ROUNDING = 1e-6  # of a hull [m]
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def is_known(model: mujoco.MjModel, geom: int) -> bool:
    """True if a geom has one of SHAPES, and the hull of a mesh not too many corners."""
    kind = int(model.geom_type[geom])
    if kind != KINDS.mjGEOM_MESH:
        return kind in SHAPES
    graph = model.mesh_graphadr[model.geom_dataid[geom]]  # MuJoCo's hull begins with the number of its corners
    return bool(graph >= 0 and model.mesh_graph[graph] <= MOST_CORNERS)


class Near:
    """A geom near the rubber of one finger, and its contacts there.

    Attributes:
        struct: control_near, see control/native/rubber_contacts.h.

    Args:
        model: compiled.
        sections: control_sections of the finger.
        finger, geom: their indices.
    """

    def __init__(self, model: mujoco.MjModel, sections: Any, finger: int, geom: int):
        kind, size = int(model.geom_type[geom]), model.geom_size[geom]
        numbers: dict[str, Any] = {"shape": SHAPES[kind], "radius": float(size[0])}
        if kind in (KINDS.mjGEOM_CAPSULE, KINDS.mjGEOM_CYLINDER):
            numbers["half_length"] = float(size[1])
        if SHAPES[kind] == HULL:
            points = SIGNS * size if kind == KINDS.mjGEOM_BOX else _vertices(model, geom)
            numbers |= polyhedron(points) | {"radius": ROUNDING}
        own = np.concatenate([np.zeros((0, 3)), *(numbers[name] for name in VECTORS if name in numbers)])
        object_ = LIBRARY.struct("fingerfem_object", **numbers)
        self._found = CONTROL.ffi.new("fingerfem_engine_contacts *")
        self._kept = sections, object_, own
        vectors = {name: CONTROL.ffi.cast("double *", getattr(object_, name)) for name in VECTORS}
        values = {"sections": sections, "finger": finger, "geom": geom, "object": object_, "found": self._found}
        self.struct = CONTROL.ffi.new("control_near *", values | vectors | {"own": pointer(own)})

    @property
    def contacts(self) -> bytes:
        """The last contacts."""
        return bytes(CONTROL.ffi.buffer(self._found))

    @contacts.setter
    def contacts(self, values: bytes) -> None:
        CONTROL.ffi.buffer(self._found)[:] = values


def _vertices(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """Vertices of a mesh in the axes of its geom, shape (n, 3) [m]."""
    mesh = model.geom_dataid[geom]
    first = model.mesh_vertadr[mesh]
    return np.array(model.mesh_vert[first : first + model.mesh_vertnum[mesh]], float)

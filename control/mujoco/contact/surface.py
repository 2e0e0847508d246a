"""The rubber of a finger as its rod has it, before geoms of a MuJoCo model."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from control.mujoco.rubber import Rubber
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of
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
    """A geom near the rubber of one finger, and its contacts there, see fingerfem_engine_contacts in segment.h.

    Attributes:
        object: fingerfem_object, in the axes of the clamp.
        found: fingerfem_engine_contacts; its arrays are attributes, too.
    """

    def __init__(self, model: mujoco.MjModel, geom: int):
        kind, size = int(model.geom_type[geom]), model.geom_size[geom]
        numbers: dict[str, Any] = {"shape": SHAPES[kind], "radius": float(size[0])}
        self._vectors = list[tuple[np.ndarray, np.ndarray]]()  # of a hull: in its own axes, and in those of the clamp
        if kind in (KINDS.mjGEOM_CAPSULE, KINDS.mjGEOM_CYLINDER):
            numbers["half_length"] = float(size[1])
        if SHAPES[kind] == HULL:
            points = SIGNS * size if kind == KINDS.mjGEOM_BOX else _vertices(model, geom)
            numbers |= polyhedron(points) | {"radius": ROUNDING}
        self.object = LIBRARY.struct("fingerfem_object", **numbers)
        for name in ("vertices", "along", "normals") if SHAPES[kind] == HULL else ():
            own = np.array(numbers[name], float)
            seen = np.frombuffer(LIBRARY.ffi.buffer(getattr(self.object, name), own.nbytes)).reshape(own.shape)
            self._vectors.append((own, seen))
        self.found = LIBRARY.ffi.new("fingerfem_engine_contacts *")
        self.sections, self.places = self._array("sections", np.int32), self._array("places").reshape(-1, 3)
        self.axes, self.arms = self._array("axes").reshape(-1, 3, 3), self._array("arms").reshape(-1, 3, 6)
        self.gaps, self.compliances = map(self._array, ("gaps", "compliances"))
        self.forces = self._array("forces").reshape(-1, 3)

    def _array(self, name: str, kind: type = float) -> np.ndarray:
        """A field of the struct of contacts."""
        return np.frombuffer(LIBRARY.ffi.buffer(getattr(self.found, name)), kind)

    def move(self, place: np.ndarray, rotation: np.ndarray) -> None:
        """Place it in the axes of the clamp: its origin [m] and its rotation."""
        self.object.centre = place.tolist()
        self.object.axis = rotation[:, 2].tolist()
        self.object.direction = rotation[:, 0].tolist()
        for own, seen in self._vectors:
            np.matmul(own, rotation.T, out=seen)


class Surface:
    """The surface of a finger's rubber, and geoms near it.

    Args:
        model: compiled.
        data: its state.
        rubber: of the finger.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, rubber: Rubber):
        self._model, self._data = model, data
        self._chain = rubber.attached.rod.struct
        self._near = dict[int, Near]()
        self._clamp, self._sections = rubber.bodies[0], rubber.bodies[1:]
        count, loads = len(self._sections), len(rubber.attached.rod.names)
        self._tensions, self._places, self._rotations = np.zeros(loads), np.zeros((count, 3)), np.zeros((count, 3, 3))
        given = self._tensions, self._places, self._rotations, rubber.wrenches
        self._given = [*map(pointer, given), memory_of(self._chain)]

    def reset(self) -> None:
        """Forget all contacts."""
        for one in self._near.values():
            one.found.count = 0

    @property
    def contacts(self) -> dict[int, bytes]:
        """The last contacts, by geom."""
        return {geom: bytes(LIBRARY.ffi.buffer(near.found)) for geom, near in self._near.items()}

    @contacts.setter
    def contacts(self, values: dict[int, bytes]) -> None:
        self._near = {geom: Near(self._model, geom) for geom in values}
        for geom, near in self._near.items():
            LIBRARY.ffi.buffer(near.found)[:] = values[geom]

    def find(self, geoms: list[int], tensions: np.ndarray) -> list[tuple[int, Near]]:
        """Find contacts with geoms at tensions, shape (t,) [N]; those of other geoms are forgotten."""
        for geom in self._near.keys() - set(geoms):
            self._near[geom].found.count = 0
        if not geoms:
            return []
        data, sections = self._data, self._sections
        origin, axes = data.xpos[self._clamp], data.xmat[self._clamp].reshape(3, 3)
        self._tensions[:] = tensions
        np.matmul(data.xpos[sections] - origin, axes, out=self._places)
        np.matmul(axes.T, data.xmat[sections].reshape(-1, 3, 3), out=self._rotations)
        for geom in geoms:
            if geom not in self._near:
                self._near[geom] = Near(self._model, geom)
            near = self._near[geom]
            near.move((data.geom_xpos[geom] - origin) @ axes, axes.T @ data.geom_xmat[geom].reshape(3, 3))
            LIBRARY.functions.fingerfem_engine_find(self._chain, near.object, *self._given, near.found)
        return [(geom, self._near[geom]) for geom in geoms]


def _vertices(model: mujoco.MjModel, geom: int) -> np.ndarray:
    """Vertices of a mesh in the axes of its geom, shape (n, 3) [m]."""
    mesh = model.geom_dataid[geom]
    first = model.mesh_vertadr[mesh]
    return np.array(model.mesh_vert[first : first + model.mesh_vertnum[mesh]], float)

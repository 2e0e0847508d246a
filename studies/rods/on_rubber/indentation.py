"""How deep forces press into the rubber: two objects squeeze the straight finger, which neither bends nor moves."""

from __future__ import annotations

import tomllib
from itertools import product
from typing import Any

import numpy as np

from rom import AmongObjects, Cylinder, Sphere
from rom.rod.objects.shapes import RigidObject
from studies import sets
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, obstacle
from studies.rods.on_rubber.pressed_objects import together

MESHES = [(20, 5), (40, 10)]  # cells along and across, of order 1
DEPTHS = 1e-4, 4e-4  # [m]
AT = 0.5  # of the finger's length
FACE, EDGE = (0.0, 1.0, 0.0), (0.0, 1.0, 1.0)  # where they press
KINDS: dict[str, tuple[Any, dict[str, Any], tuple[float, float, float]]] = {
    "ball of 5 mm on a face": (Sphere, {"radius": 0.005}, FACE),
    "ball of 5 mm on an edge": (Sphere, {"radius": 0.005}, EDGE),
    "cylinder of 6 mm across a face": (Cylinder, {"radius": 0.006, "axis": (0.0, 0.0, 1.0)}, FACE),
    "cylinder of 20 mm across a face": (Cylinder, {"radius": 0.020, "axis": (0.0, 0.0, 1.0)}, FACE),
}


def squeezing(kind: str, length: float, half: float) -> list[RigidObject]:
    """Two objects that touch a straight finger, of a length and half a side [m], from both sides where d is 0."""
    made, numbers, way = KINDS[kind]
    found = []
    for side in (1.0, -1.0):
        out = side * np.array(way) / np.linalg.norm(way)
        centre = np.array([AT * length, 0.0, 0.0]) + out * (half / np.abs(out).max() + numbers["radius"])
        found.append(made(centre=tuple(centre), direction=tuple(out), distances=(-0.01, 0.1), **numbers))
    return found


def measure(run: Run) -> dict[str, Any]:
    """Forces of both models, by object and depth, of the full-order one on several meshes [N]."""
    plan = plans.LARGE
    rod, scene = plans.rod(run, plan), plans.scene(run, plan).read_text()
    meshes = MESHES
    fulls = [FullOrder(tomllib.loads(sets.on_mesh(scene, *cells, 1))) for cells in meshes]
    rows, relaxed = [], np.zeros(len(rod.names))
    for kind, depth in product(KINDS, DEPTHS):
        objects = squeezing(kind, rod.rest[0], rod.half_lengths[1])
        answer = AmongObjects(rod=rod, obstacles=objects).evaluate([*relaxed, -depth, -depth])
        touched = together([obstacle(one) | {"distance": [-0.01, 0.1]} for one in objects])
        forces = [full.approached(touched, relaxed, -depth) for full in fulls]
        rows.append(
            {
                "object": kind,
                "depth_mm": 1e3 * depth,
                "rod": float(answer.contact_force[0]) if answer.inside else None,
                "full_order": [None if one is None else float(one[0]) for one in forces],
            }
        )
    return {"meshes": [f"{along} x {across}" for along, across in meshes], "rows": rows}

"""How deep forces press into the rubber: two objects squeeze a straight piece of finger, which neither bends nor moves.

The piece is short, so that its cells can be small. Contact of Hertz is that of a ball on a half-space.
"""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np

from rom import AmongObjects, Cylinder, Sphere, TouchedSegment
from rom.rod.objects.shapes import RigidObject
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, obstacle
from studies.rubber.pressed_objects import together

PIECE = 0.012  # length [m]
CELLS = [(6, 5), (12, 10), (24, 20)]  # along and across, of order 1
DEPTH = 1e-4  # [m]
FACE, EDGE = (0.0, 1.0, 0.0), (0.0, 1.0, 1.0)  # where they press
KINDS: dict[str, tuple[Any, dict[str, Any], tuple[float, float, float]]] = {
    "ball of 5 mm on a face": (Sphere, {"radius": 0.005}, FACE),
    "ball of 5 mm on an edge": (Sphere, {"radius": 0.005}, EDGE),
    "cylinder of 6 mm across a face": (Cylinder, {"radius": 0.006, "axis": (0.0, 0.0, 1.0)}, FACE),
}


def squeezing(kind: str, place: float, half: float) -> list[RigidObject]:
    """Two objects that touch a straight finger, of half a side [m] at a place along it from both sides where d is 0."""
    made, numbers, way = KINDS[kind]
    found = []
    for side in (1.0, -1.0):
        out = side * np.array(way) / np.linalg.norm(way)
        centre = np.array([place, 0.0, 0.0]) + out * (half / np.abs(out).max() + numbers["radius"])
        found.append(made(centre=tuple(centre), direction=tuple(out), distances=(-0.01, 0.1), **numbers))
    return found


def hertz(kind: str, material: dict[str, float]) -> float | None:
    """Force of a ball on a half-space [N]; None of what is no ball on a face."""
    made, numbers, way = KINDS[kind]
    if made is not Sphere or way != FACE:
        return None
    shear, bulk = 2 * material["C1"], 2 / material["D1"]
    young, poisson = 9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))
    return float(4 / 3 * young / (1 - poisson**2) * numbers["radius"] ** 0.5 * DEPTH**1.5)


def squeezed(full: FullOrder, half: float, kind: str) -> float | None:
    """The force on the piece, by the full-order model [N]; None if it did not converge."""
    touched = together([obstacle(one) | {"distance": [-0.01, 0.1]} for one in squeezing(kind, PIECE / 2, half)])
    forces = full.approached(touched, np.zeros(2), -DEPTH)
    return None if forces is None else float(forces[0])


def measure(run: Run) -> dict[str, Any]:
    """Forces of both models, by object, of the full-order one on several meshes [N]."""
    rod, table = TouchedSegment.load().rod, tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    half, rows, fulls = rod.half_lengths[1], [], []
    for cells in CELLS:
        geometry = table["geometry"] | {"segments": [PIECE]}
        fulls.append(FullOrder(table | {"geometry": geometry, "mesh": {"cells": list(cells), "order": 1}}))
    for kind in KINDS:
        objects = squeezing(kind, rod.rest[0] / 2, half)
        answer = AmongObjects(rod=rod, obstacles=objects).evaluate([*np.zeros(len(rod.names)), -DEPTH, -DEPTH])
        rows.append(
            {
                "object": kind,
                "rod": float(answer.contact_force[0]) if answer.inside else None,
                "hertz": hertz(kind, rod.scene["material"]),
                "full_order": [
                    run.once(f"{kind}, {cells}", squeezed, full, half, kind)
                    for cells, full in zip(CELLS, fulls, strict=True)
                ],
            }
        )
    return {"depth_mm": 1e3 * DEPTH, "cells_mm": [1e3 * 2 * half / across for _, across in CELLS], "rows": rows}

"""Local indentation of the rubber: two objects squeeze a finger, and one ball presses on a finger that bends.

Two objects squeeze a short straight piece, so that its cells can be small. Hertz' contact is that of a ball on a
half-space.
"""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np

from rom import AmongObjects, Rod, TouchedSegment
from studies.parts import ROOT, Run
from studies.rods import plans
from studies.rods.full_order import FullOrder, Pressed, Table, rigid

PIECE = 0.012  # length [m]
CELLS = [(6, 5), (12, 10), (24, 20)]  # along and across, of order 1
DEPTH = 1e-4  # of each object [m]
FACE, EDGE = (0.0, 1.0, 0.0), (0.0, 1.0, 1.0)  # direction from the axis
BALL = "ball of 5 mm on a face"
KINDS: dict[str, tuple[Table, tuple[float, float, float]]] = {
    BALL: ({"shape": "sphere", "radius": 0.005}, FACE),
    "ball of 5 mm on an edge": ({"shape": "sphere", "radius": 0.005}, EDGE),
    "cylinder of 6 mm across a face": ({"shape": "cylinder", "radius": 0.006, "axis": [0.0, 0.0, 1.0]}, FACE),
}
FINEST = ROOT / "scenes" / "demo" / "bundled_finest.toml"  # the mesh that corrects the bundled elements
RADIUS, ADVANCE = 0.004, 3e-4  # of the ball on the finger that bends; how far it advances beyond touch [m]
POSITIONS = 5.0, 10.0, 20.0, 40.0  # from the clamp [mm]


def beside(own: Table, position: float, half: float, outward: np.ndarray) -> Table:
    """A round obstacle that touches the straight finger, of half a side [m], at a position along it where d is 0."""
    out = outward / np.linalg.norm(outward)
    centre = np.array([position, 0.0, 0.0]) + out * (half / np.abs(out).max() + own["radius"])
    place = {"centre": centre.tolist(), "direction": out.tolist(), "distance": [-0.01, 0.1]}
    return own | place | {"method": "penalty"}


def both_sides(kind: str, position: float, half: float) -> list[Table]:
    """Two equal objects on opposite sides."""
    own, outward = KINDS[kind]
    return [beside(own, position, half, side * np.array(outward)) for side in (1.0, -1.0)]


def hertz(radius: float, material: dict[str, float]) -> float:
    """Force of a ball on a half-space [N]."""
    shear, bulk = 2 * material["C1"], 2 / material["D1"]
    young, poisson = 9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))
    return float(4 / 3 * young / (1 - poisson**2) * radius**0.5 * DEPTH**1.5)


def full_order_force(full: FullOrder, tables: list[Table], d: float) -> float | None:
    """Force of the first object at d [m] on the relaxed finger [N]; None if it did not converge."""
    forces = full.contact_forces(Pressed(np.zeros(2), tables, d), np.zeros(6))
    return None if forces is None else float(forces[0])


def rod_force(rod: Rod, tables: list[Table], d: float) -> float | None:
    """The same of the assembled finger; None beyond its domain."""
    answer = AmongObjects(rod=rod, obstacles=[rigid(one) for one in tables]).evaluate([0.0, 0.0, *[d] * len(tables)])
    return float(answer.contact_force[0]) if answer.inside else None


def squeezed(run: Run, rod: Rod) -> list[dict[str, Any]]:
    """Forces of both models by object, of the full-order model on several meshes [N]."""
    table, half = tomllib.loads(plans.scene(run, plans.LARGE).read_text()), rod.half_lengths[1]
    table["geometry"]["segments"] = [PIECE]
    fulls = {cells: FullOrder(table | {"mesh": {"cells": list(cells), "order": 1}}) for cells in CELLS}
    return [
        {
            "object": kind,
            "rod": rod_force(rod, both_sides(kind, rod.rest[0] / 2, half), -DEPTH),
            "hertz": hertz(KINDS[kind][0]["radius"], table["material"]) if kind == BALL else None,
            "full_order": [
                run.once(f"{kind}, {cells}", full_order_force, full, both_sides(kind, PIECE / 2, half), -DEPTH)
                for cells, full in fulls.items()
            ],
        }
        for kind in KINDS
    ]


def positions(run: Run, rod: Rod) -> dict[str, Any]:
    """Forces of a ball at some positions, against a mesh as fine as that of the elements [N]."""
    table = tomllib.loads(FINEST.read_text())
    full = FullOrder({key: table[key] for key in ("name", "geometry", "material", "tendons", "load", "mesh")})
    rows = []
    for position in POSITIONS:
        ball = [beside({"shape": "sphere", "radius": RADIUS}, 1e-3 * position, rod.half_lengths[1], np.array(FACE))]
        true = run.once(f"{position} mm", full_order_force, full, ball, -ADVANCE)
        rows.append({"position_mm": position, "rod": rod_force(rod, ball, -ADVANCE), "full_order": true})
    along, across = table["mesh"]["cells"]
    return {"mesh": f"{along} x {across} cells of order {table['mesh']['order']}", "rows": rows}


def measure(run: Run) -> dict[str, Any]:
    """Both."""
    rod = TouchedSegment.load().rod
    sizes = [1e3 * 2 * rod.half_lengths[1] / across for _, across in CELLS]
    return {"depth_mm": 1e3 * DEPTH, "cells_mm": sizes, "rows": squeezed(run, rod), "positions": positions(run, rod)}

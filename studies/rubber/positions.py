"""A ball that presses on the straight finger at some positions, against a mesh as fine as that of the elements."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
from scipy.optimize import brentq

from rom import Sphere, TouchedSegment
from studies.parts import ROOT, Run
from studies.rods.full_order import FullOrder, obstacle

SCENE = ROOT / "scenes" / "demo" / "bundled_finest.toml"
RADIUS, DEPTH, TOUCH = 0.004, 3e-4, 1e-3  # of the ball; how far it advances beyond touch; d there [m]
POSITIONS = 5.0, 7.5, 10.0, 15.0, 20.0, 30.0, 40.0  # from the clamp [mm]
AFAR, BRACKET = 0.04, 2.5e-4  # d without contact; of the rod's d at the full-order force, from its own [m]


def ball(position: float, half: float, touch: float) -> Sphere:
    """A ball that touches the straight finger's face at +y where d = touch [m]."""
    centre = (1e-3 * position, half + RADIUS - touch, 0.0)
    return Sphere(centre=centre, radius=RADIUS, direction=(0.0, 1.0, 0.0), distances=(-0.01, 0.1))


def compared(full: FullOrder, position: float) -> dict[str, Any]:
    """Contact forces of both models at the same d; and the tip's displacement over the same force."""
    rod = TouchedSegment.load().rod
    model = TouchedSegment(rod=rod, obstacle=ball(position, rod.half_lengths[1], TOUCH))
    relaxed, d = np.zeros(len(rod.names)), TOUCH - DEPTH
    table = obstacle(model.obstacle) | {"distance": [1e-5, AFAR]}
    force, tip = full.force_and_tip(table, relaxed, d)

    def excess(distance: float) -> float:
        return float(model.evaluate([*relaxed, distance]).contact_force) - force

    same = (
        model.evaluate([*relaxed, brentq(excess, d - BRACKET, d + BRACKET)]).tip - model.evaluate([*relaxed, AFAR]).tip
    )
    return {
        "position_mm": position,
        "full_order": force,
        "rod": excess(d) + force,
        "tip_full_order": 1e6 * float(np.linalg.norm(tip)) / force,
        "tip_rod": 1e6 * float(np.linalg.norm(same)) / force,
    }


def measure(run: Run) -> dict[str, Any]:
    """Every position: forces [N], and displacements of the tip over the force [um/N]."""
    table = tomllib.loads(SCENE.read_text())
    mesh, positions = table["mesh"], POSITIONS
    full = FullOrder({key: table[key] for key in ("name", "geometry", "material", "tendons", "load")} | {"mesh": mesh})
    rows = [run.once(f"{position} mm", compared, full, position) for position in positions]
    along, across = mesh["cells"]
    return {"mesh": f"{along} x {across} cells of order {mesh['order']}", "rows": rows}

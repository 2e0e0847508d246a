"""The bundled finger and its contact with the paper's plane: compiled code alone, one core, one run."""

from __future__ import annotations

import numpy as np

from control import Finger, problems
from rom.rod.compiled import touched as native
from studies.control.models import finger as bundled
from studies.measures import percentiles, random_points
from studies.parts import Run

POINTS, MOVED = 6000, 1e-4  # random points; motion of the plane for warm starts [m]
FORCE = 0.5  # to hold [N]


def row() -> dict:
    """Contact and holds at the same points, those that touch."""
    model = bundled()
    points = random_points(model, POINTS)
    found = model.answers(points)
    touched = found.inside & (found.out[:, 3] > 0)
    points, wrenches = np.ascontiguousarray(points[touched]), found.loads[touched]
    moved = points + MOVED * np.eye(points.shape[1])[-1]
    compiled, rules = Finger(model).compiled, problems.rules(1e-6)
    _, _, taken = problems.hold_many(compiled, points[:, :-1], FORCE, points[:, -1], rules)
    return {
        "points": len(points),
        "elements": len(model.rod.segments[0].elements),
        "terms": sum(len(law.polynomial.powers) for law in model.rod.elements.laws.values()),
        "contact, warm (plane moved 0.1 mm)": percentiles(native.touches(model.touching, moved, wrenches).nanoseconds),
        "contact, cold": percentiles(native.touches(model.touching, points).nanoseconds),
        "hold": percentiles(taken),
    }


def measure(run: Run) -> dict:
    """One row."""
    return run.once("speed", row)

"""Moments of grasps in the full-order model: the same tensions, the same solid in the same place."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from fingerfem import FingerModel
from fingerfem.discretisation.plate_loads import PlateLoads
from fingerfem.equilibrium.failures import LoadNotReached, NotConverged
from fingerfem.scene.scene import Scene
from rom import TouchedSegment
from studies.measures import quantiles
from studies.rods.full_order import rubber_touches
from studies.runner import Run

MOMENTS = "moments.json"  # as in moments.py, which needs MuJoCo


class Pressed:
    """The bundled finger, on the mesh that its elements were trained on."""

    def __init__(self) -> None:
        self._table = TouchedSegment.load().scene
        self._free = FingerModel(Scene.model_validate(self._table))

    def contact_force(self, moment: dict[str, Any]) -> dict[str, Any]:
        """The full-order contact force of a moment [N], whether rubber touches; or `failed`.

        It begins at the simulated wrench on the plate. Friction, gravity and inertia press on the plate as they did.
        """
        pulled, wrench = np.array(moment["tensions"]), np.array([moment["wrench"]])
        try:
            begun = self._free.solve(pulled, wrenches=wrench, sensitivities=False)
        except LoadNotReached as error:
            return {"failed": str(error)}
        others = {key: value for key, value in self._table.items() if key not in ("load", "coarse")}
        model = FingerModel(Scene.model_validate(others | {"obstacle": moment["obstacle"]}))
        problem = model.problem
        problem.plates = PlateLoads(model.scene, problem.mesh, problem.space)
        for strategy in ("plain", "line search"):
            model.continuation.start(pulled, moment["d"], begun.displacement, [moment["following"]])
            try:
                model.continuation.newton.solve(strategy)
            except NotConverged as error:
                failed = str(error)
                continue
            assert problem.contact is not None
            return {"contact_force": problem.contact.force(), "rubber": rubber_touches(model)}
        return {"failed": failed}


def measure(run: Run) -> dict:
    """All moments that the simulation has left."""
    file = run.folder / MOMENTS
    if not file.exists():
        raise SystemExit("moments of grasps are not there yet: .venv/bin/python -m studies.grasping.simulated")
    moments, pressed = json.loads(file.read_text()), Pressed()
    rows = [run.once(f"moment {k}", compared, pressed, moment) for k, moment in enumerate(moments)]
    errors = np.array([row["error"] for row in rows if "error" in row])
    counts = {kind: sum(row["kind"] == kind for row in rows) for kind in ("marked", "failed", "rubber")}
    return {"rows": rows, "moments": len(rows), "compared": len(errors), "error": quantiles(errors), **counts}


def compared(pressed: Pressed, moment: dict[str, Any]) -> dict[str, Any]:
    """One moment: MuJoCo's contact force beside the full-order one [N]."""
    row = {key: moment[key] for key in ("shape", "mass", "contact_force", "friction")}
    if moment["beyond"]:
        return row | {"kind": "marked"}
    found = pressed.contact_force(moment)
    if "failed" in found:
        return row | {"kind": "failed", "why": found["failed"]}
    if found["rubber"]:
        return row | {"kind": "rubber"}
    true = found["contact_force"]
    return row | {"kind": "compared", "full_order": true, "error": abs(row["contact_force"] / true - 1)}

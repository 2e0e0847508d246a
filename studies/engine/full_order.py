"""The full-order model at the moments of MuJoCo."""

from __future__ import annotations

import json
import tomllib
from typing import Any

from studies.parts import ROOT, Run, Unmeasured

SCENE = ROOT / "scenes" / "demo" / "bundled.toml"  # the mesh of the finger's elements


OTHERS = "load", "sampling"  # of its tables, which are not of a finger before an obstacle


def solved(row: dict[str, Any]) -> float | None:
    """Force of a moment [N]; None if the solve did not converge."""
    from fingerfem import FingerModel
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.scene.scene import Scene

    table = {name: value for name, value in tomllib.loads(SCENE.read_text()).items() if name not in OTHERS}
    model = FingerModel(Scene.model_validate(table | {"obstacle": row["obstacle"]}))
    try:
        force = model.solve(row["tensions"], 0.0, sensitivities=False).contact_force
    except LoadNotReached:
        return None
    return None if force is None else float(force)


def measure(run: Run) -> list[float | None]:
    """Forces of all moments."""
    file = run.folder / "moments.json"
    if not file.exists():
        raise Unmeasured(f"{run.name} needs engine/moments")
    rows = json.loads(file.read_text())["result"]
    return [run.once(f"moment {k}", solved, row) for k, row in enumerate(rows)]

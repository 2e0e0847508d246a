"""Only what a scene requires: what each kind of scene costs from the first form to the stored state."""

from __future__ import annotations

from typing import Any

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.dataset.snapshot_set import read_task
from studies import sets
from studies.kinds import forms_of, kinds
from studies.parts import Run

NOT_HERE = ("straight", "incompressible", "Nitsche")  # other physics, not other requirements
CELLS = [12, 9]  # of each segment; four channels need nine across
STATES = 12  # random ones of every scene


def scenes() -> dict[str, dict[str, Any]]:
    """Scenes by what they name, all of one mesh."""
    found = {name: table for name, table in kinds().items() if not any(word in name for word in NOT_HERE)}
    spatial = found["contact, spatial"]
    pad = spatial["obstacle"] | {"pad": {"name": "fingertip", "x": [0.049, 0.050]}}
    found |= {
        "contact, spatial, tip and contact force only": spatial | {"sampling": {"store": []}},
        "contact, spatial, with pad pressure": spatial
        | {"obstacle": pad, "sampling": {"store": ["displacement", "pad_pressure"]}},
    }
    return {name: table | {"mesh": {"cells": CELLS, "order": 1}} for name, table in found.items()}


def row(name: str, table: dict[str, Any], run: Run) -> dict:
    """What one scene costs."""
    scene = Scene.model_validate(table)
    model = FingerModel(scene)
    file = sets.written(run.folder, name.replace(",", ""), sets.as_toml(scene.model_dump(mode="json")))
    states = sets.held_out(file, STATES)
    return {
        "scene": name,
        "parameters": len(scene.parameters),
        "unknowns": model.problem.unknowns,
        "forms": forms_of(model.problem.forms),
        "quantities": len(read_task(states.path, next(iter(states.description.tasks)))),
        "core_seconds": states.core_seconds / states.states,
        "bytes": round(sum(part.stat().st_size for part in (states.path / "tasks").glob("*.npz")) / states.states),
    }


def measure(run: Run) -> list[dict]:
    """A row a kind of scene."""
    return [run.once(name, row, name, table, run) for name, table in scenes().items()]

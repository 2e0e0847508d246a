"""Only what a scene requires: what each kind of scene costs from the first form to the stored state."""

from __future__ import annotations

from typing import Any

from fingerfem import FingerModel, load_scene
from fingerfem.scene.scene import Scene
from rom.dataset.snapshot_set import read_task
from studies import sets
from studies.parts import ROOT, Run

MESH = {"cells": [12, 9], "order": 1}  # of each segment; four channels need nine cells across
STATES = 12  # random ones of every scene


def scenes() -> dict[str, dict[str, Any]]:
    """Scenes by name, all of one mesh."""
    names = ("one_segment", "two_segments", "four_tendons")
    one, two, four = (load_scene(ROOT / "scenes" / f"{name}.toml").model_dump() for name in names)
    planar, free = {"tendons": one["tendons"][:1]}, {"obstacle": None}
    pad = one["obstacle"] | {"pad": {"name": "fingertip", "x": [0.049, 0.050]}}
    found = {
        "free, planar": one | planar | free,
        "free, spatial": one | free,
        "contact, planar": one | planar,
        "contact, spatial": one,
        "two segments, contact, planar": two,
        "two segments, four tensions, contact": four,
        "contact, spatial, tip and contact force only": one | {"sampling": {"store": []}},
        "contact, spatial, with pad pressure": one
        | {"obstacle": pad, "sampling": {"store": ["displacement", "pad_pressure"]}},
    }
    return {name: table | {"mesh": MESH} for name, table in found.items()}


def row(name: str, table: dict[str, Any], run: Run) -> dict:
    """Cost of one scene."""
    scene = Scene.model_validate(table)
    model = FingerModel(scene)
    file = sets.written(run.folder, name.replace(",", ""), sets.as_toml(scene.model_dump(mode="json")))
    states = sets.held_out(file, STATES)
    return {
        "scene": name,
        "parameters": len(scene.parameters),
        "unknowns": model.problem.unknowns,
        "quantities": len(read_task(states.path, next(iter(states.description.tasks)))),
        "core_seconds": states.core_seconds / states.states,
        "bytes": round(sum(part.stat().st_size for part in (states.path / "tasks").glob("*.npz")) / states.states),
    }


def measure(run: Run) -> list[dict]:
    """A row a kind of scene."""
    return [run.once(name, row, name, table, run) for name, table in scenes().items()]

"""Only what a scene requires: what each kind of scene costs from the first form to the last query."""

from __future__ import annotations

from typing import Any

import h5py

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.build import train
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import read_task
from rom.surrogate import Surrogate
from studies import sets
from studies.kinds import forms_of, kinds
from studies.measures import call_times, random_points
from studies.runner import Run

NOT_HERE = ("straight", "incompressible", "Nitsche")  # other physics, not other requirements
CELLS = [12, 9]  # of each segment; four channels need nine across
LINES = 4  # of states, per tension


def scenes() -> dict[str, dict[str, Any]]:
    """Scenes by what they name, one mesh, as many lines of states a tension."""
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
    table = table | {"sampling": table.get("sampling", {}) | {"lines": LINES * len(table["tendons"])}}
    scene = Scene.model_validate(table)
    model = FingerModel(scene)
    file = sets.written(run.folder, name.replace(",", ""), sets.as_toml(scene.model_dump(mode="json")))
    training = sets.training(file)
    surrogate = train(training, EnrichmentOptions())
    stored = file.with_suffix(".h5")
    surrogate.save(stored)
    surrogate = Surrogate.load(stored)
    datasets: list[str] = []
    with h5py.File(stored) as content:
        content.visititems(lambda key, item: datasets.append(key) if isinstance(item, h5py.Dataset) else None)
    return {
        "scene": name,
        "parameters": len(scene.parameters),
        "unknowns": model.problem.unknowns,
        "forms": forms_of(model.problem.forms),
        "states": training.states,
        "quantities": len(read_task(training.path, next(iter(training.lines)))),
        "core_seconds": training.core_seconds,
        "datasets": len(datasets),
        "bytes": stored.stat().st_size,
        "terms": sum(surrogate.terms.values()),
        "query_us": call_times(surrogate.value_and_jacobian, random_points(surrogate, 5000))["p50_us"],
    }


def measure(run: Run) -> list[dict]:
    """A row a kind of scene; those of one segment in the short form."""
    return [
        run.once(name, row, name, table, run)
        for name, table in scenes().items()
        if not (run.quick and "segments" in name)
    ]

"""Only what a scene requires: what each kind of scene costs from the first form to the last query.

python3 studies/required/required.py [OUT] [--quick]
    prints a table, writes OUT/required.json (out/required by default)
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import h5py

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom.build import train
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet, read_task
from rom.surrogate import Surrogate
from studies import sets
from studies.solver.scenes import count, kinds
from studies.solver.solver import say
from studies.surrogate.surrogate import draw, timed
from studies.tradeoff.tradeoff import seconds
from studies.training.training import farm

NOT_HERE = ("straight", "incompressible", "Nitsche")  # other physics, not other requirements
CELLS = [12, 9]  # of each segment; four channels need nine across
LINES = 16  # of states, a tension


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


def row(name: str, table: dict[str, Any], folder: Path, lines: int) -> dict:
    """What one scene costs."""
    table = table | {"sampling": table.get("sampling", {}) | {"lines": lines * len(table["tendons"])}}
    scene = Scene.model_validate(table)
    model = FingerModel(scene)
    file = sets.written(folder, name.replace(",", ""), sets.as_toml(scene.model_dump(mode="json")))
    place = file.with_suffix("") / "training"
    farm(2, file, place)
    training = SnapshotSet(place)
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
        "forms": count(model.problem.forms),
        "states": training.states,
        "quantities": len(read_task(place, next(iter(training.lines)))),
        "core_seconds": seconds(training),
        "datasets": len(datasets),
        "bytes": stored.stat().st_size,
        "terms": sum(surrogate.terms.values()),
        "query_us": timed(surrogate.value_and_jacobian, draw(surrogate, 5000))["p50_us"],
    }


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", help="out/required by default, out/required-quick if quick")
    parser.add_argument("--quick", action="store_true", help="half the lines, one segment only")
    options = parser.parse_args()
    folder = Path(options.out or ROOT / "out" / ("required-quick" if options.quick else "required")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, table in scenes().items():
        if options.quick and "segments" in name:
            continue
        rows.append(row(name, table, folder, 8 if options.quick else LINES))
        say(rows[-1])
    (folder / "required.json").write_text(json.dumps({"scenes": rows}, indent=1))


if __name__ == "__main__":
    main()

"""The projection of docs/appendix.md to other meshes and more ranks."""

from __future__ import annotations

import json
from pathlib import Path

RANKS, STATES = (1, 8, 64, 1000), (1_000, 10_000)
DRAFT = [25, 6]  # cells of the row of the solver's study that is nearest to the draft finger


def prepare(found: dict, folder: Path) -> dict:
    """What the page shows besides what was measured."""
    speed = json.loads((folder.parent / "solver" / "speed.json").read_text())["result"]
    sizes = [row for row in speed["sizes"] if "failed" not in row]
    return {"ranks": RANKS, "counts": STATES, "projected": projection(found["farm"]["scaling"], sizes)}


def projection(scaling: dict, sizes: list[dict]) -> list[dict]:
    """How long sets take by mesh: the draft's time per state, in proportion to a factorisation's time."""
    draft = next(row for row in sizes if row["cells"] == DRAFT)
    each, start = 1 / scaling["states_per_second"]["1"], scaling["start_seconds"]
    rows = []
    for row in sizes:
        state = each * row["seconds"] / row["factorisations"] / (draft["seconds"] / draft["factorisations"])
        times = [duration(start + state * states / ranks) for states in STATES for ranks in RANKS]
        rows.append({"unknowns": row["unknowns"], "seconds_per_state": state, "times": times})
    return rows


def duration(seconds: float) -> str:
    """For people."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h"

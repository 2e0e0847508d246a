"""The picture of docs/training.md, and its projection to other meshes and more ranks."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt

from studies.axes import large_letters, logarithmic
from studies.runner import DOCS

RANKS, STATES = (1, 8, 64, 1000), (1_000, 10_000)
DRAFT = [25, 6]  # cells of the row of the solver's study that is nearest to the draft finger


def prepare(found: dict, folder: Path) -> dict:
    """Draw the picture; what the page shows besides what was measured."""
    draw(found["refinement"], DOCS / "refinement.png")
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


def draw(found: dict, picture: Path) -> None:
    """Held-out error against states."""
    large_letters()
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
    for panel, (name, title) in zip(
        panels, (("force", "contact force"), ("displacement", "displacement")), strict=True
    ):
        for rows, label, style in ((found["uniform"], "uniform", "s-"), (found["refined"], "refined", "o-")):
            rows = sorted(rows, key=lambda row: row["states"])
            states = [row["states"] for row in rows]
            tail = [100 * row[f"{name}_p95"] for row in rows]
            (line,) = panel.loglog(states, tail, style, label=f"{label}, 95th percentile")
            values = [100 * row[f"{name}_median"] for row in rows]
            panel.loglog(states, values, style, color=line.get_color(), mfc="none", alpha=0.6, label=f"{label}, median")
        panel.set_title(title)
        panel.set_xlabel("training states")
        logarithmic(panel)
        panel.grid(True, alpha=0.3)
    panels[0].set_ylabel(f"error on {found['held_out']} held-out states [%]")
    panels[1].legend(loc="center")
    figure.savefig(picture, dpi=110)
    plt.close(figure)

"""The table of contact forces in MuJoCo."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rom.error_statistics import quantiles
from studies.engine.finer import FINER, OFF
from studies.engine.full_order import STAGES, TILT, Stage

COMPARED = {  # pairs of forces, the second as reference
    "simulated": ("simulated", "full_order"),
    "rod": ("rod", "full_order"),
    "apart": ("simulated", "rod"),
}


def prepare(found: dict, folder: Path) -> dict:
    """Errors of all comparisons by object and touched part, counts within OFF, and moments beyond it on a finer mesh."""
    parts = zip(found["full_order"], found["simulated"], found["finer"], strict=True)
    rows = [
        row | {"name": f"{row['obstacle']['shape']}, {row['place']}", "simulated": force, "finer": finer}
        for row, force, finer in parts
    ]
    solved = [row for row in rows if row["full_order"] is not None]
    kinds = dict.fromkeys(row["name"] for row in rows)
    groups = {name: [row for row in solved if row["name"] == name] for name in kinds} | {"all": solved}
    forces = [row["full_order"] for row in solved]
    off = [row for row in solved if abs(row["rod"] / row["full_order"] - 1) > OFF]
    return {
        "cells": cells(STAGES[-1]),
        "finer_cells": cells(FINER[-1]),
        "tilt": float(np.degrees(np.arctan(np.hypot(TILT, TILT)))),
        "rows": [{"name": name, "count": len(own)} | errors(own) for name, own in groups.items()],
        "off": [row | {"change": row["finer"] and row["rod"] / row["finer"] - 1} for row in off],
        "within": OFF,
        "forces": [min(forces), max(forces)],
        "failed": len(rows) - len(solved),
    }


def cells(stage: Stage) -> str:
    """A mesh in words."""
    return f"{stage[0]} x {stage[1]} cells of order {stage[2]}"


def errors(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Quantiles of relative errors, and counts within OFF, of every comparison."""
    relative = {name: np.array([abs(row[a] / row[b] - 1) for row in rows]) for name, (a, b) in COMPARED.items()}
    return {name: quantiles(own) | {"within": int((own <= OFF).sum())} for name, own in relative.items()}

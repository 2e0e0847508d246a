"""The table of contact forces in MuJoCo."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rom.error_statistics import quantiles
from studies.engine.full_order import STAGES, TILT

WITHIN = 0.03  # [-]
COMPARED = {  # pairs of forces, the second as reference
    "simulated": ("simulated", "full_order"),
    "rod": ("rod", "full_order"),
    "apart": ("simulated", "rod"),
}


def prepare(found: dict, folder: Path) -> dict:
    """Errors of all comparisons by object and touched part, and counts within WITHIN."""
    rows = [row | {"simulated": force} for row, force in zip(found["full_order"], found["simulated"], strict=True)]
    solved = [row for row in rows if row["full_order"] is not None]
    kinds = {f"{row['obstacle']['shape']}, {row['place']}": [] for row in rows} | {"all": solved}
    for row in solved:
        kinds[f"{row['obstacle']['shape']}, {row['place']}"].append(row)
    forces = [row["full_order"] for row in solved]
    along, across, order, _ = STAGES[-1]
    return {
        "cells": f"{along} x {across} cells of order {order}",
        "tilt": float(np.degrees(np.arctan(np.hypot(TILT, TILT)))),
        "rows": [{"name": name, "count": len(own)} | errors(own) for name, own in kinds.items()],
        "within": WITHIN,
        "forces": [min(forces), max(forces)],
        "failed": len(rows) - len(solved),
    }


def errors(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Quantiles of relative errors, and counts within WITHIN, of every comparison."""
    relative = {name: np.array([abs(row[a] / row[b] - 1) for row in rows]) for name, (a, b) in COMPARED.items()}
    return {name: quantiles(own) | {"within": int((own <= WITHIN).sum())} for name, own in relative.items()}

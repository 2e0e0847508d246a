"""Moments in which rod and full-order model differ most: the full-order model on a finer mesh."""

from __future__ import annotations

import json

from studies.engine.full_order import STAGES, solved
from studies.parts import Run, Unmeasured

OFF = 0.03  # difference above which a moment is solved again [-]
FINER = (*STAGES, (32, 7, 2, 100.0))


def measure(run: Run) -> list[float | None]:
    """Forces of all moments [N]; None if it was not solved again, or did not converge."""
    file = run.folder / "full_order.json"
    if not file.exists():
        raise Unmeasured(f"{run.name} needs engine/full_order")
    rows = json.loads(file.read_text())["result"]
    off = [row["full_order"] is not None and abs(row["rod"] / row["full_order"] - 1) > OFF for row in rows]
    return [
        run.once(f"moment {k}", solved, row["obstacle"], row["tensions"], FINER) if off[k] else None
        for k, row in enumerate(rows)
    ]

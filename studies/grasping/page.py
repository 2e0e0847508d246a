"""The pictures and tables of docs/grasping.md."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path

import numpy as np

from studies.sections import DOCS

FATES = ("held", "let go", "dropped", "crushed", "refused")
REASONS = {  # beginnings of why a solid was not lifted, for people
    "rubber": "rubber may have touched, where no contact is solved for",
    "finds": "a finger found its face more than 8 mm from where it should be: the solid has moved or tipped",
    "no_contact": "a finger felt nothing up to its highest tension",
    "lost_contact": "a finger lost what it had felt",
    "sensor_failed": "a force did not answer to tension",
    "unreachable": "a finger could not press so hard there",
    "out_of_domain": "a finger could not press so hard there",
    "": "a finger did not come to hold its force in time",
}


def prepare(found: dict, folder: Path) -> dict:
    """Draw, and count by shape and by reason."""
    for part in found["pictures"].values():
        shutil.copy(folder / part["file"], DOCS / part["file"])
    rows = found["grasps"]["rows"]
    accepted = [row for row in rows if row["fate"] != "refused"]
    lifted = [row for row in rows if row["fate"] in ("held", "dropped") or "slips" in row]
    held = [row for row in rows if row["fate"] == "held"]
    refused = [row for row in rows if row["fate"] == "refused"]
    return {
        "fates": FATES,
        "shapes": by_shape(rows),
        "counts": Counter(row["fate"] for row in rows),
        "total": len(rows),
        "accepted": len(accepted),
        "lifted": len(lifted),
        "impossible": sum("are crushed above" in row["reason"] and row["impossible"] for row in refused),
        "leaning": sum("lean" in row["reason"] for row in refused),
        "let_go": reasons([row for row in rows if row["fate"] == "let go"]),
        "failures": [row for row in rows if row["fate"] in ("dropped", "crushed")],
        "slip": max(max(map(abs, row["slips"].values())) for row in held),
        "slip_median": float(np.median([max(map(abs, row["slips"].values())) for row in held])),
        "force_error": float(np.median([row["force_error"] for row in held])),
        "force_error_p95": float(np.percentile([row["force_error"] for row in held], 95)),
        "hardest": max(row["hardest"] / row["admissible_force"] for row in held),
        "stood": sum(row["tilt"] < np.radians(10) for row in held),
        "seconds": float(np.median([row["closing_seconds"] for row in held])),
        "marked": sum(row["left"] or row["lost"] or row["rubbed"] for row in held),
    }


def by_shape(rows: list[dict]) -> list[dict]:
    """Numbers of fates of every shape."""
    shapes = dict.fromkeys(row["shape"] for row in rows)
    return [{"shape": shape} | Counter(row["fate"] for row in rows if row["shape"] == shape) for shape in shapes]


def reasons(rows: list[dict]) -> list[tuple[str, int]]:
    """Why solids were let go, most frequent first."""
    words = [next(text for key, text in REASONS.items() if key in row["reason"]) for row in rows]
    return Counter(words).most_common()

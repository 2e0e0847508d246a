"""The tables of docs/grasping.md."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

FATES = ("held", "let go", "dropped", "crushed", "refused")
REASONS = {  # parts of the reasons for which a solid was not lifted, for people
    "finds": "a finger found its face more than 8 mm from where it should be",
    "the solid is": "the fingers found the solid more than 6 mm from their axis",
    "no_contact": "a finger measured no contact up to its highest tension",
    "lost_contact": "a finger lost contact",
    "sensor_failed": "a force did not respond to tension",
    "unreachable": "a finger could not press so hard there",
    "out_of_domain": "a finger could not press so hard there",
    "": "a finger did not hold its force in time",
}


def prepare(found: dict, folder: Path) -> dict:
    """Counts by shape and by reason, and the largest slips, forces and errors of those held."""
    rows = found["grasps"]
    fates = {fate: [row for row in rows if row["fate"] == fate] for fate in FATES}
    impossible = [row for row in fates["refused"] if row["bound"] < 1]
    held, failures = fates["held"], fates["dropped"] + fates["crushed"]
    slips = [max(map(abs, row["slips"].values())) for row in held]
    shapes = {shape: Counter(row["fate"] for row in rows if row["shape"] == shape) for shape in found["pictures"]}
    let_go = [next(text for key, text in REASONS.items() if key in row["reason"]) for row in fates["let go"]]
    return {
        "fates": FATES,
        "shapes": shapes | {"all": Counter(row["fate"] for row in rows)},
        "total": len(rows),
        "fingers": Counter(row["fingers"] for row in rows if row["fate"] != "refused"),
        "accepted": len(rows) - len(fates["refused"]),
        "impossible": len(impossible),
        "close": sum(1 <= row["bound"] < row["margin"] ** 2 for row in fates["refused"]),
        "slipping": sum("on all faces" in row["reason"] for row in fates["refused"]),
        "falling": sum("tips it over" in row["reason"] for row in fates["refused"]),
        "unsteady": Counter(row["fate"] for row in rows if row["tipping"] == 0),
        "possible": len(rows) - len(impossible),
        "let_go": Counter(let_go).most_common(),
        "failures": failures,
        "slip": {"median": float(np.median(slips)), "max": max(slips)},
        "force_error": float(np.median([row["force_error"] for row in held])),
        "hardest": max(row["hardest"] / row["admissible_force"] for row in held),
        "stood": sum(row["tilt"] < np.radians(10) for row in held),
        "seconds": float(np.median([row["closing_seconds"] for row in held])),
    }

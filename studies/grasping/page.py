"""The tables of docs/grasping.md."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from studies.declared import GRASPS

FATES = ("held", "let go", "dropped", "crushed", "refused")
REASONS = {  # parts of the reasons for which a solid was not lifted, for people
    "finds": "a finger found its face more than 6 mm from where it should be",
    "the solid is": "the fingers found the solid more than 4 mm from their axis",
    "near the admissible": "a finger measured nearly the admissible force, and the hand opened",
    "no_contact": "a finger measured no contact up to its highest tension",
    "lost_contact": "a finger lost contact",
    "sensor_failed": "a force did not respond to tension",
    "unreachable": "a finger could not press so hard there",
    "out_of_domain": "a finger could not press so hard there",
    "": "a finger did not hold its force in time",
}
TIPPED = np.radians(10)  # a solid that leans more has tipped [rad]
ALREADY = {"close": "while fingers closed", "open": "when fingers opened"}  # phases, for people


def prepare(found: dict, folder: Path) -> dict:
    """Counts by shape and by reason, and the largest slips, forces and errors of those held."""
    rows = [row for fifty in GRASPS for row in found[fifty]]
    fates = {fate: [row for row in rows if row["fate"] == fate] for fate in FATES}
    impossible = [row for row in fates["refused"] if row["bound"] < 1]
    held, moved = fates["held"], [row for row in rows if row["fate"] != "refused"]
    slips = [max(map(abs, row["slips"].values())) for row in held]
    shapes = {shape: Counter(row["fate"] for row in rows if row["shape"] == shape) for shape in found["pictures"]}
    return {
        "fates": FATES,
        "shapes": shapes | {"all": Counter(row["fate"] for row in rows)},
        "total": len(rows),
        "fingers": Counter(row["fingers"] for row in moved),
        "accepted": len(moved),
        "impossible": len(impossible),
        "close": sum(1 <= row["bound"] < row["margin"] ** 2 for row in fates["refused"]),
        "slipping": sum("on all faces" in row["reason"] for row in fates["refused"]),
        "falling": sum("tips it over" in row["reason"] for row in fates["refused"]),
        "rolled": Counter(row["fate"] for row in rows if row["rolled"]),
        "meshes": sum(row["shape"] == "mesh" for row in rows),
        "possible": len(rows) - len(impossible),
        "failures": [row | {"why": why(row)} for fate in ("let go", "dropped", "crushed") for row in fates[fate]],
        "again": sum(row["again"] for row in moved),
        "failed": len(fates["dropped"] + fates["crushed"]),
        "table": max(row["table_error"] for row in moved),
        "beside": {
            "median": float(np.median([row["beside"] for row in held])),
            "max": max(row["beside"] for row in held),
        },
        "outside": sum(row["beside"] > row["planned"] for row in held),
        "slip": {"median": float(np.median(slips)), "max": max(slips)},
        "force_error": float(np.median([row["force_error"] for row in held])),
        "sticks": [row["force_error"] for row in held if row["sticks"]],
        "hardest": max(row["hardest"] / row["admissible_force"] for row in held),
        "stood": sum(row["tilt"] < TIPPED for row in held),
        "seconds": float(np.median([row["closing_seconds"] for row in held])),
    }


def why(row: dict[str, Any]) -> str:
    """Reason for which a solid was not held, and its state, in words."""
    if row["fate"] == "crushed":
        reason = f"{row['reason']} {ALREADY.get(row['hardest_in'], 'in the phase: ' + row['hardest_in'])}"
    elif row["fate"] == "dropped":
        reason = row["reason"]
    else:
        reason = next(text for key, text in REASONS.items() if key in row["reason"])
    return f"{reason}; {state(row)}"


def state(row: dict[str, Any]) -> str:
    """The state of the solid at the end of closing, in words."""
    if row["tilted"] > TIPPED and row["shape"] != "sphere":
        return f"it had tipped by {np.degrees(row['tilted']):.0f} degrees while fingers closed"
    place = f"it stood {1000 * row['beside']:.1f} mm from the gripper's axis"
    return f"{place}, and its forces of crushing and dropping have a ratio of {row['room']:.2f}"

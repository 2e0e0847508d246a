"""Contact forces held, by the plane's distance: tensions, estimated error, and the force by the full-order model."""

from __future__ import annotations

import numpy as np

from control import Finger
from rom import TouchedSegment
from studies.coverage.coverage import solved
from studies.parts import Run

FORCES = 0.5, 1.0, 2.0  # [N]
DISTANCES = np.linspace(0.001, 0.031, 121)  # of the plane [m]
CHECKED = 0.004, 0.012, 0.020, 0.028  # of these, where the full-order model is asked, too [m]
FREE = [0.0, 0.0, DISTANCES[-1]]  # tensions [N] and d [m] of a state at rest: the farm begins others there


def sweep(finger: Finger, force: float) -> list[dict]:
    """What `hold` answers as the plane moves away: every time from the tensions that held last, at first from rest."""
    present, rows = finger.lower, []
    for distance in DISTANCES.tolist():
        motion = finger.hold(contact_force=force, distance=distance, start=present)
        present = motion.tensions if motion.converged else present
        found = {"force": force, "distance": distance, "status": motion.status, "tensions": motion.tensions.tolist()}
        rows.append(found | {"estimate": motion.error if motion.converged else None})
    return rows


def checked(run: Run, model: TouchedSegment, rows: list[dict]) -> list[dict]:
    """Some rows, with the contact force of the full-order model on a mesh finer than was trained on."""
    held = [row for row in rows if row["status"] == "converged" and np.isclose(row["distance"], CHECKED).any()]
    full_order = solved(run, "held", np.round([FREE, *[[*row["tensions"], row["distance"]] for row in held]], 7))
    found = []
    # The set keeps points in an order of its own, and none that failed.
    for point, truth in zip(full_order.random("parameters"), full_order.random("contact_force"), strict=True):
        if not point[:-1].any():
            continue
        apart = [np.linalg.norm(([*row["tensions"], row["distance"]] - point) / model.limits[1]) for row in held]
        found.append(held[int(np.argmin(apart))] | {"full_order": float(truth)})
    return found


def measure(run: Run) -> dict:
    """Rows by force, and those that the full-order model was asked about."""
    model = TouchedSegment.load()
    finger = Finger(model)
    rows = [row for force in FORCES for row in sweep(finger, force)]
    return {"names": model.names[:-1], "rows": rows, "checked": run.once("checked", checked, run, model, rows)}

"""The estimated error of the contact force over the plane of F1 and d, and the true one in a few states."""

from __future__ import annotations

import numpy as np

from rom import TouchedSegment
from rom.held_out import differences
from studies.coverage.coverage import solved
from studies.parts import Run

POINTS = 120  # along F1 and along d
DISTANCES = 0.001, 0.031  # of the paper's plane [m]
CHECKED_TENSIONS = 15.0, 32.0, 49.0, 66.0, 83.0, 100.0  # F1, where the full-order model is asked, too [N]
CHECKED_DISTANCES = 0.0255, 0.0195, 0.0135, 0.0075, 0.002  # [m]
DIGITS = 4


def checked(run: Run, model: TouchedSegment) -> list[dict]:
    """True errors where the finger touches, by the full-order model on a mesh finer than was trained on.

    Some points must be out of contact: the farm begins free states at known ones.
    """
    tensions = CHECKED_TENSIONS
    distances = CHECKED_DISTANCES
    points = np.array([[f, 0.0, d] for f in tensions for d in distances])
    full_order = solved(run, "errors", points)
    points = full_order.random("parameters")
    touches = full_order.random("contact_force") > 0
    answers, errors = model.evaluate(points), differences(model, full_order)["contact_force"]
    return [
        {"point": points[k].tolist(), "error": float(errors[k]), "inside": bool(answers.inside[k])}
        | {"estimate": float(answers.error["contact_force"][k])}
        for k in np.flatnonzero(touches)
    ]


def measure(run: Run) -> dict:
    """Estimates, shape (distances, tensions) [N], None without contact; whether they hold there; and true errors."""
    model = TouchedSegment.load()
    tensions = np.linspace(0.0, model.limits[1][0], POINTS)
    distances = np.linspace(*DISTANCES, POINTS)
    first, away = np.meshgrid(tensions, distances)
    answers = model.evaluate(np.column_stack([first.ravel(), 0 * first.ravel(), away.ravel()]))
    estimate, force = answers.error["contact_force"], answers.contact_force
    known = (force > 0) & np.isfinite(estimate)
    shown = [float(f"{e:.{DIGITS}g}") if there else None for e, there in zip(estimate, known, strict=True)]
    return {
        "tensions": tensions.tolist(),
        "distances": distances.tolist(),
        "estimate": [shown[k : k + POINTS] for k in range(0, len(shown), POINTS)],
        "inside": answers.inside.reshape(first.shape).tolist(),
        "touch": model.evaluate(np.column_stack([tensions, 0 * tensions, 0 * tensions])).touch_distance.tolist(),
        "checked": run.once("checked", checked, run, model),
    }

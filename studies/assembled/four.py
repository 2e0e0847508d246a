"""The paper's finger of four tendons: held-out pressed states by number of training lines, and random planes."""

from __future__ import annotations

import tomllib

from rom.rod.check import check_pressed
from studies.parts import Run
from studies.rods import plans
from studies.rods.objects import scattered
from studies.rods.plans import Plan

FOUR = Plan(15.0, 24, 60, offsets=((0.004, 0.0), (-0.004, 0.0), (0.0, 0.004), (0.0, -0.004)))
LINES, PLANES = (12, 16, 24), 40


def held_out(run: Run, lines: int) -> dict:
    """Errors of the finger of the first lines."""
    training, states = plans.snapshots(run, FOUR, lines), plans.held_out(run, FOUR)
    finger = plans.rod(run, FOUR) if lines == FOUR.lines else plans.trained(training)
    checked = check_pressed(finger, states)
    return {
        "lines": lines,
        "states": training.states,
        "failed": len(training.failures),
        "core_seconds": training.core_seconds,
        "degrees": finger.elements.provenance["degrees"],
        "checked": checked["states"],
        "checked_failed": checked["failed"],
        "held_out": checked["contact_force"],
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
    }


def measure(run: Run) -> dict:
    """By number of lines, then planes."""
    rows = [run.once(f"{lines} lines", held_out, run, lines) for lines in LINES]
    finger, table = plans.rod(run, FOUR), tomllib.loads(plans.scene(run, FOUR).read_text())
    return {"lines": rows, "planes": run.once("planes", scattered, finger, table, "plane", PLANES)}

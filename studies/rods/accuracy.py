"""Rod elements against held-out pressed states of their own mesh."""

from __future__ import annotations

from rom.rod.pressed_check import check_pressed
from studies.parts import Run
from studies.rods import plans
from studies.rods.plans import Plan

LINES = 8, 12, 24


def row(run: Run, plan: Plan, lines: int) -> dict:
    """A finger of a plan's first lines: its cost, degrees and errors."""
    training, held_out = plans.snapshots(run, plan, lines), plans.held_out(run, plan)
    finger = plans.rod(run, plan) if lines == plan.lines else plans.trained(training, plan.degree)
    checked = check_pressed(finger, held_out)
    walls = [] if plan.mesh else [check_pressed(finger, one)["contact_force"] for one in plans.on_walls(run, plan)]
    return {
        "name": plan.name,
        "degree": plan.degree,
        "products": sum(len(law.polynomial.powers) for law in finger.elements.laws.values()),
        "lines": lines,
        "states": training.states,
        "failed": len(training.failures) + len(held_out.failures),
        "core_seconds": training.core_seconds,
        "left_out": finger.elements.provenance["left_out"]["contact_force"],
        "held_out": checked["contact_force"],
        "walls": {key: max((one[key] for one in walls), default=None) for key in ("median", "p95", "max")},
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
    }


def measure(run: Run) -> list[dict]:
    """Errors by largest force, mesh and number of lines."""
    tries = [(plan, plan.lines) for plan in (plans.SMALL, plans.FINE, plans.HIGHER)]
    tries[2:2] = [(plans.LARGE, lines) for lines in LINES]
    return [
        run.once(f"{plan.name}, {lines} lines, degree {plan.degree:g}", row, run, plan, lines) for plan, lines in tries
    ]

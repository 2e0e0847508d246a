"""The paper's finger of four tendons: held-out pressed states by number of training lines, and random planes."""

from __future__ import annotations

import tomllib
from dataclasses import replace

from rom.rod.pressed_check import check_pressed
from studies.parts import Run
from studies.rods import plans
from studies.rods.objects import scattered
from studies.rods.plans import Plan

FOUR = Plan(15.0, 24, 60, offsets=((0.004, 0.0), (-0.004, 0.0), (0.0, 0.004), (0.0, -0.004)))
HIGHER_FOUR = replace(FOUR, degree=6.0)
TRIES, PLANES = ((FOUR, 12), (FOUR, 24), (HIGHER_FOUR, 24)), 40


def held_out(run: Run, plan: Plan, lines: int) -> dict:
    """Errors of the finger of a plan's first lines."""
    training, states = plans.snapshots(run, plan, lines), plans.held_out(run, plan)
    finger = plans.rod(run, plan) if lines == plan.lines else plans.trained(training, plan.degree)
    checked = check_pressed(finger, states)
    return {
        "lines": lines,
        "states": training.states,
        "failed": len(training.failures),
        "core_seconds": training.core_seconds,
        "degree": plan.degree,
        "products": sum(len(law.polynomial.powers) for law in finger.elements.laws.values()),
        "checked": checked["states"],
        "checked_failed": checked["failed"],
        "held_out": checked["contact_force"],
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
    }


def measure(run: Run) -> dict:
    """Errors by number of lines, then before planes."""
    rows = [run.once(f"{lines} lines, degree {plan.degree:g}", held_out, run, plan, lines) for plan, lines in TRIES]
    finger, table = plans.rod(run, HIGHER_FOUR), tomllib.loads(plans.scene(run, HIGHER_FOUR).read_text())
    return {"lines": rows, "planes": run.once("planes", scattered, finger, table, "plane", PLANES)}

"""Rod elements against held-out pressed states of their own mesh: the whole finger, and each element's law alone."""

from __future__ import annotations

import numpy as np

from rom.elements import rotation_vectors
from rom.elements.samples.cuts import cut
from rom.elements.samples.element_samples import element_samples
from rom.elements.samples.section_states import SectionStates, read_section_states
from rom.error_statistics import quantiles
from rom.rod.check import check_pressed
from rom.rod.rod import Rod
from studies.rods import plans
from studies.rods.plans import Plan
from studies.runner import Run

LINES = 8, 12, 16, 24


def row(run: Run, plan: Plan, lines: int) -> dict:
    """A finger of a plan's first lines: its cost, degrees and errors."""
    training, held_out = plans.snapshots(run, plan, lines), plans.held_out(run, plan)
    finger = plans.rod(run, plan) if lines == plan.lines else plans.trained(training)
    made, checked = finger.elements.provenance, check_pressed(finger, held_out)
    return {
        "name": plan.name,
        "unknowns": 3 * len(training.nodes),
        "lines": lines,
        "states": training.states,
        "failed": len(training.failures) + len(held_out.failures),
        "core_seconds": training.core_seconds,
        "degrees": made["degrees"],
        "terms": sum(len(law.polynomial.powers) for law in finger.elements.laws.values()),
        "left_out": made["left_out"]["contact_force"],
        "held_out": checked["contact_force"],
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
        "inside": checked["inside"],
    }


def residuals(run: Run, plan: Plan) -> list[dict]:
    """Every law against what its element does in held-out states, where the wrench that it transmits is given."""
    finger, states = plans.rod(run, plan), read_section_states(plans.held_out(run, plan))
    pairs = cut(states.at, states.scene["geometry"]["side"])
    return [residual(finger, states, kind, own) for kind, own in pairs.items()]


def residual(finger: Rod, states: SectionStates, kind: str, pairs: list[tuple[int, int]]) -> dict:
    """Errors of one law, over all positions of its element."""
    law, places, turns, lengths = finger.elements.laws[kind], [], [], []
    for pair in pairs:
        samples = element_samples(states, *pair)
        off = law.of_length(samples.length).value(samples.inputs) - samples.values
        turned = rotation_vectors.turns(samples.values[:, 3:6], off[:, 3:6, None])[..., 0]
        places.append(np.linalg.norm(off[:, :3], axis=1))
        turns.append(np.linalg.norm(turned, axis=1))
        lengths.append(samples.length)
    return {
        "kind": kind,
        "lengths_mm": [1e3 * min(lengths), 1e3 * max(lengths)],
        "terms": len(law.polynomial.powers),
        "place_um": quantiles(1e6 * np.concatenate(places)),
        "turn_mrad": quantiles(1e3 * np.concatenate(turns)),
    }


def measure(run: Run) -> dict:
    """By largest force, mesh and number of lines; then law by law."""
    tries = [(plan, plan.lines) for plan in (plans.SMALL, plans.FINE)] + [(plans.LARGE, lines) for lines in LINES]
    if run.quick:
        tries = [(plans.QUICK, 8), (plans.QUICK, 12)]
    own = plans.QUICK if run.quick else plans.LARGE
    return {
        "fingers": [run.once(f"{plan.name}, {lines} lines", row, run, plan, lines) for plan, lines in tries],
        "laws": run.once("laws", residuals, run, own),
    }

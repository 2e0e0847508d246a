"""Maps against held-out pressed states: by lines of states, by terms, by the largest force, on two meshes."""

from __future__ import annotations

import numpy as np

from rom.error_statistics import quantiles
from rom.segment.training import build
from rom.segment.training.contact_error import gap_by_force, relative_force_errors
from rom.segment.training.mirrors import with_images
from rom.segment.training.pose_fit import best_fit
from rom.snapshots.pressed_states import PressedStates, read_pressed_states
from studies.runner import Run
from studies.segment import maps
from studies.segment.maps import Plan

FOLD = 0.02  # of the median |dg/df|, below which a state stands about at a fold: it is about to snap [-]


def row(run: Run, plan: Plan) -> dict:
    """A map, what it cost and how it errs."""
    training, held_out = maps.snapshots(run, plan), maps.held_out(run, plan)
    segment = maps.segment(run, plan)
    checked = build.check(segment, held_out)
    states = read_pressed_states(held_out)
    errors, slopes = relative_force_errors(states, segment.pose.value(states.inputs)), np.abs(gap_by_force(states))
    folded = slopes < FOLD * np.nanmedian(slopes)
    return {
        "name": plan.name,
        "unknowns": 3 * len(training.nodes),
        "states": training.states,
        "failed": len(training.failures) + len(held_out.failures),
        "core_seconds": training.core_seconds,
        "terms": len(segment.pose.powers),
        "weights": segment.provenance["weights"],
        "degree": segment.provenance["degree"],
        "left_out": segment.provenance["left_out"],
        "held_out": checked["contact_force"],
        "folded": {
            "states": int(folded.sum()),
            "slope": float(np.nanmin(slopes) / np.nanmedian(slopes)),
            "largest_elsewhere": quantiles(errors[~folded])["max"],
        },
        "place_um": {key: 1e6 * checked["place_m"][key] for key in ("median", "p95", "max")},
        "covered": checked["covered"],
        "skin_um": 1e6 * segment.skin_error,
    }


def learning(run: Run, plan: Plan, lines: int, terms: int) -> dict:
    """A map of fewer lines or terms."""
    training, held_out = maps.snapshots(run, plan), read_pressed_states(maps.held_out(run, plan))
    states = read_pressed_states(training.only([f"pressed-{k}" for k in range(plan.lines)]))
    first = states.lines < lines
    fewer = PressedStates(**{name: value[first] for name, value in vars(states).items()})
    box = np.array([[one["lower"], one["upper"]] for one in training.description.parameters])
    found = best_fit(with_images(fewer, training.description.scene), box, terms)
    errors = relative_force_errors(held_out, found.polynomial.value(held_out.inputs))
    return {
        "lines": lines,
        "states": int(first.sum()),
        "terms": len(found.polynomial.powers),
        "left_out": quantiles(found.left_out),
        "held_out": quantiles(errors),
    }


def measure(run: Run) -> dict:
    """All of it."""
    plans = [maps.QUICK] if run.quick else [maps.SMALL, maps.LARGE, maps.FINE]
    first = plans[0]
    tries = [(20, 300)] if run.quick else [(20, 500), (40, 500), (40, 1000), (80, 500), (80, 1000), (80, 2500)]
    return {
        "maps": [run.once(plan.name, row, run, plan) for plan in plans],
        "learning": [run.once(f"{lines} lines, {terms}", learning, run, first, lines, terms) for lines, terms in tries],
    }

"""How states, terms, bytes and query time grow with the number of parameters.

The finger of two segments with both pairs of tendons (scenes/four_tendons.toml, on a coarser mesh), pulled by one
or four of them; lines of states at scattered tensions, as many per tension.
"""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np

from rom.build import train
from rom.error_model import calibrated
from rom.held_out import check
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.measures import call_times, random_points
from studies.runner import ROOT, Run

PULLED = {2: ["F_l1"], 5: ["F_s1", "F_s2", "F_l1", "F_l2"]}
CELLS = ("cells = [20, 9]", "cells = [8, 9]")
LINES, QUICK_LINES = 14, 8  # per tension
HELD_OUT = {2: 80, 5: 100}
ENOUGH = 0.01  # separation error for which terms are counted


def scene(folder: Path, parameters: int, lines: int = LINES) -> Path:
    """The four tendons' scene with the first of them, and so many lines of states a tension."""
    text = (ROOT / "scenes" / "four_tendons.toml").read_text().replace(*CELLS)
    head, *tendons = re.split(r"(?=\[\[tendons\]\])", text.replace('"four tendons"', '"growth"'))
    tendons[-1], rest = tendons[-1].split("[obstacle]", 1)
    named = {re.search(r'name = "(\w+)"', tendon)[1]: tendon for tendon in tendons}  # type: ignore[index]
    pulled = PULLED[parameters]
    sampling = f"\n[sampling]\nlines = {lines * len(pulled)}\nstore = []\n"
    return sets.written(
        folder, f"growth {parameters}", head + "".join(named[name] for name in pulled) + "[obstacle]" + rest + sampling
    )


def terms_for(model: Surrogate, error: float) -> int | None:
    """Terms of the regime of most states for a separation error; None if it has too few."""
    form = max(model.regimes, key=lambda regime: regime.states).form
    good = np.flatnonzero(form.errors <= error)
    return int(good[0]) + 1 if good.size else None


def scene_and_sets(run: Run, parameters: int) -> tuple[SnapshotSet, SnapshotSet]:
    """Training and held-out set of a finger with so many parameters."""
    file = scene(run.sets, parameters, QUICK_LINES if run.quick else LINES)
    training = sets.training(file)
    return training, sets.held_out(file, 20 if run.quick else HELD_OUT[parameters])


def row(run: Run, parameters: int) -> dict:
    """What so many parameters cost and err."""
    training, held_out = scene_and_sets(run, parameters)
    begun = time.perf_counter()
    model = train(training, EnrichmentOptions())
    seconds = time.perf_counter() - begun
    report = check(calibrated(model, held_out), held_out)
    return {
        "parameters": parameters,
        "tendons": PULLED[parameters],
        "states": training.states,
        "test_states": report["states"],
        "grid_states": 9 ** len(PULLED[parameters]) * 13,
        "regimes": len(model.regimes),
        "terms": terms_for(model, ENOUGH),
        "all_terms": sum(model.terms.values()),
        "bytes": model.bytes,
        "separation_seconds": seconds,
        "query": call_times(model.value_and_jacobian, random_points(model, 5000)),
        "contact_force": report["contact_force"],
        "tip": report["tip"],
        "wrong_touch_decisions": report["touch"]["wrong_beyond_margin"],
    }


def measure(run: Run) -> list[dict]:
    """By number of parameters; two in the short form."""
    return [
        run.once(f"{parameters} parameters", row, run, parameters)
        for parameters in (list(PULLED)[:1] if run.quick else PULLED)
    ]

"""Errors of the surrogate on held-out states, and how its estimated errors compare with the true ones."""

from __future__ import annotations

import time

import numpy as np

from rom.build import train
from rom.error_model import calibrated
from rom.held_out import check, split
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.runner import Run

JUDGED = ("draft", "standard", "two segments")
OPTIONS = EnrichmentOptions()


def sets_of(run: Run, name: str) -> tuple[SnapshotSet, SnapshotSet]:
    """The training set of a scene and its held-out set."""
    file = sets.scene(run.sets, name, run.quick)
    training = sets.training(file)
    return training, sets.held_out(file, sets.QUICK_HELD_OUT if run.quick else sets.HELD_OUT)


def draft_sets(run: Run) -> tuple[SnapshotSet, SnapshotSet]:
    """Those of the draft finger."""
    return sets_of(run, "draft")


def errors(run: Run, name: str) -> dict:
    """Errors of a scene's model on test states, its estimated errors calibrated by the others."""
    training, held_out = sets_of(run, name)
    begun = time.perf_counter()
    model = train(training, OPTIONS)
    seconds = time.perf_counter() - begun
    model = calibrated(model, held_out)
    touching = training.states_of("contact", "contact_force") > 0
    return check(model, held_out) | {
        "training_states": training.states,
        "contact_states": int(touching.sum()),
        "regimes": [{"code": list(regime.code), "states": regime.states} for regime in model.regimes],
        "separation_seconds": seconds,
        "estimates": estimates(model, split(held_out)[1]),
    }


def estimates(model: Surrogate, tested: SnapshotSet) -> dict[str, dict]:
    """Estimated errors of states in contact: coverage, and median estimate over the 95th percentile of the true error.

    The ratio is given for the half of the states with the smaller estimates, and for the other.
    """
    points, force = tested.random("parameters"), tested.random("contact_force")
    answer = model.evaluate(points)
    true = {
        "tip": np.linalg.norm(answer.tip - tested.random("tip"), axis=1),
        "contact_force": np.abs(answer.contact_force - force),
        "touch_distance": np.abs(answer.touch_distance - tested.random("touch_distance")),
    }
    if model.has_field:
        field = tested.random("displacement")
        moved = np.array([model.displacement(point) for point in points])
        true["displacement"] = np.sqrt(np.mean(np.sum((moved - field) ** 2, axis=2), axis=1))
    found = {}
    for name, errors in true.items():
        estimated, errors = answer.error[name][force > 0], errors[force > 0]
        halves = np.array_split(np.argsort(estimated), 2)
        found[name] = {
            "states": len(errors),
            "coverage": float(np.mean(errors <= estimated)),
            "ratios": [float(np.median(estimated[half]) / np.percentile(errors[half], 95)) for half in halves],
        }
    return found


def measure(run: Run) -> dict[str, dict]:
    """By scene; the draft finger alone in the short form."""
    return {name: run.once(name, errors, run, name) for name in (["draft"] if run.quick else JUDGED)}

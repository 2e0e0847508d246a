"""Many states on a coarse mesh and few on a fine one: error of the mesh and of the surrogate (figure 9 of the paper).

The draft mesh corrected by states on cells of order 2; a third mesh, finer than both, says what the meshes err.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rom.build import train
from rom.error_model import calibrated
from rom.held_out import FELT, check, split
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.measures import quantiles
from studies.runner import Run
from studies.surrogate.accuracy import estimates

REFERENCE = 24  # states on the finest mesh, the first of the held-out ones
LINES = (5, 10, 20)  # on the fine mesh
HEADLINE = 10
OPTIONS = EnrichmentOptions()


def without_fields(of: SnapshotSet) -> SnapshotSet:
    """The same set, its fields not read."""
    found = SnapshotSet(of.path)
    found.description = sets.without_store(found.description)
    return found


def force_errors(ours: np.ndarray, true: np.ndarray) -> dict:
    """Relative errors of contact forces [N], shapes (states,), that are felt."""
    felt = true > FELT
    return quantiles(np.abs(ours - true)[felt] / true[felt])


def curves(run: Run, files: dict[str, Path]) -> dict:
    """Errors against the number of states on the fine mesh: against its own mesh, and against the finest."""
    trained = {name: without_fields(sets.training(files[name])) for name in ("draft", "standard")}
    own = {name: sets.held_out(files[name], sets.HELD_OUT) for name in ("draft", "standard")}
    finest = sets.held_out(files["reference"], REFERENCE)
    points, true = finest.random("parameters"), finest.random("contact_force")
    found: dict = {"mesh": {}, "rows": [], "coarse_states": trained["draft"].states, "reference_states": REFERENCE}
    for name, states in own.items():
        assert np.array_equal(states.random("parameters")[:REFERENCE], points)
        found["mesh"][name] = force_errors(states.random("contact_force")[:REFERENCE], true)

    def row(kind: str, mesh: str, some: SnapshotSet, coarse: SnapshotSet | None = None, lines: int = 0) -> None:
        def errors() -> dict:
            model = train(some, OPTIONS, coarse)
            surrogate = check(model, split(own[mesh])[1])["contact_force"]
            total = force_errors(model.evaluate(points).contact_force, true)
            return {"kind": kind, "lines": lines, "states": some.states, "surrogate": surrogate, "total": total}

        found["rows"].append(run.once(f"{kind}, {lines} lines", errors))

    row("draft mesh", "draft", trained["draft"])
    row("fine mesh, all its states", "standard", trained["standard"])
    for lines in LINES:
        some = sets.first_lines(trained["standard"], lines)
        row("fine mesh alone", "standard", some, None, lines)
        row("both meshes", "standard", some, trained["draft"], lines)
    return found


def headline(files: dict[str, Path]) -> dict:
    """One model of two meshes with its field: errors, and coverage before and after calibration."""
    held_out = sets.held_out(files["standard"], sets.HELD_OUT)
    calibration, tested = split(held_out)
    few = sets.first_lines(sets.training(files["standard"]), HEADLINE)
    model = train(few, OPTIONS, sets.training(files["draft"]))
    report = check(model, tested)
    found = {"lines": HEADLINE} | {key: report[key] for key in ("contact_force", "displacement", "touch")}
    return found | {
        "states": few.states,
        "test_states": report["states"],
        "calibration_states": len(calibration.random("tip")),
        "uncalibrated": estimates(model, tested),
        "calibrated": estimates(calibrated(model, held_out), tested),
    }


def measure(run: Run) -> dict:
    """Curves and headline."""
    files = {name: sets.scene(run.sets, name) for name in ("draft", "standard", "reference")}
    return curves(run, files) | {"headline": run.once("with its field", headline, files)}

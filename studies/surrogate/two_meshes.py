"""Many states on a coarse mesh and few on a fine one.

The draft mesh corrected by states on cells of order 2.
"""

from __future__ import annotations

from pathlib import Path

from rom.build import train
from rom.error_model import calibrated
from rom.held_out import check, split
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.runner import Run
from studies.surrogate.accuracy import estimates

LINES = (5, 10, 20)  # on the fine mesh
HEADLINE = 10
OPTIONS = EnrichmentOptions()


def without_fields(of: SnapshotSet) -> SnapshotSet:
    """The same set, its fields not read."""
    found = SnapshotSet(of.path)
    found.description = sets.without_store(found.description)
    return found


def curves(run: Run, files: dict[str, Path]) -> dict:
    """Errors of the contact force on test states of its own mesh, against the number of states on the fine mesh."""
    trained = {name: without_fields(sets.training(files[name])) for name in ("draft", "standard")}
    tested = {name: split(sets.held_out(files[name], sets.HELD_OUT))[1] for name in ("draft", "standard")}
    found: dict = {"rows": [], "coarse_states": trained["draft"].states}

    def row(kind: str, mesh: str, some: SnapshotSet, coarse: SnapshotSet | None = None, lines: int = 0) -> None:
        def errors() -> dict:
            surrogate = check(train(some, OPTIONS, coarse), tested[mesh])["contact_force"]
            return {"kind": kind, "lines": lines, "states": some.states, "surrogate": surrogate}

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
    files = {name: sets.scene(run.sets, name) for name in ("draft", "standard")}
    return curves(run, files) | {"headline": run.once("with its field", headline, files)}

"""States against error: uniform grids, and a grid refined where the surrogate's doubt is largest, on the draft finger.

Two cores; models of up to 160 terms, so that sampling makes the error.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from rom.build import train
from rom.held_out import check
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.runner import Run
from studies.sets import farm, grid_scene

GRIDS = ((4, 7), (7, 7))  # nodes along a tension, along contact
OPTIONS = EnrichmentOptions(tolerance=2e-5, terms=160)  # so many that sampling, not separation, makes the error
MEASURES = ("force_median", "force_p95", "displacement_median", "displacement_p95")


def errors(snapshots: SnapshotSet, held_out: SnapshotSet) -> dict:
    """States and held-out errors of a surrogate of all states of a set."""
    report = check(train(snapshots, OPTIONS), held_out)
    force, field = report["contact_force"], report["displacement"]
    found = {"states": snapshots.states, "newton_iterations": snapshots.iterations}
    found |= {"force_median": force["median"], "force_p95": force["p95"], "force_max": force["max"]}
    return found | {"displacement_median": field["median"], "displacement_p95": field["p95"]}


def uniform(folder: Path, tensions: int, contact: int, held_out: SnapshotSet) -> dict:
    """A uniform grid, solved alone, by farm.py or here."""
    path = folder / f"uniform-{tensions}-{contact}"
    farm(2, grid_scene(folder, tensions, contact), path)
    return {"tension_nodes": tensions, "contact_nodes": contact} | errors(SnapshotSet(path), held_out)


def nested(coarse: dict, fine: dict) -> bool:
    """Whether a grid's nodes are among those of another: its intervals are as many, or half as many."""
    names = ("tension_nodes", "contact_nodes")
    return coarse is not fine and {(fine[name] - 1) / (coarse[name] - 1) for name in names} <= {1.0, 2.0}


def reused(folder: Path, coarse: dict, fine: dict) -> dict:
    """A grid solved again, with the states of a coarser one."""
    path, of, file = folder / "reused", _nodes(coarse), grid_scene(folder, *map(int, _nodes(fine).split("-")))
    shutil.rmtree(path, ignore_errors=True)
    report = farm(2, file, path, "--reuse", str(folder / f"uniform-{of}"))
    return {
        "of": of.replace("-", " x "),
        "for": _nodes(fine).replace("-", " x "),
        "newton_iterations": report["newton_iterations"],
        "alone": fine["newton_iterations"],
    }


def _nodes(row: dict) -> str:
    return f"{row['tension_nodes']}-{row['contact_nodes']}"


def refined(folder: Path, until: float, held_out: SnapshotSet) -> list[dict]:
    """A refined set after every third of its rounds, and after the last."""
    path, rows = folder / "refined", []
    shutil.rmtree(path, ignore_errors=True)
    farm(2, sets.scene(folder, "draft"), path, "--until", str(until))
    rounds = SnapshotSet(path).plan.rounds
    for count in sorted({*range(0, len(rounds), 3), len(rounds) - 1}):
        found = rounds[count]
        snapshots = SnapshotSet(path)
        solved = set(snapshots.description.lines).union(*(one.lines for one in rounds[:count]))
        snapshots.plan.lines = {task: line for task, line in snapshots.plan.lines.items() if task in solved}
        rows.append({"round": count, "estimated_error": found.error} | errors(snapshots, held_out))
    return rows


def as_good(row: dict, curve: list[dict], measures: tuple[str, ...]) -> dict | None:
    """The first refined set whose errors are at most those of a uniform grid."""
    for one in curve:
        if all(one[name] <= row[name] for name in measures):
            return {"states": one["states"], "of_the_uniform_grid": one["states"] / row["states"]}
    return None


def measure(run: Run) -> dict:
    """All of it."""
    folder = run.folder
    farm(2, sets.scene(folder, "draft"), folder / "held-out", "--random", "40" if run.quick else "80", "--seed", "7")
    held_out = SnapshotSet(folder / "held-out")
    rows = [
        run.once(f"uniform grid {grid}", uniform, folder, *grid, held_out)
        for grid in (GRIDS[:1] if run.quick else GRIDS)
    ]
    again = [
        run.once(f"{_nodes(fine)} from {_nodes(coarse)}", reused, folder, coarse, fine)
        for fine in rows
        for coarse in rows
        if nested(coarse, fine)
    ]
    curve = run.once("refined, round by round", refined, folder, 0.1 if run.quick else 0.05, held_out)
    for row in rows:
        row["as_good_in_95_percent"] = as_good(row, curve, tuple(name for name in MEASURES if name.endswith("p95")))
        row["as_good_in_all"] = as_good(row, curve, MEASURES)
    return {"held_out": len(held_out.random("tip")), "uniform": rows, "reused": again, "refined": curve}

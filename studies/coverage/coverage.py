"""Answers of the bundled finger beside full-order states on a finer mesh than it was trained on."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fingerfem import load_scene
from rom.held_out import differences
from rom.snapshots.snapshot_set import SnapshotSet
from studies import sets
from studies.control.models import finger
from studies.coverage import points
from studies.runner import ROOT, Run

SCENES = ROOT / "scenes" / "demo"
# Those of tensions of their own take three times as long.
KINDS: dict[str, tuple[Callable, int]] = {
    "random": (points.in_fours, 80),
    "a controller's": (points.held, 32),
    "the worst": (points.worst, 32),
}
QUICK_COUNT, SEED = 4, 2021
QUICK_CELLS = {"plane_coarse": [10, 5], "plane_finest": [12, 5]}
QUANTITIES = "tip", "touch_distance", "contact_force"
FELT = 0.01  # [N]: forces below are not compared


def solved(run: Run, kind: str, chosen: np.ndarray) -> SnapshotSet:
    """The full-order states at points, shape (n, p): on the coarse mesh from rest, from there on the finest."""
    folder = run.folder / kind.replace(" ", "-").replace("'", "")
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "points.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows([["F1", "F2", "d"], *chosen.tolist()])
    near: list[str] = []
    for name in ("plane_coarse", "plane_finest"):
        sets.farm(2, _scene(run, name), folder / name, "--points", str(folder / "points.csv"), *near)
        near = ["--near", str(folder / name)]
    return SnapshotSet(folder / "plane_finest")


def _scene(run: Run, name: str) -> Path:
    if not run.quick:
        return SCENES / f"{name}.toml"
    table = load_scene(SCENES / f"{name}.toml").model_dump(mode="json", exclude_none=True)
    file = run.folder / f"{name}.toml"
    file.write_text(sets.as_toml(table | {"mesh": {"cells": QUICK_CELLS[name], "order": 1}}))
    return file


def row(run: Run, kind: str) -> dict:
    """One kind of points: errors and estimates of every answer that is inside, by quantity."""
    known = finger()
    draw, count = KINDS[kind]
    chosen = draw(known, QUICK_COUNT if run.quick else count, np.random.default_rng(SEED))
    full_order = solved(run, kind, np.round(chosen, 7))
    answers, off = known.evaluate(full_order.random("parameters")), differences(known, full_order)
    force = full_order.random("contact_force")
    sizes = {"tip": np.linalg.norm(full_order.random("tip"), axis=1), "contact_force": force}
    sizes["touch_distance"] = np.abs(full_order.random("touch_distance"))
    found: dict = {"points": len(chosen), "failed": len(full_order.failures), "marked": int(np.sum(~answers.inside))}
    touches = force > 0
    found["touch_wrong"] = int(np.sum(((answers.contact_force > 0) != touches)[answers.inside]))
    for name in QUANTITIES:
        counted = answers.inside & ((force > FELT) | (name != "contact_force"))
        error, estimate, size = (values[counted] for values in (off[name], answers.error[name], sizes[name]))
        found[name] = {"error": error.tolist(), "estimate": estimate.tolist(), "size": size.tolist()}
        if len(error):
            found[name] |= {
                "covered": float(np.mean(error <= estimate)),
                "median": float(np.median(error / size)),
                "p95": float(np.quantile(error / size, 0.95)),
                "max": float(np.max(error / size)),
                "width": float(np.median(estimate) / np.median(error)),
            }
    return found


def measure(run: Run) -> dict[str, dict]:
    """By kind of points."""
    return {kind: run.once(kind, row, run, kind) for kind in KINDS}

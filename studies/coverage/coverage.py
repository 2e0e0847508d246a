"""Answers of the bundled finger beside full-order states on a finer mesh than that of its training."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np

from rom import TouchedSegment
from rom.dataset.snapshot_set import SnapshotSet
from rom.elements.fitting.training import train
from rom.elements.samples.section_states import read_section_states
from rom.plane_check import differences
from rom.rod.rod import Rod
from studies import sets
from studies.control.models import finger
from studies.coverage import points
from studies.parts import ROOT, Run

SCENES = ROOT / "scenes" / "demo"
KINDS = {"random": 40, "on the walls": 24, "chosen": 45, "sought": 16}  # numbers of points
SEED = 2021
OTHER_LINES = 8  # of states, that the finger is trained on by which points are sought
QUANTITIES = "tip", "touch_distance", "contact_force"
FELT = 0.01  # [N]: forces below are not compared


def drawn(run: Run, kind: str, known: TouchedSegment) -> np.ndarray:
    """The points of a kind, shape (n, p)."""
    count, random = KINDS[kind], np.random.default_rng(SEED)
    if kind == "sought":
        return points.sought(known, count, random, _other(run, known))
    return {"random": points.at_random, "on the walls": points.on_walls, "chosen": points.chosen}[kind](
        known, count, random
    )


def _other(run: Run, known: TouchedSegment) -> TouchedSegment:
    """A finger of other elements, which half as many states have trained."""
    text = (SCENES / "bundled.toml").read_text().replace("lines = 16", f"lines = {OTHER_LINES}")
    folder = run.folder / "other"
    sets.farm(2, sets.written(run.folder, "other", text), folder)
    states = read_section_states(SnapshotSet(folder))
    return replace(known, rod=Rod(elements=train(states, {}), scene=states.scene))


def solved(run: Run, kind: str, chosen: np.ndarray) -> SnapshotSet:
    """The full-order states at points, shape (n, p): on the coarse mesh from rest, from there on the finest."""
    folder = run.folder / kind.replace(" ", "-")
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "points.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows([["F1", "F2", "d"], *chosen.tolist()])
    near: list[str] = []
    for name in ("plane_coarse", "plane_finest"):
        sets.farm(2, SCENES / f"{name}.toml", folder / name, "--points", str(folder / "points.csv"), *near)
        near = ["--near", str(folder / name)]
    return SnapshotSet(folder / "plane_finest")


def compared(known: TouchedSegment, full_order: SnapshotSet) -> dict:
    """Errors and estimates of every answer that is inside, by quantity."""
    answers, off = known.evaluate(full_order.random("parameters")), differences(known, full_order)
    force = full_order.random("contact_force")
    sizes = {"tip": np.linalg.norm(full_order.random("tip"), axis=1), "contact_force": force}
    sizes["touch_distance"] = np.abs(full_order.random("touch_distance"))
    found: dict = {"points": len(force), "failed": len(full_order.failures), "marked": int(np.sum(~answers.inside))}
    found["touch_wrong"] = int(np.sum(((answers.contact_force > 0) != (force > 0))[answers.inside]))
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


def row(run: Run, kind: str) -> dict:
    """One kind of points."""
    known = finger()
    return compared(known, solved(run, kind, np.round(drawn(run, kind, known), 7)))


def measure(run: Run) -> dict[str, dict]:
    """Coverage by kind of points."""
    return {kind: run.once(kind, row, run, kind) for kind in KINDS}

"""Fingers of rod elements: training cost against error, by mesh and number of lines.

The elements are trained on wrenches; the reference is a finer mesh, in states before the draft scene's plane. On finer
meshes every state begins at the same state on the draft mesh, whose cost counts, too.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fingerfem import load_scene
from rom import Rod, TouchedSegment
from rom.dataset.snapshot_set import SnapshotSet
from rom.error_statistics import quantiles
from rom.rod.objects.shapes import facing_plane
from studies import sets
from studies.control.models import DISTANCES
from studies.measures import call_time, random_points
from studies.parts import ROOT, Run
from studies.rods.plans import trained

PRESSED = ROOT / "scenes" / "demo" / "fine.toml"  # the draft scene's finger, with a load in place of the plane
SEED = 21
HELD_OUT = 6, 3  # random tensions, and distances of the plane at each
FELT = 0.1  # smallest contact force with a relative error [N]

Mesh = tuple[int, int, int]  # cells along and across, Lagrange order
DRAFT, SQUARE, FINE = (20, 5, 1), sets.STANDARD, (24, 6, 2)


class Training(NamedTuple):
    """Elements: their mesh and number of lines; the preset that chooses them."""

    mesh: Mesh
    lines: int
    preset: str | None = None


TRAINED = [
    Training(DRAFT, 8),
    Training(DRAFT, 16),
    Training(SQUARE, 8, "draft"),
    Training(SQUARE, 16),
    Training(FINE, 8, "standard"),
    Training(FINE, 24, "fine"),
]


def words(mesh: Mesh) -> str:
    """A mesh in a table."""
    return f"{mesh[0]} x {mesh[1]}, order {mesh[2]}"


def held_out(run: Run, mesh: Mesh) -> SnapshotSet:
    """Random states before the plane on a mesh, with the same parameters on all meshes."""
    file = sets.written(run.folder, f"plane {words(mesh)}", sets.as_toml(sets.draft_table(mesh)))
    place = file.with_suffix("") / "held-out"
    sets.farm(2, file, place, "--random", str(HELD_OUT[0]), "--distances", str(HELD_OUT[1]), "--seed", str(SEED))
    return SnapshotSet(place)


def errors(force: np.ndarray, tip: np.ndarray, truth: SnapshotSet, counted: np.ndarray | bool = True) -> dict[str, Any]:
    """Errors of contact forces, shape (states,) [N], and tip displacements, (states, 3) [m], in counted states."""
    true, moved = truth.random("contact_force"), truth.random("tip")
    felt = counted & (true > FELT)
    apart = np.linalg.norm(tip - moved, axis=1) / np.linalg.norm(moved, axis=1)
    return {
        "displacement": quantiles(np.where(counted, apart, np.nan)),
        "contact_force": quantiles(np.abs(force - true)[felt] / true[felt]),
    }


def mesh_row(run: Run, mesh: Mesh) -> dict[str, Any]:
    """Cost and error of a mesh."""
    own, truth = held_out(run, mesh), held_out(run, sets.REFERENCE)
    return {
        "name": words(mesh),
        "unknowns": 3 * len(own.nodes),
        "core_seconds": own.core_seconds / own.states,
        "iterations": own.iterations / own.states,
        **errors(own.random("contact_force"), own.random("tip"), truth),
    }


def training_sets(run: Run, mesh: Mesh, lines: int) -> list[SnapshotSet]:
    """Pressed states of the first lines, and those on the draft mesh where they begin."""
    begun = [] if mesh == DRAFT else training_sets(run, DRAFT, lines)
    table = load_scene(PRESSED).model_dump(mode="json", exclude_none=True, exclude={"coarse"})
    table["mesh"] = {"cells": list(mesh[:2]), "order": mesh[2]}
    table["sampling"] = {"lines": max(other.lines for other in TRAINED if mesh in (DRAFT, other.mesh))}
    file = sets.written(run.folder, f"pressed {words(mesh)}", sets.as_toml(table))
    place = file.with_suffix("")
    sets.farm(2, file, place, *(["--near", str(begun[0].path)] if begun else []))
    return [SnapshotSet(place).only([f"pressed-{k}" for k in range(lines)]), *begun]


def row(run: Run, one: Training) -> dict[str, Any]:
    """Cost and errors of a finger."""
    used, truth = training_sets(run, one.mesh, one.lines), held_out(run, sets.REFERENCE)
    file = run.folder / "rod.h5"
    trained(used[0]).save(file)
    finger = Rod.load(file)
    model = TouchedSegment(rod=finger, obstacle=facing_plane(finger.scene["geometry"]["side"], DISTANCES))
    answers = model.evaluate(truth.random("parameters"))
    return {
        "name": words(one.mesh),
        "cells": list(one.mesh[:2]),
        "order": one.mesh[2],
        "lines": one.lines,
        "coarse": None if one.mesh == DRAFT else {"cells": list(DRAFT[:2]), "order": DRAFT[2]},
        "preset": one.preset,
        "states": sum(part.states for part in used),
        "core_seconds": sum(part.core_seconds for part in used),
        "query_us": call_time(model.value_and_jacobian, random_points(model, 3000)),
        "marked": int(np.sum(~answers.inside)),
        "expected": finger.errors.contact_force,
        **errors(answers.contact_force, answers.tip, truth, answers.inside),
    }


def on_front(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows by cost; "front" marks those that no cheaper row beats in the error of the contact force."""
    best, found = np.inf, []
    for one in sorted(rows, key=lambda one: one["core_seconds"]):
        error = one["contact_force"]["p95"]
        found.append(one | {"front": error < best})
        best = min(best, error)
    return found


def measure(run: Run) -> dict[str, Any]:
    """All meshes, and all fingers with the front."""
    meshes = [run.once(words(mesh), mesh_row, run, mesh) for mesh in (DRAFT, SQUARE, FINE)]
    rows = [run.once(f"{words(one.mesh)}, {one.lines} lines", row, run, one) for one in TRAINED]
    return {"reference": words(sets.REFERENCE), "meshes": meshes, "rows": on_front(rows)}

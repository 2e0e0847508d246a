"""The paper's separated form of two sources: a finger of rod elements, and full-order states on the paper's grid."""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import replace
from typing import Any

import numpy as np

from rom import SeparatedModel, TouchedSegment, load, specialise
from rom.error_statistics import quantiles
from rom.native.forms import values
from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.form import Separated
from studies import sets
from studies.measures import call_times, random_points
from studies.parts import ROOT, Run

DISTANCES = 0.001, 0.031  # of the plane, as the paper has it [m]
NODES, TERMS, TOLERANCE = (8, 16, 32), (25, 200), 1e-5
GRIDS = 4, 8, 12  # nodes of every axis; the paper's 64 snapshots are 4 x 4 x 4
BATCH = 100_000  # points that are evaluated at once
RANDOM, FELT = 30_000, 0.1  # points at which errors are measured; least force that they are relative to [N]
STATES = 200  # held-out full-order ones


def finger() -> TouchedSegment:
    """The bundled finger before the paper's plane."""
    loaded = TouchedSegment.load()
    return replace(loaded, obstacle=replace(loaded.obstacle, distances=DISTANCES))


def row(table: SeparatedModel, **named: Any) -> dict[str, Any]:
    """What a table is, and its errors."""
    points = random_points(table, BATCH)
    begun = time.perf_counter()
    table.outputs(points)
    batch = time.perf_counter() - begun
    return named | {
        "terms": max(table.terms.values()),
        "accuracy": table.accuracy,
        "bytes": table.bytes,
        "marked": float(np.mean(~table.evaluate(points[:RANDOM]).inside)),
        "query_us": call_times(table.value_and_jacobian, points[:5000])["p50_us"],
        "values_us": 1e6 * batch / BATCH,
    }


def _tabled(nodes: int, terms: int) -> dict[str, Any]:
    options = EnrichmentOptions(tolerance=TOLERANCE, terms=terms)
    return row(specialise(finger(), nodes, options), nodes=nodes, most_terms=terms)


def of_the_rod(run: Run) -> list[dict[str, Any]]:
    """Tables of the bundled finger by nodes and terms."""
    return [run.once(f"{n} nodes, {most} terms", _tabled, n, most) for n in NODES for most in TERMS]


def _plain(nodes: int, terms: int) -> dict[str, Any]:
    """The contact force separated over (F, d), as it is."""
    model = finger()
    lower, upper = model.limits
    axes = [np.linspace(low, high, nodes) for low, high in zip(lower, upper, strict=True)]
    found = model.answers(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes)))
    force, by = (part[:, 3:4].reshape(*[nodes] * len(axes), 1, *part.shape[2:]) for part in found[:2])
    form = Separated.of(axes, force, by, EnrichmentOptions(tolerance=TOLERANCE, terms=terms))
    points = random_points(model, RANDOM)
    answer = model.evaluate(points)
    felt = answer.inside & (answer.contact_force > FELT)
    truth = answer.contact_force[felt]
    errors = np.abs(values(form.tables, 0, points[felt])[:, 0] - truth) / truth
    return {"nodes": nodes, "terms": form.terms, "contact_force": quantiles(errors)}


def without_alignment(run: Run) -> list[dict[str, Any]]:
    """The same without contact-aligned coordinates."""
    return [run.once(f"{n} nodes", _plain, n, TERMS[-1]) for n in NODES]


def _grid(run: Run, nodes: int) -> dict[str, Any]:
    snapshots = sets.training(sets.grid_scene(run.sets, nodes, nodes))
    states, file = sets.held_out(sets.draft(run.sets), STATES), run.folder / f"grid-{nodes}.h5"
    words = [sys.executable, "-m", "rom", "build", str(snapshots.path), "-o", str(file), "--held-out", str(states.path)]
    subprocess.run([*words, "--force"], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    table = load(file)
    assert isinstance(table, SeparatedModel)
    return row(table, nodes=nodes, states=snapshots.states, core_seconds=snapshots.core_seconds)


def of_states(run: Run) -> list[dict[str, Any]]:
    """Tables of full-order states on grids, the draft finger's, against held-out states."""
    return [run.once(f"grid of {n}", _grid, run, n) for n in GRIDS]

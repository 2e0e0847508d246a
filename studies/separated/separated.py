"""The paper's separated form of two sources: a finger of rod elements, and full-order states on the paper's grid."""

from __future__ import annotations

import subprocess
import sys
import time
from typing import Any

import numpy as np

from rom import SeparatedModel, load, specialise
from rom.separated.alternating_directions import EnrichmentOptions
from studies import sets
from studies.control.models import finger
from studies.measures import call_time, random_points
from studies.parts import ROOT, Run

TABLES = (8, 25), (16, 25), (16, 200), (32, 200)  # nodes of every axis, and terms at most
TOLERANCE = 1e-5
GRIDS = 4, 8, 12  # nodes of every axis; the paper's 64 snapshots are 4 x 4 x 4
BATCH, MARKED = 100_000, 30_000  # points that are evaluated at once, and those whose marks are counted
STATES = 100  # held-out full-order ones


def row(table: SeparatedModel, **named: Any) -> dict[str, Any]:
    """Size, speed and errors of a table."""
    points = random_points(table, BATCH)
    begun = time.perf_counter()
    table.outputs(points)
    batch = time.perf_counter() - begun
    return named | {
        "terms": max(table.terms.values()),
        "accuracy": table.accuracy,
        "bytes": table.bytes,
        "marked": float(np.mean(~table.evaluate(points[:MARKED]).inside)),
        "query_us": call_time(table.value_and_jacobian, points[:5000]),
        "values_us": 1e6 * batch / BATCH,
    }


def _of_rod(nodes: int, terms: int) -> dict[str, Any]:
    return row(specialise(finger(), nodes, EnrichmentOptions(tolerance=TOLERANCE, terms=terms)), nodes=nodes)


def of_the_rod(run: Run) -> list[dict[str, Any]]:
    """Tables of the bundled finger by nodes and terms."""
    return [run.once(f"{nodes} nodes, {terms} terms", _of_rod, nodes, terms) for nodes, terms in TABLES]


def _of_grid(run: Run, nodes: int) -> dict[str, Any]:
    snapshots = sets.training(sets.grid_scene(run.sets, nodes, nodes))
    states, file = sets.held_out(sets.draft(run.sets), STATES), run.folder / f"grid-{nodes}.h5"
    words = [sys.executable, "-m", "rom", "build", str(snapshots.path), "-o", str(file), "--held-out", str(states.path)]
    subprocess.run([*words, "--force"], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    table = load(file)
    assert isinstance(table, SeparatedModel)
    return row(table, nodes=nodes, states=snapshots.states, core_seconds=snapshots.core_seconds)


def of_states(run: Run) -> list[dict[str, Any]]:
    """Tables of full-order states on grids, the draft finger's, against held-out states."""
    return [run.once(f"grid of {nodes}", _of_grid, run, nodes) for nodes in GRIDS]

"""Hundreds of grasps of random solids: what became of each, and moments of them for the full-order model."""

from __future__ import annotations

import os
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

from control.mujoco import Simulation
from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.grasping.moments import MOMENTS, moment
from studies.grasping.task import attempt, trial
from studies.runner import Run, write_json

GRASPS, QUICK_GRASPS = 500, 10
CORES = 2
CHUNK = 20  # grasps that are kept together
COMPARED = 30  # moments that the full-order model computes
FROM, TO = 2.5, 8.0  # [s] of a grasp, between which its moment is drawn


def grasped(number: int) -> dict[str, Any]:
    """One grasp, with a moment of it if it came to that."""
    one, random = trial(number, SHAPES[number % len(SHAPES)]), np.random.default_rng([22, number])
    when, finger = float(random.uniform(FROM, TO)), int(random.integers(3))
    seen: list[dict[str, Any]] = []

    def look(simulation: Simulation) -> None:
        lifted = simulation.data.ctrl[2] > 0.001
        if not seen and simulation.time >= when and lifted:
            seen.append(moment(simulation, one.solid, finger))

    row = attempt(TouchedSegment.load(), one, [look])
    return row | ({"moment": seen[0]} if seen else {})


def chunk(numbers: list[int]) -> list[dict[str, Any]]:
    """Some grasps, on all cores."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return list(pool.map(grasped, numbers))


def measure(run: Run) -> dict[str, Any]:
    """All grasps; moments are left in a file."""
    count, rows = QUICK_GRASPS if run.quick else GRASPS, []
    for first in range(0, count, CHUNK):
        last = min(first + CHUNK, count)
        rows += run.once(f"grasps {first} to {last - 1}", chunk, list(range(first, last)))
    seen = [row.pop("moment") for row in rows if "moment" in row]
    usable = [one for one in seen if "skipped" not in one]
    order = np.random.default_rng(0).permutation(len(usable))[:COMPARED]
    write_json(run.folder / MOMENTS, [usable[k] for k in sorted(order)])
    return {"rows": rows, "skipped": dict(Counter(one["skipped"] for one in seen if "skipped" in one))}

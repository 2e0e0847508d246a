"""Hundreds of grasps of random solids, and the outcome of each."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.grasping.task import attempt, trial
from studies.parts import Run

GRASPS = 500
CORES = 2
CHUNK = 20  # grasps that are kept together


def grasped(number: int) -> dict[str, Any]:
    """One grasp."""
    return attempt(TouchedSegment.load(), trial(number, SHAPES[number % len(SHAPES)]))


def chunk(numbers: list[int]) -> list[dict[str, Any]]:
    """Some grasps, on all cores."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return list(pool.map(grasped, numbers))


def measure(run: Run) -> dict[str, Any]:
    """All grasps."""
    rows = []
    for first in range(0, GRASPS, CHUNK):
        last = min(first + CHUNK, GRASPS)
        rows += run.once(f"grasps {first} to {last - 1}", chunk, list(range(first, last)))
    return {"rows": rows}

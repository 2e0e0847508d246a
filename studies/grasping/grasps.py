"""Hundreds of grasps of random solids, and the outcome of each."""

from __future__ import annotations

from typing import Any

from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.cores import on_cores
from studies.grasping.task import attempt
from studies.grasping.trials import trial
from studies.parts import Run

GRASPS, CHUNK = 100, 10  # in all, and kept together


def grasped(number: int) -> dict[str, Any]:
    """One grasp."""
    return attempt(TouchedSegment.load(), trial(number, SHAPES[number % len(SHAPES)]))


def measure(run: Run) -> list[dict[str, Any]]:
    """All grasps."""
    chunks = [[(number,) for number in range(first, first + CHUNK)] for first in range(0, GRASPS, CHUNK)]
    return [row for k, calls in enumerate(chunks) for row in run.once(f"chunk {k}", on_cores, grasped, calls)]

"""Hundreds of grasps of random solids, and the outcome of each; every fifty are a part of the study."""

from __future__ import annotations

from functools import partial
from typing import Any

from control.mujoco.solids import SHAPES
from rom import TouchedSegment
from studies.cores import on_cores
from studies.grasping.task import attempt
from studies.grasping.trials import trial
from studies.parts import Run

PART, CHUNK = 50, 10  # grasps of a part, and kept together


def grasped(number: int) -> dict[str, Any]:
    """One grasp."""
    return attempt(TouchedSegment.load(), trial(number, SHAPES[number % len(SHAPES)]))


def measure(run: Run, begin: int) -> list[dict[str, Any]]:
    """The grasps of a part from a number on."""
    chunks = [[(number,) for number in range(first, first + CHUNK)] for first in range(begin, begin + PART, CHUNK)]
    return [row for calls in chunks for row in run.once(f"from {calls[0][0]}", on_cores, grasped, calls)]


first, second, third, fourth, fifth = (partial(measure, begin=PART * k) for k in range(5))
sixth, seventh, eighth, ninth, tenth = (partial(measure, begin=PART * k) for k in range(5, 10))

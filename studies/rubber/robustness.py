"""Contact of the bundled finger with many random objects: each has an answer or a reason."""

from __future__ import annotations

from collections import Counter

import numpy as np

from rom import Rod, TouchedSegment
from studies.parts import Run
from studies.rods.full_order import rigid
from studies.rods.random_objects import SHAPES, clear_of_clamp, on_plate

COUNT = 1500  # of objects of every shape


def verdicts(finger: Rod, shape: str) -> dict:
    """The outcomes of random objects of a shape, each solved once without an initial guess."""
    random, found, evaluations = np.random.default_rng(7), Counter[str](), list[int]()
    for _ in range(COUNT):
        drawn = on_plate(finger, random, shape)
        (table,) = drawn.objects
        if not clear_of_clamp(finger, table, drawn.d):
            found["clamp"] += 1
            continue
        answer = TouchedSegment(rod=finger, obstacle=rigid(table)).answers(np.array([*drawn.tensions, drawn.d]))
        evaluations.append(abs(int(answer.evaluations[0])))
        found["slips" if answer.evaluations[0] < 0 else "answered" if answer.inside[0] else "beyond"] += 1
    median, most = np.percentile(evaluations, [50, 99])
    counts = {name: found[name] for name in ("answered", "beyond", "slips", "clamp")}
    return {"shape": shape, "objects": COUNT, **counts, "median": float(median), "p99": float(most)}


def measure(run: Run) -> list[dict]:
    """A row a shape."""
    finger = TouchedSegment.load().rod
    return [run.once(shape, verdicts, finger, shape) for shape in SHAPES]

"""Contact with random objects of all kinds: each has an answer or a reason; no force jumps."""

from __future__ import annotations

from collections import Counter

import numpy as np

from rom import Rod, TouchedSegment
from rom.rod.objects.shapes import facing_plane
from studies.parts import Run
from studies.rods.scattered_objects import DISTANCE, SHAPES, placed, tensions
from studies.rubber.random_objects import clear_of_clamp

DEEPEST = 0.003  # [m]: how far objects come beyond the free plate
POINTS, REFINED = 64, 60  # of a line; bisections of its largest step
JUMP = 1e-6  # [N]


def verdicts(finger: Rod, shape: str, count: int) -> dict:
    """The outcomes of random objects of a shape."""
    random = np.random.default_rng(7)
    found: Counter[str] = Counter()
    evaluations = []
    for _ in range(count):
        pulled = tensions(finger, random)
        obstacle, table = placed(finger, pulled, random, shape)
        model, d = TouchedSegment(rod=finger, obstacle=obstacle), DISTANCE - DEEPEST * random.random()
        answer = model.answers(np.array([*pulled, d]))
        if not clear_of_clamp(finger, table, d):
            found["in the clamp"] += 1
            continue
        evaluations.append(abs(int(answer.evaluations[0])))
        if answer.evaluations[0] < 0:
            found["slips"] += 1
        elif answer.inside[0]:
            found["answered"] += 1
        else:
            found["beyond"] += 1
    assert sum(found.values()) == count
    ends = np.percentile(evaluations, [50, 99, 100])
    return {
        "shape": shape,
        "objects": count,
        **{name: found[name] for name in ("answered", "beyond", "slips", "in the clamp")},
        **{f"evaluations_{name}": float(end) for name, end in zip(("median", "p99", "max"), ends, strict=True)},
    }


def jumps(finger: Rod, count: int) -> dict:
    """Largest jump of the contact force along random lines of tensions and distance, before the paper's plane."""
    random = np.random.default_rng(8)
    model = TouchedSegment(rod=finger, obstacle=facing_plane(2 * finger.half_lengths[1], (0.001, 0.031)))
    lower, upper = model.limits
    largest, over = 0.0, 0
    share = np.linspace(0.0, 1.0, POINTS)[:, None]
    for _ in range(count):
        ends = lower + random.random((2, len(lower))) * (upper - lower)
        points = ends[0] + share * (ends[1] - ends[0])
        answer = model.answers(points)
        known = answer.inside[1:] & answer.inside[:-1]
        steps = np.where(known, np.abs(np.diff(answer.out[:, 3])), 0.0)
        k = int(np.argmax(steps))
        left, right = points[k], points[k + 1]
        for _ in range(REFINED):  # towards what is not smooth, if there is anything
            middle = (left + right) / 2
            forces = model.outputs(np.array([left, middle, right]))[:, 3]
            left, right = (left, middle) if abs(forces[1] - forces[0]) > abs(forces[2] - forces[1]) else (middle, right)
        ends_of = model.answers(np.array([left, right]))
        jump = float(np.ptp(ends_of.out[:, 3])) if ends_of.inside.all() else 0.0
        largest, over = max(largest, jump), over + (jump > JUMP)
    return {"lines": count, "largest_n": largest, "over": over, "limit_n": JUMP}


def measure(run: Run) -> dict:
    """All shapes, then lines; of the bundled finger."""
    finger, count = TouchedSegment.load().rod, 2500
    return {
        "verdicts": [run.once(shape, verdicts, finger, shape, count) for shape in SHAPES],
        "jumps": run.once("lines", jumps, finger, 5_000),
    }

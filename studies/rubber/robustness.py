"""Random objects that touch the bundled finger: each has an answer or a reason; no force jumps."""

from __future__ import annotations

from collections import Counter

import numpy as np

from rom import TouchedSegment
from rom.rod.objects.shapes import facing_plane
from studies.cores import on_cores
from studies.parts import Run
from studies.rods.full_order import rigid
from studies.rods.random_objects import DISTANCE, SHAPES, at_plate, clear_of_clamp, tensions

COUNT, LINES, DEEPEST = 2500, 5000, 3e-3  # objects of every shape; lines; how far objects advance beyond touch [m]
POINTS, BISECTIONS, JUMP = 64, 60, 1e-6  # of a line; of its steepest step; force that counts as a jump [N]


def outcomes(shape: str) -> dict:
    """Numbers of objects of a shape, by what became of the contact."""
    finger, random, found = TouchedSegment.load().rod, np.random.default_rng(7), Counter[str]()
    for _ in range(COUNT):
        pulled = tensions(finger, random)
        table, d = at_plate(finger, pulled, random, shape), DISTANCE - DEEPEST * random.random()
        answer = TouchedSegment(rod=finger, obstacle=rigid(table)).answers(np.array([*pulled, d]))
        if not clear_of_clamp(finger, table, d):
            found["in_the_clamp"] += 1
        elif answer.evaluations[0] < 0:
            found["no_equilibrium"] += 1
        else:
            found["answered" if answer.inside[0] else "beyond"] += 1
    return {"shape": shape} | {name: found[name] for name in ("answered", "beyond", "no_equilibrium", "in_the_clamp")}


def jumps() -> dict:
    """Largest jump of the contact force along random lines of tensions and distance, before the paper's plane."""
    finger, random = TouchedSegment.load().rod, np.random.default_rng(8)
    model = TouchedSegment(rod=finger, obstacle=facing_plane(2 * finger.half_lengths[1], (0.001, 0.031)))
    (lower, upper), found = model.limits, []
    for _ in range(LINES):
        begin, end = random.uniform(lower, upper, (2, len(lower)))
        points = np.linspace(begin, end, POINTS)
        answer = model.answers(points)
        steps = np.abs(np.diff(answer.out[:, 3])) * (answer.inside[1:] & answer.inside[:-1])
        left, right = points[(k := int(np.argmax(steps)))], points[k + 1]
        for _ in range(BISECTIONS):  # towards the half with the larger change
            middle = (left + right) / 2
            change = np.abs(np.diff(model.outputs(np.array([left, middle, right]))[:, 3]))
            left, right = (left, middle) if change[0] > change[1] else (middle, right)
        ends = model.answers(np.array([left, right]))
        found.append(float(np.ptp(ends.out[:, 3])) if ends.inside.all() else 0.0)
    return {"lines": LINES, "largest_n": max(found), "over": sum(one > JUMP for one in found), "limit_n": JUMP}


def measure(run: Run) -> dict:
    """Outcomes by shape, and jumps."""
    shapes = run.once("shapes", on_cores, outcomes, [(shape,) for shape in SHAPES])
    return {"shapes": shapes, "jumps": run.once("lines", jumps)}

"""The bundled finger and its contact with the paper's plane: compiled code alone, one core, one run."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from control import Finger, problems
from rom import TouchedSegment
from rom.rod.compiled import touched as native
from rom.rod.objects.shapes import facing_plane
from studies.parts import Run

MOVED = 1e-4  # [m]: of the plane, for warm starts
FORCE = 0.5  # to hold [N]


def us(nanoseconds: Sequence[int] | np.ndarray) -> dict[str, float]:
    """Median and 99th percentile [us]."""
    half, most = np.percentile(nanoseconds, [50, 99]) / 1e3
    return {"p50_us": float(half), "p99_us": float(most)}


def each(call, arguments: list) -> list[int]:
    """Time of every call [ns]."""
    found = []
    for given in arguments:
        begun = time.perf_counter_ns()
        call(*given)
        found.append(time.perf_counter_ns() - begun)
    return found


def row(count: int) -> dict:
    """Everything, one after the other on the same points."""
    finger = TouchedSegment.load().rod
    model = TouchedSegment(rod=finger, obstacle=facing_plane(2 * finger.half_lengths[1], (0.001, 0.031)))
    lower, upper = model.limits
    points = lower + np.random.default_rng(0).random((count, len(lower))) * (upper - lower)
    known = model.answers(points)
    touched = known.inside & (known.out[:, 3] > 0)
    points, wrenches = np.ascontiguousarray(points[touched]), known.loads[touched]
    parts = [(np.ascontiguousarray(p[:-1]), np.ascontiguousarray(w)) for p, w in zip(points, wrenches, strict=True)]
    plate = finger.segments[0].struct
    room, found = native.memory_of(plate), [native.pointer(np.empty(size)) for size in (3, 9, 6 * (len(lower) + 5))]
    ours = [(plate, *map(native.pointer, part), room, *found) for part in parts]
    place = each(native.LIBRARY.functions.fingerfem_place, ours)
    cold = native.touches(model.touching, points)
    warm = native.touches(model.touching, points + MOVED * np.eye(len(lower))[-1], wrenches)
    driven = Finger(model)
    _, outcomes, taken = problems.hold_many(driven.compiled, points[:, :-1], FORCE, points[:, -1], problems.rules(1e-6))
    return {
        "points": len(points),
        "elements": len(finger.segments[0].elements),
        "terms": sum(len(law.polynomial.powers) for law in finger.elements.laws.values()),
        "place": us(place),
        "contact_cold": us(cold.nanoseconds) | {"evaluations": float(np.median(cold.evaluations))},
        "contact_warm": us(warm.nanoseconds) | {"evaluations": float(np.median(warm.evaluations))},
        "hold": us(taken) | {"converged": int(np.sum(outcomes["status"] == 1)), "of": len(points)},
    }


def measure(run: Run) -> dict:
    """One row."""
    return run.once("speed", row, 6000)

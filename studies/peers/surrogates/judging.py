"""Errors and times of a model of tip and contact force on held-out states."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from studies.peers.surrogates.states import HeldOut

FELT = 0.1  # above which relative errors of contact forces are counted [N]
TOUCH = FELT / 2  # above which a force is taken for contact: a method that fits numbers hardly says exactly 0 [N]
CALLS = 500  # single queries that are timed

Asked = Callable[[np.ndarray], np.ndarray]  # tip [m] and contact force [N], shape (4,), at one point, shape (p,)


def errors(told: np.ndarray, tested: HeldOut) -> dict[str, dict[str, float]]:
    """Of tips and contact forces that a model tells, shape (states, 4).

    Returns:
        by quantity median, 95th percentile and largest: `contact_force` relative, where it is above 0.1 N; `tip` over
        the true tip's way; `tip_distance` [m]. `touch`: the share of states in which one tells contact and the other
        none, among those that are free or whose force is above 0.1 N.
    """
    off = np.linalg.norm(told[:, :3] - tested.tip, axis=1)
    felt, free = tested.force > FELT, tested.force <= 0
    force = np.abs(told[:, 3] - tested.force)[felt] / tested.force[felt]
    wrong = (told[:, 3] > TOUCH) != felt
    return {
        "contact_force": _spread(force),
        "tip": _spread(off / np.linalg.norm(tested.tip, axis=1)),
        "tip_distance": _spread(off),
        "touch": {
            "wrong": float(wrong[felt | free].mean()),
            "without_touch": int(wrong[free].sum()),
            "missed": int(wrong[felt].sum()),
            "free": int(free.sum()),
            "felt": int(felt.sum()),
        },
    }


def _spread(of: np.ndarray) -> dict[str, float]:
    return {"median": float(np.median(of)), "p95": float(np.percentile(of, 95)), "max": float(of.max())}


def query_times(ask: Asked, points: np.ndarray) -> dict[str, float]:
    """Core time of single queries at points, shape (points, p): mean [s], median and 99th percentile [µs]."""
    ask(points[0])  # compiles, fills caches
    taken = np.empty(CALLS)
    for call in range(CALLS):
        point = points[call % len(points)]
        begun = time.process_time_ns()
        ask(point)
        taken[call] = time.process_time_ns() - begun
    return {
        "seconds": float(taken.mean()) / 1e9,
        "p50_us": float(np.percentile(taken, 50)) / 1e3,
        "p99_us": float(np.percentile(taken, 99)) / 1e3,
    }


def best_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The way of the smallest errors on the test states, which is generous: medians of contact force and tip, added."""
    return min(rows, key=lambda one: one["contact_force"]["median"] + one["tip"]["median"])

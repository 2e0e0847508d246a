"""Measurements that studies share: times of calls, quantiles of errors, points of a model's box."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from control.model import Model


def call_time(call: Callable[[np.ndarray], Any], points: np.ndarray) -> float:
    """Median of a call's time [us], at each of `points`, shape (points, parameters)."""
    call(points[0])
    taken = np.empty(len(points))
    for k, point in enumerate(points):
        begun = time.perf_counter_ns()
        call(point)
        taken[k] = time.perf_counter_ns() - begun
    return float(np.median(taken)) / 1e3


def random_points(model: Model, count: int) -> np.ndarray:
    """Random parameters of a model's box, shape (count, parameters)."""
    lower, upper = model.limits
    return lower + np.random.default_rng(0).random((count, len(lower))) * (upper - lower)

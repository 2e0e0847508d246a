"""Closed paths of the tip across the finger, which start at rest and reach a constant rate."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def circle(centre: ArrayLike, radius: float, rate: float, period: float, laps: float) -> np.ndarray:
    """Return a circle as rows of y and z, shape (n, 2) [m], one per period, from its lowest y.

    Args:
        centre: y and z of the tip plate's centre, shape (2,) [m].
        radius: [m].
        rate: laps per second [Hz]; the first half lap, from rest, takes the time of a lap.
        period: time between rows [s].
        laps: number of laps.
    """
    phase = _phase(rate, period, laps)
    return np.asarray(centre, float) + radius * np.column_stack([-np.cos(phase), np.sin(phase)])


def eight(centre: ArrayLike, radius: float, rate: float, period: float, laps: float) -> np.ndarray:
    """Return a figure of eight, 2 radii wide along z and one radius along y, with the arguments of `circle`."""
    phase = _phase(rate, period, laps)
    return np.asarray(centre, float) + radius * np.column_stack([np.sin(2 * phase) / 2, np.sin(phase)])


def _phase(rate: float, period: float, laps: float) -> np.ndarray:
    """Phase of every row [rad]; its rate rises as 3 s^2 - 2 s^3 for s from 0 to 1."""
    for name, value in (("rate", rate), ("period", period), ("laps", laps)):
        if not 0 < value < np.inf:
            raise ValueError(f"{name} must be finite and above 0, got {value}")
    turns = rate * period * np.arange(1 + round((laps + 0.5) / (rate * period)))
    s = np.minimum(turns, 1.0)
    return np.asarray(2 * np.pi * (s**3 - s**4 / 2 + np.maximum(turns - 1.0, 0.0)))

"""Closed paths of the tip across the finger, which start at rest and reach a constant rate."""

import numpy as np
from numpy.typing import ArrayLike

from control.tracking.arguments import number, numbers, positive

MOST_OF_A_LAP = 0.25  # from row to row [-]
FARTHEST = 2.0  # from the axis, over the finger's length, is no tip's reading usable [-]
MOST_ROWS = 1_000_000


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
    return numbers("centre", centre, (2,), "m") + number("radius", radius, 0.0, "m") * np.column_stack(
        [-np.cos(phase), np.sin(phase)]
    )


def eight(centre: ArrayLike, radius: float, rate: float, period: float, laps: float) -> np.ndarray:
    """Return a figure of eight, 2 radii wide along z and one radius along y, with the arguments of `circle`."""
    phase = _phase(rate, period, laps)
    return numbers("centre", centre, (2,), "m") + number("radius", radius, 0.0, "m") * np.column_stack(
        [np.sin(2 * phase) / 2, np.sin(phase)]
    )


def checked_path(path: ArrayLike) -> np.ndarray:
    """Return a copy of a path, shape (n, 2) [m].

    Raises:
        ValueError: it has another shape, fewer than three rows, or numbers that are not finite.
    """
    rows = numbers("path", path, (None, 2), "m")
    if len(rows) < 3:
        raise ValueError(f"path must have at least three rows of y and z, got {len(rows)}")
    return rows


def across(tip: ArrayLike | None, farthest: float) -> np.ndarray:
    """Return y and z, shape (2,), of a reading of the tip, shape (3,) [m]; nan without one within `farthest` [m]."""
    if tip is None:
        return np.full(2, np.nan)
    reading = np.asarray(tip)
    if reading.shape != (3,) or reading.dtype.kind not in "fiu":
        raise ValueError(f"tip must be numbers x, y and z [m], got {tip!r}")
    found = np.asarray(reading[1:], float)
    return found if np.abs(found).max() < farthest else np.full(2, np.nan)


def _phase(rate: float, period: float, laps: float) -> np.ndarray:
    """Phase of every row [rad]; its rate rises as 3 s^2 - 2 s^3 for s from 0 to 1."""
    positive("rate", rate, "Hz"), positive("period", period, "s"), positive("laps", laps)
    if not rate * period <= MOST_OF_A_LAP:
        raise ValueError(f"rate times period must be at most {MOST_OF_A_LAP:g} laps a row, got {rate * period:g}")
    if not laps <= MOST_ROWS * rate * period:
        raise ValueError(f"laps must be at most {MOST_ROWS * rate * period:g}, in {MOST_ROWS} rows, got {laps:g}")
    turns = rate * period * np.arange(1 + round((laps + 0.5) / (rate * period)))
    s = np.minimum(turns, 1.0)
    return np.asarray(2 * np.pi * (s**3 - s**4 / 2 + np.maximum(turns - 1.0, 0.0)))

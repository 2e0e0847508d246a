"""Loads as functions of time: points joined by straight lines, with jumps between two of one time; or a sine."""

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Signal:
    """Straight lines between points, constant before the first and after the last.

    Attributes:
        times: not falling, shape (n,) [s]; two that are equal make a jump.
        values: shape (n,).
    """

    times: np.ndarray
    values: np.ndarray

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest value."""
        return float(self.values.min()), float(self.values.max())

    def value(self, time: float, after: bool) -> float:
        """Value at a time [s]; at a jump the one after it, or before."""
        k = int(np.searchsorted(self.times, time, "right" if after else "left"))
        if k in (0, len(self.times)):
            return float(self.values[min(k, len(self.times) - 1)])
        return float(np.interp(time, self.times[k - 1 : k + 1], self.values[k - 1 : k + 1]))

    def slope(self, time: float, after: bool) -> float:
        """Change per time, likewise [1/s]."""
        k = int(np.searchsorted(self.times, time, "right" if after else "left"))
        if k in (0, len(self.times)):
            return 0.0
        return float(np.diff(self.values[k - 1 : k + 1])[0] / np.diff(self.times[k - 1 : k + 1])[0])

    @property
    def has_jumps(self) -> bool:
        """True if two points have the same time."""
        return bool((np.diff(self.times) == 0).any())


@dataclass(frozen=True)
class Sine:
    """mean + amplitude sin(2 pi frequency t + phase), with the frequency [Hz] and the phase [rad]."""

    mean: float
    amplitude: float
    frequency: float
    phase: float

    times = np.zeros(0)  # none at which it is not smooth
    has_jumps = False

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest value."""
        return self.mean - abs(self.amplitude), self.mean + abs(self.amplitude)

    def value(self, time: float, after: bool) -> float:
        """Value at a time [s]."""
        return float(self.mean + self.amplitude * np.sin(2 * np.pi * self.frequency * time + self.phase))

    def slope(self, time: float, after: bool) -> float:
        """Change per time [1/s]."""
        rate = 2 * np.pi * self.frequency
        return float(self.amplitude * rate * np.cos(rate * time + self.phase))


def read_signal(name: str, given: Any) -> Signal | Sine:
    """A number, a list of [time, value], or a table of a sine.

    Raises:
        ValueError: name, rule, value.
    """
    if isinstance(given, dict):
        return _sine(name, given)
    rows = [[0.0, given]] if _is_number(given) else given
    is_list = isinstance(rows, list) and rows and all(isinstance(row, list) and len(row) == 2 for row in rows)
    if not is_list or not all(_is_number(one) for row in rows for one in row):
        raise ValueError(f"{name} must be a number, a list of [time, value] or a table of a sine, got {given!r}")
    times, values = np.array(rows, float).T
    return piecewise(name, times, values)


def piecewise(name: str, times: np.ndarray, values: np.ndarray) -> Signal:
    """The signal through points.

    Raises:
        ValueError: name, rule, value.
    """
    if not (np.isfinite(times).all() and np.isfinite(values).all()):
        raise ValueError(f"{name} must have finite times and values, got another")
    falls = np.flatnonzero(np.diff(times) < 0)
    if falls.size:
        raise ValueError(
            f"{name} must have times that do not fall, got {times[falls[0] + 1]:g} s after {times[falls[0]]:g} s"
        )
    thrice = np.flatnonzero(times[2:] == times[:-2])
    if thrice.size:
        raise ValueError(f"{name} must have at most two points of one time, got three at {times[thrice[0]]:g} s")
    return Signal(times, values)


def _sine(name: str, given: dict[str, Any]) -> Sine:
    known = {"mean": 0.0, "amplitude": None, "frequency": None, "phase": 0.0}
    if unknown := sorted(given.keys() - known.keys()):
        raise ValueError(f"{name} must have the keys {', '.join(known)}, got {unknown[0]}")
    whole = known | given
    for key, value in whole.items():
        if not _is_number(value) or not np.isfinite(value):
            raise ValueError(f"{name}.{key} must be a finite number, got {value!r}")
    if whole["frequency"] <= 0:
        raise ValueError(f"{name}.frequency must be above 0 Hz, got {whole['frequency']:g}")
    return Sine(**{key: float(value) for key, value in whole.items()})


def _is_number(given: Any) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool)

"""Loads, and steps of continuation between them, with the prediction of their ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Loads(NamedTuple):
    """Loads of the finger: tensions [N] then pressures [Pa], d [m], wrenches [N, N m], share of weight [-]."""

    tensions: np.ndarray
    distance: float | None
    wrenches: np.ndarray
    weight: float

    def towards(self, target: Loads, share: float) -> Loads:
        """Loads at a share [-] of the straight path to others."""
        if share == 1:
            return target
        tensions, wrenches = (
            one + share * (other - one)
            for one, other in ((self.tensions, target.tensions), (self.wrenches, target.wrenches))
        )
        distance, weight = target.distance, self.weight + share * (target.weight - self.weight)
        if distance is not None and self.distance is not None:
            distance = self.distance + share * (distance - self.distance)
        return Loads(tensions, distance, wrenches, weight)


@dataclass(frozen=True, kw_only=True)
class Step:
    """A step that began at an equilibrium.

    Attributes:
        load: change of the tensions [N] and pressures [Pa], of the wrenches [N, N m], of the weight's share [-] and of
            d [m], shape (actuators + 6 plates + 2,).
        start: owned displacements where it began [m].
        slope: change of displacement that the tangent expects of the step [m].
    """

    load: np.ndarray
    start: np.ndarray
    slope: np.ndarray

    def change_after(self, last: Step) -> np.ndarray:
        """Change of displacement by the cubic through both ends of the last step, shape (owned values,) [m].

        By the tangent if the direction of the load changes, or if the step more than doubles.
        """
        ratio = float(np.max(np.abs(self.load)) / np.max(np.abs(last.load)))
        if ratio > 2 or not np.allclose(self.load, ratio * last.load, rtol=1e-6, atol=0):
            return self.slope
        rise, before, after = self.start - last.start, last.slope, self.slope / ratio
        t = 1 + ratio
        value = t**2 * (3 - 2 * t) * rise + t * (1 - t) ** 2 * before + t**2 * (t - 1) * after
        return value - rise

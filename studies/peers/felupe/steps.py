"""Load steps for FElupe's Newton method; imported in FElupe's own process alone."""

from __future__ import annotations

from dataclasses import dataclass

import felupe
import numpy as np

from studies.peers.felupe.finger import Finger

FAILURES = (felupe.tools.NewtonConvergenceError, ArithmeticError, np.linalg.LinAlgError)
FIRST, SMALLEST = 0.25, 1 / 512  # steps, as fractions of a way


class NotReached(Exception):
    """A load that no steps led to."""


@dataclass(frozen=True)
class Load:
    """Tensions, shape (tendons,) [N], and the plane's distance [m], None where it is away."""

    tensions: np.ndarray
    distance: float | None

    def towards(self, target: Load, fraction: float) -> Load:
        """The load at a fraction of the way to another; a plane that was away is at once where the other has it."""
        distance = target.distance
        if distance is not None and self.distance is not None:
            distance = self.distance + fraction * (distance - self.distance)
        return Load(self.tensions + fraction * (target.tensions - self.tensions), distance)


@dataclass(frozen=True)
class Equilibrium:
    """A displacement, shape (nodes, 3) [m], its load, and the equilibrium it was reached from, if there was one."""

    displacement: np.ndarray
    load: Load
    before: Equilibrium | None = None

    def start(self, target: Load) -> np.ndarray:
        """Where the last two equilibria's secant expects a target on their line of loads; off it, this one [m]."""
        if self.before is None:
            return self.displacement
        last, next_ = _change(self.before.load, self.load), _change(self.load, target)
        ratio = float(next_ @ last) / float(last @ last) if last.any() else 0.0
        if ratio <= 0 or not np.allclose(next_, ratio * last, rtol=1e-9, atol=0):
            return self.displacement
        return self.displacement + ratio * (self.displacement - self.before.displacement)


def _change(one: Load, other: Load) -> np.ndarray:
    """Of tensions and distance; a plane that comes is no way that goes on."""
    came = (one.distance is None) != (other.distance is None)
    moved = np.nan if came else (other.distance or 0.0) - (one.distance or 0.0)
    return np.append(other.tensions - one.tensions, moved)


def adaptively(finger: Finger, origin: Equilibrium, target: Load) -> Equilibrium:
    """From an equilibrium to a load: a step that fails is halved, and doubled again after two that do not.

    Raises:
        NotReached: a step smaller than SMALLEST would be needed.
    """
    found, reached, size, failed = origin, 0.0, FIRST, False
    while reached < 1.0:
        ahead = min(reached + size, 1.0)
        load = target if ahead == 1.0 else origin.load.towards(target, ahead)
        try:
            solved = finger.solve(found.start(load), load.tensions, load.distance)
        except FAILURES as failure:
            size, failed = size / 2, True
            if size < SMALLEST:
                raise NotReached(str(failure).strip()) from None
            continue
        found = Equilibrium(solved, load, found)
        reached, size, failed = ahead, size if failed else 2 * size, False
    return found

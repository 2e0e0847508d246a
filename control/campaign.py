"""Campaigns: hold one force from thousands of starts, every answer judged and every solve timed.

Chenevier et al., PLoS ONE 13(2): e0192052 (2018), table 1: 10,000 random starts. Their published results are a sweep of
100 distances times 100 starts.
"""

from dataclasses import dataclass, field
from time import perf_counter_ns
from typing import Any

import numpy as np

from control.finger import Finger
from control.least_squares import CONVERGED, STATIONARY
from control.model import Model
from control.problems import hold_many, rules
from rom.brief import brief
from rom.console.terminal import Progress, quiet

CALLS = 2000  # of Python that are timed
AT_ONCE = 10_000  # holds between two moments at which it can be interrupted


@brief
@dataclass(frozen=True, kw_only=True)
class Campaign:
    """Results of many solves.

    Attributes:
        distances: of the plane, shape (n,) [m].
        starts: shape (n, tensions) [N].
        tensions: that came out, shape (n, tensions) [N].
        status: of each, see control.least_squares, shape (n,).
        residual: |contact force - target|, shape (n,) [N].
        iterations: evaluations of the model, shape (n,).
        microseconds: of each solve in compiled code, shape (n,) [us].
        call_microseconds: of calls of Finger.hold from Python, the first of them [us].
        lower, upper: limits of the tensions, shape (tensions,) [N].
        contact_force: target [N].
    """

    distances: np.ndarray = field(repr=False)
    starts: np.ndarray = field(repr=False)
    tensions: np.ndarray = field(repr=False)
    status: np.ndarray = field(repr=False)
    residual: np.ndarray = field(repr=False)
    iterations: np.ndarray = field(repr=False)
    microseconds: np.ndarray = field(repr=False)
    call_microseconds: np.ndarray = field(repr=False)
    lower: np.ndarray
    upper: np.ndarray
    contact_force: float

    def as_json(self) -> dict[str, Any]:
        """Counts, and times by mean and quantiles."""
        beyond = (self.tensions < self.lower) | (self.tensions > self.upper)
        infinite = ~np.isfinite(self.tensions)
        converged, unreachable = (int(np.sum(self.status == code)) for code in (CONVERGED, STATIONARY))
        return {
            "starts": len(self.status),
            "contact_force": self.contact_force,
            "converged": converged,
            "unreachable": unreachable,
            "failed": len(self.status) - converged - unreachable,
            "out_of_limits": int(np.any(beyond | infinite, axis=1).sum()),
            "infinite": int(np.any(infinite, axis=1).sum()),
            "largest_residual": float(self.residual[self.status == CONVERGED].max(initial=0.0)),
            "mean_iterations": float(self.iterations.mean()),
            "mean_us": float(self.microseconds.mean()),
            **_quantiles("", self.microseconds),
            "call_mean_us": float(self.call_microseconds.mean()),
            **_quantiles("call_", self.call_microseconds),
        }


def _quantiles(name: str, times: np.ndarray) -> dict[str, float]:
    quantiles = np.percentile(times, [50, 99, 100])
    return {f"{name}{which}_us": float(time) for which, time in zip(("p50", "p99", "max"), quantiles, strict=True)}


def run(
    model: Model,
    starts: int,
    contact_force: float,
    sweep: bool = False,
    seed: int = 2018,
    *,
    progress: Progress = quiet,
) -> Campaign:
    """Hold `contact_force` [N] at random distances from random starts; or, as the authors' sweep, on a grid.

    Args:
        model: of the finger.
        starts: how many; a sweep has the nearest square.
        contact_force: [N].
        sweep: every distance with every start of the lead tendon, the others slack.
        seed: of the random starts.
        progress: is called with the count that is done.

    Raises:
        ValueError: a contact force that is not above 0, or a model without an obstacle.
    """
    if not (np.isfinite(contact_force) and contact_force > 0):
        raise ValueError(f"contact_force must be above 0 N, got {contact_force}")
    if not model.has_obstacle:
        raise ValueError("model must have an obstacle to hold a force, got a scene without one")
    finger, (lower, upper) = Finger(model), model.limits
    if sweep:
        side = max(2, round(np.sqrt(starts)))
        distances = np.repeat(np.linspace(lower[-1], upper[-1], side), side)
        begun = np.tile(lower[:-1], (side * side, 1))
        begun[:, model.lead] = np.tile(np.linspace(lower[model.lead], upper[model.lead], side), side)
    else:
        random = np.random.default_rng(seed).random((starts, len(lower)))
        points = lower + random * (upper - lower)
        distances, begun = points[:, -1].copy(), points[:, :-1].copy()
    held = []
    for k in range(0, len(distances), AT_ONCE):
        progress("holding", k, len(distances))
        some = slice(k, k + AT_ONCE)
        held.append(hold_many(finger.compiled, begun[some], float(contact_force), distances[some], rules(1e-6)))
    progress("holding", len(distances), len(distances))
    tensions, outcomes, nanoseconds = (np.concatenate(parts) for parts in zip(*held, strict=True))
    calls = []
    finger.hold(contact_force, float(distances[0]))
    for distance, start in zip(distances[:CALLS], begun[:CALLS], strict=True):
        before = perf_counter_ns()
        finger.hold(contact_force, float(distance), start=start)
        calls.append((perf_counter_ns() - before) / 1e3)
    return Campaign(
        distances=distances,
        starts=begun,
        tensions=tensions,
        status=outcomes["status"],
        residual=outcomes["residual"],
        iterations=outcomes["evaluations"],
        microseconds=nanoseconds / 1e3,
        call_microseconds=np.array(calls),
        lower=finger.lower,
        upper=finger.upper,
        contact_force=contact_force,
    )

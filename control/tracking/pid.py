"""A PID controller of the tensions, with one tangent of the model, for comparison with the tracking controller."""

import numpy as np
from numpy.typing import ArrayLike

from control.motion import Limits
from control.tracking.arguments import numbers
from control.tracking.inverse import resting
from control.tracking.linearised import PLANAR
from control.tracking.options import TrackingOptions
from control.tracking.paths import FARTHEST, across, checked_path
from rom.rod.touched_segment import TouchedSegment

SMOOTHING = 5e-3  # time constant of the derivative [s]


class PidController:
    """PID of the tip's error, mapped to tensions by the tangent at the path's mean position.

    Attributes:
        tensions: current command, shape (t,) [N].
        row: of the path at the end of the current command.

    Args:
        model: of the finger before one object.
        path: y and z of the tip plate's centre, one row per period, shape (n, 2) [m].
        gains: proportional [-], integral [1/s] and derivative [s].
        options: of which period and pretension apply.
        limits: of the tensions and their rate.
        pulled: feedforward tensions, shape (n, t) [N]; by default the equilibrium tensions of the first row.
    """

    def __init__(
        self,
        model: TouchedSegment,
        path: ArrayLike,
        gains: tuple[float, float, float],
        options: TrackingOptions,
        limits: Limits | None = None,
        pulled: np.ndarray | None = None,
    ):
        self.path, self.period, t = checked_path(path), options.period, len(model.rod.names)
        self.gains = numbers("gains", gains, (3,), "-, 1/s, s")
        self._farthest = FARTHEST * float(model.rod.rest[0])
        self._change = (limits or Limits()).rate * options.period
        self._bounds = (limits or Limits()).within(*(end[:t] for end in model.limits))
        first, middle = (
            resting(model, goal, options.pretension, self._bounds) for goal in (self.path[0], self.path.mean(axis=0))
        )
        rest = np.append(middle, np.full(len(model.objects), np.inf))
        self._pulls = np.linalg.pinv(model.jacobian(rest)[1:3, :t], rcond=PLANAR)
        self.row, self.tensions, self.events = 1, first.copy(), list[tuple[int, str]]()
        every = np.broadcast_to(first, (len(self.path), t)) if pulled is None else pulled
        self._pulled = numbers("pulled", every, (len(self.path), t), "N")
        self._sum, self._rate, self._last = np.zeros(2), np.zeros(2), np.zeros(2)

    @property
    def done(self) -> bool:
        """True if the path has ended."""
        return self.row + 1 >= len(self.path)

    @property
    def periods(self) -> int:
        """Number of steps of the whole path."""
        return len(self.path) - 1

    @property
    def status(self) -> str:
        """`moving`, or `done` after the last row."""
        return "done" if self.done else "moving"

    def step(self, felt: float = np.nan, age: float = 0.0, tip: ArrayLike | None = None) -> np.ndarray:
        """Return the next tensions, shape (t,) [N], after a reading of the tip, shape (3,) [m], or None."""
        if self.done:
            return self.tensions.copy()
        self.row += 1
        error = self.path[self.row] - across(tip, self._farthest)
        if not np.isfinite(error).all():
            error = self._last
        proportional, integral, derivative = self.gains
        share = self.period / (self.period + SMOOTHING)
        self._rate = self._rate + share * ((error - self._last) / self.period - self._rate) * (self.row > 2)
        self._last, total = error, self._sum + integral * self.period * error
        wanted = self._pulled[self.row] + self._pulls @ (proportional * error + total + derivative * self._rate)
        low = np.maximum(self._bounds[0], self.tensions - self._change)
        high = np.minimum(self._bounds[1], self.tensions + self._change)
        self.tensions = np.clip(wanted, low, high)
        if np.array_equal(self.tensions, wanted) or total @ total <= self._sum @ self._sum:
            self._sum = total  # anti-windup
        return self.tensions.copy()

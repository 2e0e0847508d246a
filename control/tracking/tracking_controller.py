"""Tracking of a path by planned tensions, and feedback from tip readings through the model's tangent.

Feedback predicts the tip over the delay of its readings, as Smith's predictor does. Its states are two modes in both
directions, a slowly changing disturbance, and errors of stiffness and inertia. The estimate uses the commanded tensions
after clamping to the limits, which prevents windup.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from control.motion import Limits
from control.outcomes import beyond
from control.tracking.linearised import linearised
from control.tracking.observer import feedback
from control.tracking.options import TrackingOptions
from control.tracking.paths import across, checked_path
from control.tracking.plan import planned, resting
from rom.dataset.actuators import refuse_chambers
from rom.rod.touched_segment import TouchedSegment

FARTHEST = 2.0  # from the axis, over the finger's length, is no tip's reading usable [-]
PATIENCE = 20  # periods without a usable reading before the sensor counts as failed


class TrackingController:
    """Leads the tip plate's centre along a path in time; `step` takes a reading and returns the next tensions.

    A path behind an object's surface is that of the free tip: the object stops the tip, which then presses.

    Attributes:
        tensions: current command, reached at row `row` of the path, shape (t,) [N].
        row: of the path at the end of the current command.
        status: "moving"; "done" after the last row; "unreachable" if the plan is refused, and the tensions stay;
            "sensor_failed" after PATIENCE periods without a usable reading, while the plan continues without feedback;
            it stays so after the last row.
        reason: of a refused path, in one line.
        plan: of the path, see `control.tracking.plan`.

    Args:
        model: of the finger before one object.
        path: y and z of the tip plate's centre, one row per period, shape (n, 2) [m]; it starts at rest.
        options: of the controller.
        limits: of the tensions and their rate.

    Raises:
        ValueError: a path of another shape or of fewer than three rows, limits that leave no tensions, or several
            objects.
        ModelError: no density.

    Example:
        >>> controller = TrackingController(rom.load("round"), circle([0, 0], 0.01, 2.0, 1e-3, 3))  # doctest: +SKIP
        >>> controller.step(tip, felt, age)  # doctest: +SKIP
    """

    def __init__(
        self,
        model: TouchedSegment,
        path: ArrayLike,
        options: TrackingOptions | None = None,
        limits: Limits | None = None,
    ):
        refuse_chambers(model.rod.scene, "tracking")
        if len(model.objects) != 1:
            raise ValueError(f"model must be of a finger before one object, got {len(model.objects)}")
        self.options, self.limits = options or TrackingOptions(), limits or Limits()
        self.model, rows, t = model, checked_path(path), len(model.rod.names)
        nearest, farthest = (end[-1] for end in model.limits)
        own = self.options
        if own.distance != np.inf and (reason := beyond("distance", own.distance, nearest, farthest, "m")):
            raise ValueError(reason)
        self._bounds = self.limits.within(*(end[:t] for end in model.limits))
        middle = resting(model, rows.mean(axis=0), own.pretension, self._bounds)
        system = linearised(model, middle, own.density, own.period)
        self.plan = planned(model, rows, system, own, self.limits)
        self._system, self._filter = system, [tuple(row) for row in system.filter.tolist()]
        self._past = np.zeros(2), np.zeros(2)
        self._feedback = feedback(system, self.plan.shares, own.noise, own.drift * np.sqrt(own.period), own.effort)
        normal = model.direction[1:]
        self._along = np.eye(2) - np.outer(normal, normal) / max(float(normal @ normal), 1e-12)
        self.reason, self.status = self.plan.reason, "unreachable" if self.plan.reason else "moving"
        self.row, self.tensions = 1, self.plan.tensions[0 if self.reason else 1].copy()
        self._inputs, self._at, self._blind = np.zeros((len(rows), 2)), 1, 0
        self._state, self._unknown, self._ended = np.zeros(len(system.a)), np.zeros(4), False

    @property
    def inertia(self) -> np.ndarray:
        """M_eff / K_eff, see `control.tracking.linearised`, shape (2, 2) [s^2]."""
        return self._system.inertia

    @property
    def period(self) -> float:
        """Time between steps [s]."""
        return self.options.period

    @property
    def done(self) -> bool:
        """Whether the path has ended or is refused."""
        return self._ended or self.status == "unreachable"

    def step(self, tip: ArrayLike, felt: float = 0.0, age: float = 0.0) -> np.ndarray:
        """Return the next tensions, shape (t,) [N].

        Args:
            tip: reading of the tip plate's centre in the clamp's frame, shape (3,) [m]; nan without one.
            felt: contact force at the same time [N].
            age: of the readings [s].
        """
        if self.done:
            return self.tensions.copy()
        self._observe(across(tip), felt, age)
        if self.row + 1 == len(self._inputs):
            self._ended, self.status = True, "done" if self.status == "moving" else self.status
            return self.tensions.copy()
        state = self._predicted()
        self.row += 1
        wanted = -self._feedback.gain @ state - self._feedback.effects[self.row] @ self._unknown
        size = float(np.hypot(*wanted))
        if size > self.options.correction:
            wanted *= self.options.correction / size
        planned_tensions = self.plan.tensions[self.row]
        change = self.limits.rate * self.options.period
        low, high = (
            np.maximum(self._bounds[0], self.tensions - change),
            np.minimum(self._bounds[1], self.tensions + change),
        )
        self.tensions = np.clip(planned_tensions + self.plan.gains[self.row] @ wanted, low, high)
        self._inputs[self.row] = self.plan.motions[self.row] @ (self.tensions - planned_tensions)
        return self.tensions.copy()

    def _observe(self, tip: np.ndarray, felt: float, age: float) -> None:
        """Correct the estimate by a reading of an earlier row."""
        row = self.row - round(age / self.options.period) if np.isfinite(age) else -1
        usable = bool(self._at <= row <= self.row and np.abs(tip).max() < FARTHEST * self.model.rod.rest[0])
        self._blind = 0 if usable else self._blind + 1
        self.status = "moving" if self._blind < PATIENCE else "sensor_failed"
        for k in range(self._at, row if usable else self.row - PATIENCE):
            self._state, self._at = self._ahead(self._state, k), k + 1
        if not usable:
            return
        touches = self.plan.contact_forces[row] > 0 or not felt <= self.options.feel
        seen = self._along if touches else np.eye(2)
        error = self._filtered(seen @ (tip - self.plan.tips[row]))
        error -= self._system.c @ self._state + self._system.d @ self._acting(row)
        change = self._feedback.observer[row] @ (seen @ error)
        self._state, self._unknown = self._state + change[:-4], self._unknown + change[-4:]
        self._state, self._at = self._ahead(self._state, row), row + 1

    def _filtered(self, value: np.ndarray) -> np.ndarray:
        """The low-pass filter's output (direct form II, transposed)."""
        (b0, b1, b2), (_, a1, a2) = self._filter
        found = b0 * value + self._past[0]
        self._past = b1 * value - a1 * found + self._past[1], b2 * value - a2 * found
        return np.asarray(found)

    def _predicted(self) -> np.ndarray:
        """The state at the next row."""
        state = self._state
        for k in range(self._at, self.row + 1):
            state = self._ahead(state, k)
        return state

    def _ahead(self, state: np.ndarray, row: int) -> np.ndarray:
        return np.asarray(self._system.a @ state + self._system.b @ self._acting(row))

    def _acting(self, row: int) -> np.ndarray:
        """Corrections and disturbances beside the plan, as a displacement of the tip at rest, shape (2,) [m]."""
        return np.asarray(self._inputs[row] + self._feedback.effects[row] @ self._unknown)

"""Tracking of a path by planned tensions, and feedback from readings of tip and force through the model's tangent.

Feedback predicts the tip over the delay of its readings, as Smith's predictor does. Its states are two modes in both
directions, a slowly changing disturbance, and errors of stiffness and inertia. The estimate uses the commanded tensions
after clamping to the limits, which prevents windup. While the plan presses, the tip is fed back along the surface, and
the contact force across it: the model's stiffness of contact turns an error of the force into a displacement.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from control.motion import Limits
from control.outcomes import beyond
from control.tracking.guides import compensated
from control.tracking.inverse import resting
from control.tracking.linearised import Linearised, linearised
from control.tracking.observer import feedback
from control.tracking.options import TrackingOptions
from control.tracking.paths import FARTHEST, across, checked_path
from control.tracking.plan import Plan, passing, planned, refused
from control.tracking.refinement import refined
from rom.dataset.actuators import refuse_chambers
from rom.rod.touched_segment import TouchedSegment

APPROACHES, SLOWER = 5, 1.5  # number of approaches that are tried, and ratio of their times [-]
SOFT = 1.0  # smallest stiffness of contact that feedback of the force uses [N/m]
PATIENCE = 20  # periods without a usable reading before the sensor counts as failed


class TrackingController:
    """Leads the tip plate's centre along a path in time; `step` takes readings and returns the next tensions.

    A path behind an object's surface is led along the surface, with a contact force of at most `most_force`. It rises
    with the path's depth: without `most_force`, to that of the free tip on the path. `control.run` runs it on a plant.

    Attributes:
        tensions: current command, reached at row `row` of the path, shape (t,) [N].
        row: of the path at the end of the current command.
        status: "moving"; "done" after the last row; "unreachable" if the plan is refused, and the tensions stay;
            "sensor_failed" after PATIENCE periods without a usable reading, while the plan continues without feedback;
            it stays so after the last row.
        reason: of a refused path, in one line.
        plan: of the path, see `control.tracking.plan`; `plan.deviation` is the largest distance of its simulated tip
            from the path, or from the surface in front of it [m].
        events: "blind" and "sees again", by row. Initially, "passes in front" for every row at which the path goes
            behind the object's surface and the planned tip does not touch it: an impact would exceed `most_force`.

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
        >>> report = control.run([controller], [plant], controller.periods)  # doctest: +SKIP
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
        room = own.margin if own.most_force < np.inf else 0.0
        ends = nearest + room, farthest - room
        if own.distance != np.inf and (reason := beyond("distance", own.distance, *ends, "m")):
            raise ValueError(f"{reason}, with options.margin of {room:g} m")
        self._bounds = self.limits.within(*(end[:t] for end in model.limits))
        middle = resting(model, rows.mean(axis=0), own.pretension, self._bounds)
        system = linearised(model, middle, own.density, own.period)
        self.plan = self._planned(rows, system)
        self._system, self._filter = system, [tuple(row) for row in system.filter.tolist()]
        self._past = np.zeros(2), np.zeros(2)
        self._feedback = feedback(system, self.plan.shares, own.noise, own.drift * np.sqrt(own.period), own.effort)
        normal = model.direction[1:]
        self._normal = normal / max(float(np.linalg.norm(normal)), 1e-12)
        self._stiffness = max(float((self.plan.stiffness @ self._normal).max()), SOFT)
        self._along = np.eye(2) - np.outer(self._normal, self._normal)
        self.reason, self.status = self.plan.reason, "unreachable" if self.plan.reason else "moving"
        self.row, self.tensions = 1, self.plan.tensions[0 if self.reason else 1].copy()
        self._inputs, self._at, self._blind = np.zeros((len(rows), 2)), 1, 0
        self._state, self._unknown, self._ended = np.zeros(len(system.a)), np.zeros(4), False
        self._pressing = 0.0
        self.events = [] if self.reason else [(row, "passes in front") for row in passing(self.plan, rows)]

    def _planned(self, path: np.ndarray, system: Linearised) -> Plan:
        """The plan with the fastest approach whose simulated contact forces are allowed, or the reason of the last."""
        options = self.options
        for _ in range(APPROACHES):
            plan = planned(self.model, path, system, options, self.limits)
            if not plan.reason:
                plan = refined(plan, self.model, system, options, self._bounds)
            if not plan.most_force > options.most_force:
                break
            options = replace(options, approach=SLOWER * options.approach)
        if options.friction > 0 and not plan.reason:
            plan = compensated(plan, self.model, options.friction, self._bounds)
        return plan._replace(reason=plan.reason or refused(plan, options, self.limits))

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
        """True if the path has ended or is refused."""
        return self._ended or self.status == "unreachable"

    @property
    def periods(self) -> int:
        """Number of steps of the whole path."""
        return len(self._inputs) - 1

    def step(self, felt: float = np.nan, age: float = 0.0, tip: ArrayLike | None = None) -> np.ndarray:
        """Return the next tensions, shape (t,) [N].

        Args:
            felt: contact force [N]; nan without a reading.
            age: of the readings [s].
            tip: reading of the tip plate's centre in the clamp's frame, shape (3,) [m]; None or nan without one.
        """
        if self.done:
            return self.tensions.copy()
        row = self.row - round(age / self.options.period) if np.isfinite(age) else -1
        self._press(row, felt)
        self._observe(row, across(tip, FARTHEST * self.model.rod.rest[0]), felt)
        if self.row + 1 == len(self._inputs):
            self._ended, self.status = True, "done" if self.status == "moving" else self.status
            return self.tensions.copy()
        state = self._predicted()
        self.row += 1
        seen = self._seen(self.row, felt)
        wanted = -seen @ (self._feedback.gain @ state) - self._feedback.effects[self.row] @ self._unknown
        size = float(np.hypot(*wanted))
        if size > self.options.correction:
            wanted *= self.options.correction / size
        planned_tensions, pressing = self.plan.tensions[self.row], self._pressing * self._normal
        change = self.limits.rate * self.options.period
        low, high = (
            np.maximum(self._bounds[0], self.tensions - change),
            np.minimum(self._bounds[1], self.tensions + change),
        )
        self.tensions = np.clip(planned_tensions + self.plan.gains[self.row] @ (wanted + pressing), low, high)
        self._inputs[self.row] = self.plan.motions[self.row] @ (self.tensions - planned_tensions) - pressing
        return self.tensions.copy()

    def _seen(self, row: int, felt: float) -> np.ndarray:
        """Projection on the directions in which the tip moves freely, shape (2, 2) [-]."""
        return self._along if self.plan.contact_forces[row] > 0 or felt > self.options.feel else np.eye(2)

    def _press(self, row: int, felt: float) -> None:
        """Integrate the error of the contact force, where the plan presses, as a displacement of the free tip [m]."""
        share = self.options.period / (self.options.period + self.options.settling)
        if not self.plan.contact_forces[self.row] > 0:
            self._pressing -= share * self._pressing
        elif 0 <= row <= self.row and np.isfinite(felt) and self.plan.contact_forces[row] > 0:
            most = self.options.correction
            wanted = self._pressing + share * (self.plan.contact_forces[row] - felt) / self._stiffness
            self._pressing = min(max(wanted, -most), most)

    def _observe(self, row: int, tip: np.ndarray, felt: float) -> None:
        """Correct the estimate by a reading of an earlier row."""
        usable = bool(self._at <= row <= self.row and np.isfinite(tip).all())
        if usable and self._blind >= PATIENCE:
            self.events.append((self.row, "sees again"))
        self._blind = 0 if usable else self._blind + 1
        if self._blind == PATIENCE:
            self.events.append((self.row, "blind"))
        self.status = "moving" if self._blind < PATIENCE else "sensor_failed"
        for k in range(self._at, row if usable else self.row - PATIENCE):
            self._state, self._at = self._ahead(self._state, k), k + 1
        if not usable:
            return
        seen = self._seen(row, felt)
        error = self._filtered(seen @ (tip - self.plan.goals[row]))
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

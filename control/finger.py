"""Control one finger: reach a point, find the plane from a measured force, hold a contact force, follow a path."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from control import problems
from control.least_squares import CONVERGED, STATIONARY
from control.model import Model
from control.motion import Limits, Motion
from control.outcomes import answered, beyond, listed, no_point, not_finite, not_positive, refused
from control.problems import compiled_finger, rules
from control.sides import Sides
from rom.answer import FORCE, PAD
from rom.dataset.actuators import pressures_of
from rom.dataset.geometry import tip_at_rest

NORMAL_95 = 1.96  # standard deviations within which 95 % of a normal distribution are [-]


class Finger:
    """Controls one finger through its model.

    Args:
        model: a finger that an object may touch (`rom.TouchedSegment`), or a `rom.SeparatedModel`.
        limits: bounds of the tensions [N], then of the pressures [Pa], and of the tensions' rate.

    Raises:
        ValueError: the limits exclude all trained loads, or have a rate for a finger with chambers.
    """

    def __init__(self, model: Model, limits: Limits | None = None):
        self.model, self.limits = model, limits or Limits()
        lower, upper = model.limits
        self._tensions = len(lower) - model.has_obstacle
        self.lower, self.upper = self.limits.within(lower[: self._tensions], upper[: self._tensions])
        self.pressures = pressures_of(model.scene)
        if self.pressures and np.isfinite(self.limits.rate):
            raise ValueError(
                f"limits.rate must be left out of a finger with chambers, as it is of tensions, got {self.limits.rate}"
            )
        self.compiled = compiled_finger(model, self.lower, self.upper)
        self._pad = compiled_finger(model, self.lower, self.upper, PAD) if model.has_pad else None
        if np.isfinite(self.limits.pad_pressure):
            self._needs_pad()
        self._gentle = self.lower.copy()
        self._gentle[model.lead] = (self.lower[model.lead] + self.upper[model.lead]) / 2
        self.rest = tip_at_rest(model.scene["geometry"])
        self._sides = Sides(model.scene)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the arguments; the data for compiled code are made anew."""
        return type(self), (self.model, self.limits)

    def reach(
        self,
        point: ArrayLike,
        distance: float = np.inf,
        start: ArrayLike | None = None,
        tolerance: float = 1e-4,
    ) -> Motion:
        """Bring the tip plate's centre to a point without touching the plane.

        For points on the side without tendons, the tensions apply to imagined mirror-image tendons there, unless the
        plane breaks the symmetry. The motion's `sides` are those on which tendons are pulled.

        Args:
            point: position, shape (3,) [m], in the finger's axes (clamp at the origin, finger along x).
            distance: of the plane [m]; the finger stays this side of it.
            start: tensions to start from [N]; among several solutions, the one nearest to them is taken.
            tolerance: largest distance of the tip from the point [m].

        Raises:
            ValueError: start has the wrong shape, or the distance is finite although the model has no obstacle.
        """
        begin = (self.lower + self.upper) / 2 if start is None else self._start(start)
        goal = np.asarray(point, float)
        if reason := self._refused(goal, distance) or not_finite("start", begin, self._units):
            return self._out_of_domain(distance, reason)
        wanted = self._sides.wanted(goal - self.rest, distance)
        return self._reach(goal - self.rest, distance, begin, tolerance, wanted)

    def follow(
        self,
        points: Iterable[ArrayLike],
        period: float,
        distance: float = np.inf,
        start: ArrayLike | None = None,
        tolerance: float = 1e-4,
    ) -> list[Motion]:
        """Lead the tip plate's centre along points, one per period; each motion starts from the previous one.

        No tension changes by more than rate times period from one motion to the next. If a point is too far for that,
        the status is `unreachable`, and the next motion starts where this one ends. If a point is not finite, the
        status is `out_of_domain`, and the tensions do not change.

        Args:
            points: positions, shapes (3,) [m].
            period: from point to point [s].
            distance: see reach.
            tolerance: see reach.
            start: tensions before the first point [N], of the scene's own tendons; the lowest allowed ones by default.

        Raises:
            ValueError: start has the wrong shape or is not finite, period is not above 0, or the distance is finite
                although the model has no obstacle.
        """
        if not period > 0:
            raise ValueError(f"period must be above 0 s, got {period}")
        present = self.lower.copy() if start is None else np.clip(self._start(start), self.lower, self.upper)
        if not np.isfinite(present).all():
            raise ValueError(f"start must be finite tensions in N, got {present.tolist()}")
        sides, motions = (1, 1), []
        change = self.limits.rate * period
        for point in points:
            goal = np.asarray(point, float)
            reason = self._refused(goal, distance)
            if reason:
                motions.append(self._out_of_domain(distance, reason, present, sides))
                continue
            goal = goal - self.rest
            sides = self._sides.changed(present, sides, self._sides.wanted(goal, distance))
            motions.append(self._reach(goal, distance, present, tolerance, sides, change))
            present = motions[-1].tensions
        return motions

    @property
    def _units(self) -> str:
        """Units of the tensions, for a sentence."""
        return "N, Pa" if self.pressures else "N"

    def _refused(self, point: np.ndarray, distance: float) -> str:
        """The reason why a point in front of a plane is refused; empty if it is accepted."""
        if np.isfinite(distance):
            self._needs_obstacle()
        return no_point(point) or ("" if distance == np.inf else self._beyond(distance))

    def _beyond(self, distance: float) -> str:
        """The reason why a distance is refused; empty if the model's plane may be there."""
        lower, upper = (end[-1] for end in self.model.limits) if self.model.has_obstacle else (np.inf, np.inf)
        return beyond("distance", distance, lower, upper, "m")

    def _reach(
        self,
        goal: np.ndarray,
        distance: float,
        start: np.ndarray,
        tolerance: float,
        sides: tuple[int, int],
        change: float = np.inf,
    ) -> Motion:
        mirrored = goal * np.array([1.0, *sides])
        tensions, solution = problems.reach(self.compiled, start, change, mirrored, float(distance), rules(tolerance))
        point = np.append(tensions, distance) if self.model.has_obstacle else tensions
        error = float(self.model.evaluate(point).error["tip"])
        asked = f"point {listed(goal + self.rest)} m"
        details = {"distance": distance, "error": error, "sides": sides, "unit": "m"}
        return self._motion(solution.status, tensions, solution, asked, **details)

    def locate(self, tensions: ArrayLike, contact_force: ArrayLike, noise: float = 0.0, hint: float = np.nan) -> Motion:
        """Find the plane from tensions and the measured contact force; the motion's `distance` is its distance d*.

        Its `deviation` is the standard deviation of d*. It is due to the sensor's noise, which averages out over
        readings, and to the model's error, which does not.

        Args:
            tensions: [N], shape (tensions,), or those of m readings, shape (m, tensions).
            contact_force: the measured one [N], above 0, or those of m readings, shape (m,).
            noise: standard deviation of the force sensor [N].
            hint: a likely distance of the plane [m].

        Raises:
            ValueError: the model has no obstacle.
        """
        self._needs_obstacle()
        pulled, felt = np.array(tensions, float, ndmin=2, order="C"), np.array(contact_force, float, ndmin=1)
        if pulled.ndim != 2 or pulled.shape != (len(felt), self._tensions) or not len(felt):
            wanted = f"tensions must be {self._tensions} for each of {len(felt)} contact forces"
            return self._out_of_domain(np.nan, f"{wanted}, got shape {np.shape(tensions)}")
        lower, upper = self.model.limits
        reason = beyond("tensions", pulled, lower[:-1], upper[:-1], self._units) or not_positive(
            "contact_force", felt, "N"
        )
        reason = reason or beyond("noise", noise, 0.0, np.finfo(float).max, "N")
        if reason:
            return self._out_of_domain(np.nan, reason, pulled[-1])
        close = rules(1e-9 * max(float(felt.max()), 1.0))
        solution = problems.locate(self.compiled, pulled, felt, float(hint), close)
        status, steep, error_95 = solution.status, solution.squared_slopes, solution.weighted_error
        error = error_95 / np.sqrt(steep * len(felt)) if steep > 0 else np.inf
        if len(felt) > 1 and steep > 0 and status != CONVERGED and solution.residual <= 3 * noise + error:
            status = CONVERGED
        deviation = float(np.hypot(noise / np.sqrt(steep), error_95 / NORMAL_95 / steep)) if steep > 0 else np.inf
        asked = f"contact_force {listed(felt if len(felt) > 1 else felt[0])} N at tensions {listed(pulled[-1])} "
        asked += self._units
        details = {"distance": solution.distance, "error": error, "deviation": deviation}
        return self._motion(status, pulled[-1], solution, asked, **details)

    def hold(
        self,
        contact_force: float | None = None,
        distance: float = np.nan,
        start: ArrayLike | None = None,
        tolerance: float = 1e-6,
        pad_pressure: float | None = None,
    ) -> Motion:
        """Press on the plane with a contact force or pad pressure, with tensions close to the present ones.

        If the pressure on the pad would exceed its limit, the status is `unreachable` and the largest allowed one is
        held.

        Args:
            contact_force: [N], above 0.
            distance: of the plane [m].
            start: present tensions [N]; among several solutions, the one nearest to them is taken.
            tolerance: largest deviation of the force [N]; of a pressure, the deviation that such a force would cause.
            pad_pressure: to hold instead of a contact force [Pa], above 0; residual and error are then in [Pa].

        Raises:
            ValueError: the model has no obstacle, or no pad pressure although it is needed; both targets or neither are
                present; or start has the wrong shape.
        """
        self._needs_obstacle()
        if (contact_force is None) == (pad_pressure is None):
            raise ValueError(f"hold must have contact_force or pad_pressure, got {contact_force} and {pad_pressure}")
        begin = self._gentle if start is None else self._start(start)
        name, target, unit = ("contact_force", contact_force, "N")
        if pad_pressure is not None:
            name, target, unit = "pad_pressure", pad_pressure, "Pa"
        assert target is not None
        reason = self._beyond(distance) or not_positive(name, target, unit) or not_finite("start", begin, self._units)
        if reason:
            return self._out_of_domain(distance, reason)
        most = self.limits.pad_pressure
        if pad_pressure is not None:
            return self._press(self._needs_pad(), min(target, most), target, distance, begin, tolerance)
        motion = self._press(self.compiled, target, target, distance, begin, tolerance)
        if not np.isfinite(most) or self._pressed(motion)[1] <= most:
            return motion
        allowed = self._press(self._needs_pad(), most, most, distance, begin, tolerance)
        force, _ = self._pressed(allowed)
        most_pressure = f"the pad then presses with limits.pad_pressure, {most:g} Pa, and the force misses it by"
        return replace(
            allowed,
            status="unreachable" if allowed.converged else allowed.status,
            residual=abs(force - target),
            reason=allowed.reason or f"contact_force {target:g} N is not reached: {most_pressure} {target - force:g} N",
            error=float(self.model.evaluate([*allowed.tensions, distance]).error["contact_force"]),
        )

    def _press(
        self, model: Any, aim: float, target: float, distance: float, start: np.ndarray, tolerance: float
    ) -> Motion:
        """Hold a force or a pad pressure at `aim`: the target, or the largest allowed value if that is smaller."""
        tensions, solution = problems.hold(model, start, float(aim) / model.unit, float(distance), rules(tolerance))
        status = solution.status
        solution.residual *= model.unit
        if aim < target:
            status = STATIONARY if status == CONVERGED else status
            solution.residual += target - aim
        name, unit = ("contact_force", "N") if model.row == FORCE else ("pad_pressure", "Pa")
        asked = f"{name} {target:g} {unit} at distance {distance:g} m"
        return self._motion(status, tensions, solution, asked, distance=distance, error=solution.error, unit=unit)

    def _pressed(self, motion: Motion) -> tuple[float, float]:
        """Contact force [N] and pad pressure [Pa] of a motion."""
        answer = self.model.evaluate([*motion.tensions, motion.distance])
        return float(answer.contact_force), float(answer.pad_pressure)

    def _needs_obstacle(self) -> None:
        if not self.model.has_obstacle:
            raise ValueError("model must have an obstacle to feel, hold or find it, got a scene without one")

    def _needs_pad(self) -> Any:
        if self._pad is None:
            raise ValueError("model must have its pad's pressure, got samples without it (see sampling.store)")
        return self._pad

    def _start(self, start: ArrayLike) -> np.ndarray:
        tensions = np.array(start, float)  # a copy, contiguous
        if tensions.shape != (self._tensions,):
            of = f"{self._tensions} tensions in N"
            if self.pressures:
                of += f", the last {self.pressures} of them pressures in Pa"
            raise ValueError(f"start must be {of}, got shape {tensions.shape}")
        return tensions

    def _motion(self, status: int, tensions: np.ndarray, found: Any, asked: str, **details: Any) -> Motion:
        """The motion of a solver's outcome; if it is not met, the reason quotes what was `asked` for."""
        return answered(status, tensions, found, asked, (self.lower, self.upper), pressures=self.pressures, **details)

    def _out_of_domain(
        self, distance: float, reason: str, tensions: np.ndarray | None = None, sides: tuple[int, int] = (1, 1)
    ) -> Motion:
        return refused(self.lower.copy() if tensions is None else tensions, distance, reason, sides, self.pressures)

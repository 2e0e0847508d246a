"""One finger: reach a point before contact, find the plane from a felt force, hold a contact force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from control.least_squares import Options, Residual, Solution, minimise
from rom import Surrogate
from rom.kernel import answer

TIP, FORCE, TOUCH = slice(0, 3), 3, 4  # rows of the model's outputs


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What a controller asks of a finger.

    Attributes:
        tensions: [N], shape (tensions,); if the target cannot be met, those that come nearest.
        distance: of the plane [m], inf where there is none.
        status: converged, unreachable (the nearest reachable answer), out_of_domain or iteration_limit.
        residual: distance from the target, [m] for reach, [N] for locate and hold.
        error: what 95 % of held-out states kept of the model's error, in the residual's unit; nan if not measured.
        iterations: evaluations of the model.
    """

    tensions: np.ndarray
    distance: float
    status: str
    residual: float
    error: float
    iterations: int

    @property
    def converged(self) -> bool:
        """Whether the target is met."""
        return self.status == "converged"

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {
            "tensions": self.tensions.tolist(),
            "distance": self.distance,
            "status": self.status,
            "residual": self.residual,
            "error": self.error,
            "iterations": self.iterations,
        }


class Finger:
    """Controls one finger through its surrogate.

    Args:
        model: the surrogate.
    """

    def __init__(self, model: Surrogate):
        self.model = model
        self._kernel = model.kernel
        lower, upper = model.limits
        self._tensions = len(lower) - model.has_obstacle
        self._bounds = lower[: self._tensions], upper[: self._tensions]
        self._middle = (self._bounds[0] + self._bounds[1]) / 2
        self._gentle = self._bounds[0].copy()
        self._gentle[model.lead] = self._middle[model.lead]
        plate, length = model.scene["geometry"]["plate"], sum(model.scene["geometry"]["segments"])
        self.rest = np.array([length - plate / 2, 0.0, 0.0])  # the tip plate's centre at rest [m]

    def reach(
        self,
        point: ArrayLike,
        distance: float = np.inf,
        start: ArrayLike | None = None,
        tolerance: float = 1e-4,
    ) -> Motion:
        """Bring the tip plate's centre to a point without touching the plane.

        Args:
            point: position, shape (3,) [m], in the finger's axes (clamp at the origin, finger along x).
            distance: of the plane [m]; the finger stays this side of it.
            start: tensions to start from [N].
            tolerance: bounds the tip's distance from the point [m].

        Raises:
            ValueError: a start of the wrong shape, or a distance where the model has no obstacle.
        """
        if np.isfinite(distance):
            self._needs_obstacle()
        goal = np.asarray(point, float)
        if goal.shape != (3,) or not np.all(np.abs(goal) < 1e6) or np.isnan(distance):
            return self._out_of_domain(distance)
        target = goal - self.rest
        starts = [self._middle if start is None else np.asarray(start, float), self._gentle]
        plane, weight = distance, 10.0  # of passing the plane against missing the point

        def residual(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            out, jacobian = self._free(tensions)
            passed = out[TOUCH] - plane
            r, dr = out[TIP] - target, jacobian[TIP, : self._tensions]
            if not passed > 0:
                return r, dr
            return np.append(r, weight * passed), np.vstack([dr, weight * jacobian[TOUCH, : self._tensions]])

        for _ in range(5):
            best = self._best(residual, starts, tolerance)
            passed = self._free(best.x)[0][TOUCH] - distance
            if not passed > 0:
                break
            plane, starts = plane - 1.5 * passed, [best.x]  # the penalty gives a little: ask for that much more
        if passed > 0:  # nan, without an obstacle, is not above 0
            best = replace(best, status="stationary")
        miss = float(np.linalg.norm(self._free(best.x)[0][TIP] - target))
        return self._motion(best, best.x, distance, "tip", miss)

    def locate(self, tensions: ArrayLike, contact_force: float) -> Motion:
        """Find the plane from the tensions and the contact force felt; the motion's `distance` is d*.

        Args:
            tensions: [N], shape (tensions,).
            contact_force: felt [N], above 0.

        Raises:
            ValueError: a model without an obstacle.
        """
        self._needs_obstacle()
        pulled = np.asarray(tensions, float)
        lower, upper = self.model.limits
        inside = pulled.shape == (self._tensions,) and np.all((pulled >= lower[:-1]) & (pulled <= upper[:-1]))
        if not (inside and np.isfinite(contact_force) and contact_force > 0):
            return self._out_of_domain(np.nan, pulled)
        touch = self._free(pulled)[0][TOUCH]

        def residual(distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            force, slope = self._signed_force(np.append(pulled, distance), contact_force)
            return np.array([force - contact_force]), slope[-1:].reshape(1, 1)

        bounds = lower[-1:], np.clip([touch], lower[-1], upper[-1])
        options = Options(residual=1e-9 * max(contact_force, 1.0))
        starts = [bounds[0] + way * (bounds[1] - bounds[0]) for way in (0.9, 0.5, 0.1)]
        best = min(
            (minimise(residual, start, bounds, options) for start in starts), key=lambda solution: solution.residual
        )
        distance = float(best.x[0])
        return self._motion(best, pulled, distance, "contact_force", self._off(pulled, distance, contact_force))

    def hold(
        self, contact_force: float, distance: float, start: ArrayLike | None = None, tolerance: float = 1e-6
    ) -> Motion:
        """Press on the plane with a contact force, changing the tensions as little as needed.

        Args:
            contact_force: [N], above 0.
            distance: of the plane [m].
            start: tensions to start from [N].
            tolerance: bounds the force's deviation [N].

        Raises:
            ValueError: a model without an obstacle, or a start of the wrong shape.
        """
        self._needs_obstacle()
        lower, upper = self.model.limits
        if not (lower[-1] <= distance <= upper[-1] and np.isfinite(contact_force) and contact_force > 0):
            return self._out_of_domain(distance)

        def residual(tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            force, slope = self._signed_force(np.append(tensions, distance), contact_force)
            return np.array([force - contact_force]), slope[: self._tensions].reshape(1, -1)

        begin = self._gentle if start is None else np.asarray(start, float)
        best = self._best(residual, [begin, self._gentle], tolerance)
        return self._motion(best, best.x, distance, "contact_force", self._off(best.x, distance, contact_force))

    # -- shared ------------------------------------------------------------------------------------------------------

    def _needs_obstacle(self) -> None:
        if not self.model.has_obstacle:
            raise ValueError("model must have an obstacle to feel, hold or find it, got a scene without one")

    def _free(self, tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outputs and derivatives with the plane away."""
        point = np.append(tensions, np.inf) if self.model.has_obstacle else tensions
        out, jacobian, _ = answer(self._kernel, point)
        return out, jacobian

    def _signed_force(self, point: np.ndarray, scale: float) -> tuple[float, np.ndarray]:
        """Contact force [N] and its derivatives, shape (p,); before touch minus a stiffness times the gap.

        Before touch the force is zero whatever the tensions, and a solver could not tell where to go. The gap can.
        """
        out, jacobian, _ = answer(self._kernel, point)
        gap = point[-1] - out[TOUCH]
        if gap < 0:
            return out[FORCE], jacobian[FORCE]
        stiffness = scale / 1e-3  # [N/m]: a millimetre of gap counts like the whole force
        slope = stiffness * jacobian[TOUCH]
        slope[-1] = -stiffness
        return -stiffness * gap, slope

    def _best(self, residual: Residual, starts: Sequence[np.ndarray], tolerance: float) -> Solution:
        """The first start that converges, else the least residual of all, from the box's corners too."""
        solutions: list[Solution] = []
        corners = [np.array(corner) for corner in product(*zip(*self._bounds, strict=True))]
        for start in [*starts, *corners]:
            if start.shape != (self._tensions,):
                raise ValueError(f"start must be {self._tensions} tensions in N, got {start.shape}")
            solutions.append(minimise(residual, start, self._bounds, Options(residual=tolerance)))
            if solutions[-1].status == "converged":
                return solutions[-1]
        return min(solutions, key=lambda solution: solution.residual)

    def _off(self, tensions: np.ndarray, distance: float, contact_force: float) -> float:
        """How far the model's contact force is from a target [N]."""
        return abs(float(answer(self._kernel, np.append(tensions, distance))[0][FORCE]) - contact_force)

    def _motion(
        self, solution: Solution, tensions: np.ndarray, distance: float, quantity: str, residual: float
    ) -> Motion:
        point = np.append(tensions, distance) if self.model.has_obstacle else tensions
        said = self.model.evaluate(point)
        status = {"stationary": "unreachable"}.get(solution.status, solution.status)
        if not said.inside:
            status = "out_of_domain"
        return Motion(
            tensions=np.array(tensions),
            distance=float(distance),
            status=status,
            residual=residual,
            error=float(said.error[quantity]),
            iterations=solution.iterations,
        )

    def _out_of_domain(self, distance: float, tensions: np.ndarray | None = None) -> Motion:
        return Motion(
            tensions=self._bounds[0].copy() if tensions is None else tensions,
            distance=float(distance),
            status="out_of_domain",
            residual=np.inf,
            error=np.nan,
            iterations=0,
        )

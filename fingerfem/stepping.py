"""Continuation to a load: predictor, adaptive steps, two Newton strategies, bisection; an answer or an exception."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.convergence import LoadNotReached, NotConverged
from fingerfem.newton import Newton

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


@dataclass(frozen=True, kw_only=True)
class StepOptions:
    """How far one step goes.

    Attributes:
        turn: most a step's tensions may turn the tip of a slender finger, F e L / EI [rad].
        approach: most the plane may move in a step, over the finger's length [-].
        touch: most it may move in the first step after touch, over the finger's side [-].
        halvings: how often a failing step is halved before the path is given up.
    """

    turn: float = 0.7
    approach: float = 0.08
    touch: float = 0.04
    halvings: int = 10


class Stepper:
    """Leads a model from one equilibrium to the next.

    `iterations`, `steps` and `strategies` count since the last rest.
    """

    def __init__(self, model: FingerModel, options: StepOptions | None = None):
        self.model, self.options, self.newton = model, options or StepOptions(), Newton(model)
        geometry, scene = model.scene.geometry, model.scene
        bending = model.rubber.young_modulus * geometry.side**4 / 12  # [N m^2]
        ends = np.cumsum(geometry.segments)
        self._turn = np.array(
            [float(np.linalg.norm(tendon.offset)) * ends[tendon.segment - 1] / bending for tendon in scene.tendons]
        )  # [rad/N]
        # A tendon on the axis bends nothing but shortens: count its strain for a turn.
        self._turn += 1 / (model.rubber.young_modulus * geometry.side**2)
        self.rest()

    def rest(self) -> None:
        """Back to the undeformed finger without loads."""
        self.start(np.zeros(len(self.model.scene.tendons)), None, np.zeros_like(self.model.displacement))

    def start(self, tensions: ArrayLike, distance: float | None, displacement: np.ndarray) -> None:
        """Take an equilibrium that is known already: tensions [N], d [m], displacement [m], shape (3 nodes,)."""
        self.tensions, self.distance = np.array(tensions, float), distance
        self.model.displacement[:] = displacement
        self.model.set_loads(self.tensions, distance)
        self.iterations, self.steps = 0, 0
        self.strategies: Counter[str] = Counter()
        self._factorised = False

    def advance(self, tensions: ArrayLike, distance: float | None) -> None:
        """Go in a straight line from the present load to tensions [N], shape (tendons,), and distance [m].

        A plane that was away comes from where it touches.

        Raises:
            LoadNotReached: the model is then left at the last good load.
        """
        target = np.array(tensions, float)
        if self.distance is not None and distance is None:
            raise ValueError("distance must be a number while a plane is there, got None")
        if self.distance is None and distance is not None:
            # The predictor keeps the nodes that touch on the plane; a first short step finds out which they are.
            self.distance = max(self.model.reach(), distance)
            first = self.distance - self.options.touch * self.model.scene.geometry.side
            if first > distance:
                self.advance(self.tensions, first)
        origin, origin_distance = self.tensions.copy(), self.distance

        fraction, size, halvings, reason = 0.0, self._first_size(target, distance), 0, ""
        while fraction < 1.0:
            size = min(size, 1.0 - fraction)
            nearly = fraction + size > 1 - 1e-12
            ahead = 1.0 if nearly else fraction + size
            goal = target if nearly else origin + ahead * (target - origin)
            goal_distance = distance
            if distance is not None and origin_distance is not None and not nearly:
                goal_distance = origin_distance + ahead * (distance - origin_distance)
            try:
                needed = self._step(goal, goal_distance)
            except NotConverged as failure:
                reason, halvings, size = failure.reason, halvings + 1, size / 2
                if halvings > self.options.halvings:
                    raise LoadNotReached(reason, self.tensions.copy(), self.distance) from None
                continue
            fraction, halvings = ahead, max(halvings - 1, 0)
            size *= 1.5 if needed <= 5 else 0.7 if needed > 8 else 1.0

    def _first_size(self, target: np.ndarray, distance: float | None) -> float:
        turn = float(np.abs(target - self.tensions) @ self._turn) / self.options.turn
        approach = 0.0
        if distance is not None and self.distance is not None:
            approach = abs(distance - self.distance) / (self.options.approach * self.model.scene.geometry.length)
        return 1.0 / max(1, int(np.ceil(turn + approach - 1e-9)))

    def _step(self, tensions: np.ndarray, distance: float | None) -> int:
        """One step, by the first strategy that works; returns the iterations it needed.

        Raises:
            NotConverged: the model is back at the last good load, its tangent factorised for the next, shorter try.
        """
        model, newton = self.model, self.newton
        before = model.displacement.copy()
        reason = ""
        for strategy in ("mixed", "plain"):
            model.displacement[:] = before
            if self._factorised and strategy == "mixed":
                self._predict(tensions, distance)
            model.set_loads(tensions, distance)
            try:
                needed = newton.solve(mixed=strategy == "mixed")
            except NotConverged as failure:
                self.iterations += failure.iterations
                self._factorised = False
                reason = f"{strategy} Newton: {failure.reason}"
                continue
            self.tensions, self.distance = tensions.copy(), distance
            self.iterations, self.steps = self.iterations + needed, self.steps + 1
            self._factorised = self._factorised or needed > 0
            self.strategies[strategy] += 1
            return needed
        model.displacement[:] = before
        model.set_loads(self.tensions, self.distance)
        newton.factorise()
        self._factorised = True
        raise NotConverged(reason)

    def _predict(self, tensions: np.ndarray, distance: float | None) -> None:
        """Move along du/dF and du/dd with the last factorised tangent, the nodes in contact moving with the plane."""
        moved = 0.0 if distance is None or self.distance is None else distance - self.distance
        if moved or np.any(tensions != self.tensions):
            change = self.model.load_gradient(tensions - self.tensions, moved)
            self.newton.add(-self.newton.linear_solve(change))

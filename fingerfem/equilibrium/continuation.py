"""Continuation to a load: predictor, adaptive steps, three Newton strategies, bisection; an answer or an exception."""

import contextlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.discretisation.problem import Problem
from fingerfem.equilibrium.failures import BeyondLaw, LoadNotReached, NotConverged
from fingerfem.equilibrium.linearisation import Linearisation
from fingerfem.equilibrium.newton import Newton, Strategy
from fingerfem.equilibrium.rigid_plates import RigidPlates
from fingerfem.equilibrium.steps import Loads, Step
from fingerfem.equilibrium.turns import turns

STRATEGIES: tuple[Strategy, ...] = ("mixed", "plain", "line search")  # in the order they are tried


@dataclass(frozen=True, kw_only=True)
class StepOptions:
    """Limits of the steps along a path of loads.

    Attributes:
        turn: largest rotation of a slender finger's tip in one step, see `turns` [rad].
        first_turn: the same for the first step [rad].
        approach: most the plane may move in a step, over the finger's length [-].
        touch: how far the plane moves past the first node it meets, over the finger's side [-].
        halvings: the path is given up when a step fails that is 2^halvings times shorter than the first one ...
        wasted: ... or when its failed steps took more iterations than this. Paths that go on take up to 122.
    """

    turn: float = 0.75
    first_turn: float = 0.4
    approach: float = 0.15
    touch: float = 1e-7
    halvings: int = 10
    wasted: int = 300


def _strategies(halvings: int) -> Sequence[Strategy]:
    """Strategies to try after a number of halvings: at first, a shorter step costs less than a more robust strategy."""
    return STRATEGIES[: 1 + (halvings >= 2) + (halvings >= 6)]


class Continuation:
    """Leads a problem from one equilibrium to the next.

    `iterations`, those `wasted` in failed attempts, `steps` and `strategies` count since the last call of `rest` or
    `start`.
    """

    def __init__(self, problem: Problem, options: StepOptions | None = None):
        self.problem, self.options, self.newton = problem, options or StepOptions(), Newton(problem)
        self._plates, self._turns = RigidPlates(problem), turns(problem)
        self.rest()

    def rest(self) -> None:
        """Back to the undeformed finger without loads, its weight among them, which the next `advance` adds."""
        self.start(np.zeros(len(self.problem.scene.actuators)), None, np.zeros_like(self.problem.displacement))
        self.weight = 1.0 if self.problem.scene.gravity is None else 0.0
        self._set_loads()

    def start(
        self,
        tensions: ArrayLike,
        distance: float | None,
        displacement: np.ndarray,
        wrenches: ArrayLike | None = None,
    ) -> None:
        """Take an equilibrium that is known: displacement [m], shape (3 nodes,), and its loads as in `advance`."""
        self.tensions, self.distance, self.weight = np.array(tensions, float), distance, 1.0
        self.wrenches = np.zeros_like(self.problem.wrenches) if wrenches is None else np.array(wrenches, float)
        self.problem.displacement[:] = displacement
        self._set_loads()
        self.iterations, self.wasted, self.steps = 0, 0, 0
        self.strategies: Counter[str] = Counter()
        self._linearisation: Linearisation | None = None
        self._last: Step | None = None

    def _set_loads(self) -> None:
        self.problem.set_loads(self.tensions, self.distance, self.wrenches, self.weight)

    def advance(self, tensions: ArrayLike, distance: float | None, wrenches: ArrayLike | None = None) -> None:
        """Go in a straight line from the present load to tensions, and distance [m].

        An obstacle that was absent is first placed where it just touches the finger.

        Args:
            tensions: of tendons [N], then pressures of chambers [Pa], shape (actuators,).
            distance: of the obstacle [m]; None without an obstacle.
            wrenches: on the plates in their own frames, shape (plates, 6) [N, N m]; None takes them away.

        Raises:
            LoadNotReached: the problem is then left at the last good load.
            ValueError: distance is None although an obstacle is there.
        """
        if self.distance is not None and distance is None:
            raise ValueError("distance must be a number while a plane is there, got None")
        pressed = np.zeros_like(self.wrenches) if wrenches is None else np.array(wrenches, float)
        target = Loads(np.array(tensions, float), distance, pressed, 1.0)
        comes = self._place_obstacle(distance)
        origin = self._loads
        largest, first = self._sizes(target)
        fraction, size, failed, wasted = 0.0, first, False, self.wasted
        beyond, reason = np.inf, ""  # share of the path at which a law has no answer, and what it has none to
        while fraction < 1.0:
            # Share the remainder evenly, so that the last step is not needlessly short.
            remaining = 1.0 - fraction
            share = remaining / max(1.0, np.ceil(remaining / size - 0.05)) if fraction else size
            share = min(share, (beyond - fraction) / 2)
            ahead = 1.0 if fraction + share > 1 - 1e-12 else fraction + share
            halvings = int(np.log2(max(first / share, 1.0)) + 0.5)
            try:
                if np.isfinite(beyond) and halvings > self.options.halvings:
                    raise NotConverged(reason)
                needed = self._step(origin.towards(target, ahead), _strategies(halvings))
            except NotConverged as failure:
                if isinstance(failure, BeyondLaw):
                    beyond, reason = ahead, failure.reason
                if halvings >= self.options.halvings or self.wasted - wasted > self.options.wasted:
                    tried = f"{failure.reason}; failed steps took {self.wasted - wasted} iterations"
                    raise self._failure(tried, without_obstacle=comes and not fraction) from None
                size, failed = share / 2, True
                continue
            if needed <= 6 and not failed:
                size = min(2 * share, largest)
            fraction, failed = ahead, False

    def settle(self) -> None:
        """Bring a displacement that is near to the equilibrium of the present loads there, in one attempt.

        Raises:
            NotConverged: the problem is back at that displacement.
        """
        self._step(self._loads, STRATEGIES[:2])

    @property
    def _loads(self) -> Loads:
        return Loads(self.tensions.copy(), self.distance, self.wrenches.copy(), self.weight)

    def _place_obstacle(self, distance: float | None) -> bool:
        """Place an obstacle that was absent where it touches the finger; whether it was absent."""
        if distance is None or self.distance is not None:
            return self.distance is None
        # A hair inside what touches first, so that the tangent moves those nodes with the plane.
        self.distance = max(self.problem.reach() - self.options.touch * self.problem.scene.geometry.side, distance)
        self._set_loads()
        self._linearisation, self._last = None, None
        return True

    def _failure(self, reason: str, *, without_obstacle: bool) -> LoadNotReached:
        """Exception to raise at the last good load; without the obstacle if nothing was solved with it."""
        if without_obstacle:
            self.distance = None
            self._set_loads()
        part = "" if self.weight == 1 else f" ({self.weight:.0%} of the weight acts there)"
        scene = self.problem.scene
        chambers, stiffness = len(scene.chambers), scene.law.young_modulus * scene.geometry.thinnest_area
        compression = float(self.tensions[: len(scene.tendons)].sum()) / stiffness
        return LoadNotReached(reason + part, self.tensions.copy(), self.distance, chambers, compression)

    def _sizes(self, target: Loads) -> tuple[float, float]:
        """Largest and first step, as fractions of the path."""
        turn = float(np.abs(target.tensions - self.tensions) @ self._turns.actuators)
        turn += float(np.abs(target.wrenches - self.wrenches).sum(axis=0) @ self._turns.wrench)
        turn += (1.0 - self.weight) * self._turns.weight
        approach = 0.0
        if target.distance is not None and self.distance is not None:
            moved = abs(target.distance - self.distance)
            approach = moved / (self.options.approach * self.problem.scene.geometry.length)
        first_turn = self.options.first_turn if self._last is None else self.options.turn
        return 1 / max(1.0, turn / self.options.turn + approach), 1 / max(1.0, turn / first_turn + approach)

    def _step(self, loads: Loads, strategies: Sequence[Strategy]) -> int:
        """One step, by the first strategy that works; returns the iterations it needed.

        Raises:
            NotConverged: the problem is back at the last good load.
        """
        problem, newton = self.problem, self.newton
        before = problem.displacement.copy()
        reason, kind, spent = "", NotConverged, 0
        for strategy in strategies:
            if strategy == "line search" and loads.wrenches.any():
                continue  # follower loads have no potential to search
            problem.displacement[:] = before
            self._set_loads()
            self._hold(strategy != "line search")
            step = None
            if strategy != "line search":
                with contextlib.suppress(NotConverged):  # a singular tangent gives no prediction
                    step = self._predict(loads)
            problem.set_loads(*loads)
            # Without the mixed formulation, the stress at the predicted displacement is an equally good start.
            is_predicted = step is not None and any(law.is_mixed for law in problem.scene.laws)
            try:
                needed, linearisation = newton.solve(strategy, is_predicted=is_predicted)
            except NotConverged as failure:
                self.iterations, self.wasted = self.iterations + failure.iterations, self.wasted + failure.iterations
                spent += failure.iterations
                self._linearisation = None
                reason = f"{strategy}: {failure.reason}"
                if isinstance(failure, BeyondLaw):  # another strategy would find the same equilibrium
                    kind = BeyondLaw
                    break
                continue
            self._hold(False)
            self.tensions, self.distance, self._last = loads.tensions.copy(), loads.distance, step
            self.wrenches, self.weight = loads.wrenches.copy(), loads.weight
            self.iterations, self.steps = self.iterations + needed, self.steps + 1
            self._linearisation = linearisation or self._linearisation
            self.strategies[strategy] += 1
            return needed
        self._hold(False)
        problem.displacement[:] = before
        self._set_loads()
        self._last = None  # a cubic cannot foresee what made this step fail
        raise kind(reason, spent)

    def _hold(self, held: bool) -> None:
        if self.problem.contact is not None:
            self.problem.contact.hold(held)

    def linearise(self) -> Linearisation:
        """The tangent at the present equilibrium. It also predicts the next step.

        Raises:
            NotConverged: it is singular.
        """
        self._linearisation = None
        self._linearisation = self.newton.linearise()
        return self._linearisation

    def _predict(self, loads: Loads) -> Step | None:
        """Move to where the next equilibrium is expected, by the last factorised tangent.

        The nodes in contact move with the plane. After a step in the same direction, a cubic goes through both its ends
        and their tangents; a first step follows the tangent alone. Plates move rigidly.
        """
        problem = self.problem
        moved = 0.0 if loads.distance is None or self.distance is None else loads.distance - self.distance
        pulled, pressed = loads.tensions - self.tensions, loads.wrenches - self.wrenches
        fallen = loads.weight - self.weight
        load = np.concatenate([pulled, pressed.ravel(), [fallen, moved]])
        if not load.any():
            return None
        linearisation = self._linearisation or self.linearise()
        slope = -linearisation.solve(problem.load_gradient(pulled, moved, pressed, weight=fallen))
        before = problem.displacement.copy()
        problem.extrapolate_stress(slope)
        step = Step(load=load, start=before[: len(slope)], slope=slope)
        self.newton.add(slope if self._last is None else step.change_after(self._last))
        self._plates.move(before)
        return step

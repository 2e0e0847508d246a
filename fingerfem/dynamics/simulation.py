"""A motion of the full-order finger in time: steps that are repeated smaller where they fail, and what is reported."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from fingerfem.dynamics.energy_balance import Balance, EnergyBalance
from fingerfem.dynamics.generalised_alpha import MotionStopped, MovingState, Stepper
from fingerfem.dynamics.motion import Motion
from fingerfem.dynamics.moving_problem import MovingProblem
from fingerfem.equilibrium.continuation import Continuation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.scene.grid_lines import in_plate
from fingerfem.scene.scene import Scene
from rom.dataset import rigid_motion

SMALLEST = 2.0**-14  # of the step that is asked for, below which a motion is given up [-]
MADE = 0.01  # energy from nowhere, over the largest energy so far, that a motion may have [-]
GROWTH, SHRINKAGE, SAFETY = 2.0, 0.2, 0.9  # of the next step over the last one [-]


class _Repeat(Exception):
    """A step that converged and does not count: why, and how much shorter the next one is to be [-]."""

    def __init__(self, reason: str, factor: float):
        super().__init__(reason)
        self.factor = factor


@dataclass(frozen=True)
class Moment:
    """All that a motion goes on from.

    Attributes:
        state: the finger.
        balance: of its energies.
        step: that is tried next [s].
        repeated: steps until now that were tried and did not count.
    """

    state: MovingState
    balance: Balance
    step: float
    repeated: int = 0


class Simulation:
    """The motion of a scene's finger.

    Args:
        scene: with densities; its obstacle has the penalty method.
        motion: of its loads and its base.

    Raises:
        ValueError: the scene lacks what a motion needs.

    Example:
        >>> simulation = Simulation(scene, read_motion("motion.toml", scene))
        >>> simulation.run(lambda row, moment: print(row["time"], row["tip_y"]))
    """

    def __init__(self, scene: Scene, motion: Motion):
        self.scene, self.motion = scene, motion
        self.problem = MovingProblem(scene)
        self._continuation = Continuation(self.problem)
        self._stepper = Stepper(self.problem, motion, self._continuation.newton)
        self._tip = np.flatnonzero(in_plate(scene.outline, len(scene.geometry.segments) - 1, self.problem.rest.T))

    def begin(self, velocity: np.ndarray | None = None) -> Moment:
        """The equilibrium of the loads at time 0.

        Args:
            velocity: of the nodes in it, zero where held, shape (3 nodes,) [m/s]; at rest if left out.

        Raises:
            LoadNotReached: there is none.
        """
        tensions, distance = self.motion.loads(0.0, after=False)
        self._continuation.rest()
        self._continuation.advance(tensions, None)
        if distance is not None:
            self._continuation.advance(tensions, distance)
        state = self._stepper.begin(velocity)
        return Moment(state, EnergyBalance(self.problem, state).balance, self.motion.time.step)

    def run(self, report: Callable[[dict[str, float], Moment], None], moment: Moment | None = None) -> Moment:
        """Report every state from a moment on, or from the beginning, and return the last one.

        Raises:
            LoadNotReached: the loads at time 0 have no equilibrium.
            MotionStopped: from a state on no step converges, or keeps its energy, however small.
        """
        if moment is None:
            moment = self.begin()
            report(self.row(moment), moment)
        ledger = self._ledger(moment)
        for end in self.motion.breaks[self.motion.breaks > moment.state.time]:
            if self.motion.jumps(moment.state.time):
                moment = replace(moment, state=self._stepper.started(moment.state), step=self.motion.time.step)
                self._stepper.place(moment.state, after=True)
                ledger.take(moment.state)
            while moment.state.time < end:
                moment = self._advance(moment, float(end), ledger)
                report(self.row(moment), moment)
        return moment

    def _ledger(self, moment: Moment) -> EnergyBalance:
        self._stepper.place(moment.state, after=True)
        return EnergyBalance(self.problem, moment.state, moment.balance)

    def _advance(self, moment: Moment, end: float, ledger: EnergyBalance) -> Moment:
        """One step towards a time at which a step must end [s], as long as it may be."""
        state, step, repeated = moment.state, moment.step, moment.repeated
        while True:
            shares = int(np.ceil((end - state.time) / step * (1 - 1e-9)))
            goal = end if shares <= 1 else state.time + (end - state.time) / shares
            try:
                reached, factor = self._tried(state, goal)
                balance = self._balanced(reached, ledger)
                break
            except _Repeat as failure:
                reason, step = str(failure), failure.factor * (goal - state.time)
            except NotConverged as failure:
                reason, step = failure.reason, (goal - state.time) / 2
            repeated += 1
            if step < SMALLEST * self.motion.time.step:
                self._stepper.place(state, after=False)
                raise MotionStopped(reason, state.time)
        ledger.balance = balance
        self._stepper.place(reached, after=True)
        ledger.take(reached)
        return Moment(reached, balance, min(self.motion.time.step, factor * step), repeated)

    def _tried(self, state: MovingState, goal: float) -> tuple[MovingState, float]:
        """A step, and how much longer the next one may be [-]."""
        reached, error = self._stepper.step(state, goal)
        tolerance = self.motion.time.tolerance
        if tolerance is None:
            return reached, GROWTH
        factor = float(np.clip(SAFETY * (tolerance / max(error, 1e-300)) ** (1 / 3), SHRINKAGE, GROWTH))
        if error > tolerance:
            raise _Repeat(f"the step's error is {error:.1e} of the length, above time.tolerance", factor)
        return reached, factor

    def _balanced(self, reached: MovingState, ledger: EnergyBalance) -> Balance:
        """The balance after a step that makes no energy."""
        self._stepper.place(reached, after=False)
        balance = ledger.after(reached)
        made = ledger.balance.lost - balance.lost
        if made > MADE * balance.largest:
            raise _Repeat(f"the step would make {made:.1e} J of energy", 0.5)
        return balance

    def row(self, moment: Moment) -> dict[str, float]:
        """The row of a moment: time [s], tip [m], its turn [rad], loads, mean contact force [N], energies."""
        state, problem = moment.state, self.problem
        self._stepper.place(state, after=False)
        tip, turn = problem.tip(), self._turn()
        found = {"time": state.time, **dict(zip(("tip_x", "tip_y", "tip_z"), tip.tolist(), strict=True))}
        found |= dict(zip(("turn_x", "turn_y", "turn_z"), turn.tolist(), strict=True))
        found |= dict(zip(self.scene.actuators, problem.tensions.tolist(), strict=True))
        if problem.contact is not None:
            found |= {"d": np.nan if problem.distance is None else problem.distance}
            found |= {"contact_force": problem.contact.force() + state.impact}
        energies = moment.balance.as_dict()
        energies.pop("largest")
        return found | energies | {"repeated": moment.repeated}

    def _turn(self) -> np.ndarray:
        """Rotation vector of the tip plate, seen from the base, shape (3,) [rad]."""
        rest, moved = self.problem.rest[self._tip], self.problem.displacement.reshape(-1, 3)[self._tip]
        arms = rest - rest.mean(axis=0)
        if self.scene.is_half:  # with its mirror image
            arms[:, 2] = rest[:, 2]
        places = rest + moved
        correlation = (places - places.mean(axis=0) * [1, 1, 0 if self.scene.is_half else 1]).T @ arms
        if self.scene.is_half:
            correlation[2, :2] = correlation[:2, 2] = 0.0
        rotation, _ = rigid_motion.nearest_rotations(correlation)
        return np.asarray(Rotation.from_matrix(rotation).as_rotvec())

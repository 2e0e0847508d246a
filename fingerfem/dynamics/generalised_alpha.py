"""One step in time: the generalised-alpha method with contact at the step's end.

(Chung, Hulbert, J. Appl. Mech. 60, 1993, doi:10.1115/1.2900803.) With the displacement u, the velocity v, the
acceleration a, the step h and internal forces I, those of loads among them, a step from 0 to 1 has

    M ((1 - am) a1 + am a0) + (1 - af) I1 + af I0 + C1 = 0
    u1 = u0 + h v0 + h^2 ((1/2 - b) a0 + b a1)        v1 = v0 + h ((1 - c) a0 + c a1)

with am, af, b and c of the spectral radius. It is of second order. Contact forces C1 are those at the end alone, and
the velocity of what presses is that of `persistency`: an impact takes energy and makes none. There the obstacle takes
more momentum. With the velocity and the acceleration at both ends of a step, those after `persistency`,

    M (v1 - v0) / h + (1/2 - af) M (a1 - a0) = -(1 - af) I1 - af I0 - C1 - D:

D is the force of impact.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from fingerfem.dynamics.motion import Motion
from fingerfem.dynamics.moving_problem import Base, Inertia, MovingProblem
from fingerfem.dynamics.persistency import Persistency
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.equilibrium.newton import Newton, Strategy
from fingerfem.equilibrium.rigid_plates import RigidPlates

FASTEST = 0.3  # turn of the base in a step that Newton's method, which leaves spin out, still follows [rad]
ATTEMPTS: tuple[tuple[Strategy, bool], ...] = (("mixed", True), ("plain", True), ("plain", False))  # and if predicted


class MotionStopped(Exception):
    """No step leads on from a time of the motion [s]; what was reported until then stands.

    Args:
        reason: why.
        time: of the last state [s].
    """

    def __init__(self, reason: str, time: float):
        super().__init__(f"no step leads on from {time:.6g} s: {reason}")
        self.reason, self.time = reason, time


@dataclass(frozen=True)
class Scheme:
    """Coefficients of a spectral radius at high frequencies."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    @classmethod
    def of(cls, radius: float) -> Scheme:
        """Parameters of a spectral radius from 0 to 1 [-]."""
        alpha_m, alpha_f = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
        return cls(alpha_m, alpha_f, (1 - alpha_m + alpha_f) ** 2 / 4, 0.5 - alpha_m + alpha_f)


@dataclass(frozen=True, kw_only=True)
class MovingState:
    """A finger at one time.

    Attributes:
        time: [s].
        displacement, velocity, acceleration: seen from the base, owned values, shape (3 nodes,) [m], [m/s], [m/s^2].
        rotation: of the base, shape (3, 3) [-].
        overstresses: of viscoelastic branches, shape (branches, cells, points, 3, 3) [Pa].
        impact: mean over the step before on the obstacles, in addition to the contact force at its end [N].
    """

    time: float
    displacement: np.ndarray = field(repr=False)
    velocity: np.ndarray = field(repr=False)
    acceleration: np.ndarray = field(repr=False)
    rotation: np.ndarray
    overstresses: np.ndarray = field(repr=False)
    impact: float = 0.0


class Stepper:
    """Leads a finger through a motion, step by step.

    Args:
        problem: the finger.
        motion: its loads and its base.
        newton: the solver of the problem.
    """

    def __init__(self, problem: MovingProblem, motion: Motion, newton: Newton):
        self.problem, self.motion, self._newton = problem, motion, newton
        self._scheme = Scheme.of(motion.time.spectral_radius)
        self._plates = RigidPlates(problem)
        self._persistency = None if problem.contact is None else Persistency(problem)

    def begin(self, velocity: np.ndarray | None) -> MovingState:
        """First state: the problem's equilibrium, with a velocity [m/s] or at rest, under the loads after time 0."""
        u = self.problem.displacement.copy()
        branches = self.problem.branches
        stresses = np.zeros(0) if branches is None else branches.stresses
        rest = np.zeros_like(u)
        v = rest if velocity is None else velocity
        first = MovingState(
            time=0.0, displacement=u, velocity=v, acceleration=rest, rotation=np.eye(3), overstresses=stresses
        )
        return self.started(first)

    def started(self, state: MovingState) -> MovingState:
        """The same with the acceleration of the forces after its time, where they jump.

        It is that of the motions that a step h resolves, (M + b h^2 K) a = -R with the tangent K. Faster ones would
        be noise.

        Raises:
            MotionStopped: the matrix is singular.
        """
        self.place(state, after=True)
        residual, _ = self.problem.residual()
        resolved = 1 / (self._scheme.beta * self.motion.time.step**2)
        self.problem.inertia = Inertia(resolved, np.zeros_like(state.velocity), 0.0, state.velocity)
        try:
            change = self._newton.linearise().solve(residual)
        except NotConverged as failure:
            raise MotionStopped(failure.reason, state.time) from None
        return replace(state, acceleration=-resolved * change)

    def place(self, state: MovingState, after: bool) -> None:
        """Have the problem be in a state, with the loads after or before its time, as if it were an equilibrium."""
        problem = self.problem
        problem.displacement[:] = state.displacement
        problem.set_loads(*self.motion.loads(state.time, after))
        self._move_base(state.time, state.rotation, after)
        problem.inertia = Inertia(0.0, np.zeros_like(state.velocity), 0.0, state.velocity)
        if problem.branches is not None:
            problem.branches.stresses = state.overstresses
            problem.branches.stay()
        if problem.contact is not None:
            problem.contact.weigh(1.0)

    def _move_base(self, time: float, rotation: np.ndarray, after: bool) -> None:
        moves = self.motion.base_moves
        self.problem.base = Base(self.motion.base(time, after), rotation) if moves else None

    def step(self, state: MovingState, end: float) -> tuple[MovingState, float]:
        """The state at a later time [s], and the error of the step over the finger's length [-].

        The error is (b - 1/6) h^2 (a1 - a0), what the displacement's own acceleration changes it by at third order
        (Zienkiewicz, Xie, Earthq. Eng. Struct. Dyn. 20, 1991), as a mean over the mass.

        Raises:
            NotConverged: there is none. The problem is then anywhere.
        """
        problem, scheme, h = self.problem, self._scheme, end - state.time
        u0, v0, a0 = state.displacement, state.velocity, state.acceleration
        rotation = self._turned(state, end)
        inner = self._inner_forces(state)
        if problem.branches is not None:
            problem.branches.begin(h)
        weight = 1 / (1 - scheme.alpha_f)
        problem.set_loads(*self.motion.loads(end, after=False))
        self._move_base(end, rotation, after=False)
        start = u0 + h * v0 + h**2 * (0.5 - scheme.beta) * a0  # u1 without a1
        mass, rate = weight * (1 - scheme.alpha_m) / (scheme.beta * h**2), scheme.gamma / (scheme.beta * h)
        forces = weight * (scheme.alpha_m * problem.times_mass(a0) + scheme.alpha_f * inner)
        problem.inertia = Inertia(
            mass,
            forces - mass * problem.times_mass(start),
            rate,
            v0 + h * (1 - scheme.gamma) * a0 - rate * start,
        )
        if problem.contact is not None:
            problem.contact.weigh(weight)
        self._solve(u0, h * v0 + h**2 / 2 * a0)
        u1 = problem.displacement.copy()
        a1 = (u1 - start) / (scheme.beta * h**2)
        v1 = rate * u1 + problem.inertia.remainder
        if problem.branches is not None:
            problem.branches.settle(h)
        if problem.contact is not None:
            problem.contact.weigh(1.0)
        impact = 0.0
        if self._persistency is not None and self.motion.loads(end, after=False)[1] is not None:
            v1, a1, momentum, force = self._persistency.keep(v1, a1, h, self._obstacle_speed(state.time, end))
            impact = momentum / h + (0.5 - scheme.alpha_f) * force
        kept = np.zeros(0) if problem.branches is None else problem.branches.stresses
        reached = MovingState(
            time=end,
            displacement=u1,
            velocity=v1,
            acceleration=a1,
            rotation=rotation,
            overstresses=kept,
            impact=impact,
        )
        return reached, abs(scheme.beta - 1 / 6) * h**2 * self._mean(a1 - a0) / problem.scene.geometry.length

    def _turned(self, state: MovingState, end: float) -> np.ndarray:
        """Orientation of the base at the end of a step, by its mean angular velocity."""
        if not self.motion.base_moves:
            return state.rotation
        ends = self.motion.base(state.time, after=True).spin, self.motion.base(end, after=False).spin
        turn = (end - state.time) * (ends[0] + ends[1]) / 2
        if np.linalg.norm(turn) > FASTEST:
            raise NotConverged(f"the base turns by {np.linalg.norm(turn):.2g} rad in a step, at most {FASTEST} rad")
        return state.rotation @ Rotation.from_rotvec(turn).as_matrix()

    def _inner_forces(self, state: MovingState) -> np.ndarray:
        """I at the beginning of a step, shape (owned values,) [N]."""
        self.place(state, after=True)
        if self.problem.contact is not None:
            self.problem.contact.weigh(0.0)
        residual, _ = self.problem.residual()
        forces = residual.array_r.copy()
        residual.destroy()
        return forces

    def _solve(self, before: np.ndarray, change: np.ndarray) -> None:
        """The displacement at the end of the step."""
        problem, reasons = self.problem, []
        mixed = any(law.is_mixed for law in problem.scene.laws)
        for strategy, is_predicted in ATTEMPTS:
            problem.displacement[:] = before
            if is_predicted:
                problem.extrapolate_stress(change)
                self._newton.add(change)
                self._plates.move(before)
            try:
                self._newton.solve(strategy, is_predicted=is_predicted and mixed)
                return
            except NotConverged as failure:
                reasons.append(f"{strategy}: {failure.reason}")
        raise NotConverged(reasons[-1])

    def _obstacle_speed(self, begin: float, end: float) -> float:
        """Mean speed of the obstacle along its direction [m/s]."""
        (_, before), (_, now) = self.motion.loads(begin, after=True), self.motion.loads(end, after=False)
        assert before is not None and now is not None
        return (now - before) / (end - begin)

    def _mean(self, values: np.ndarray) -> float:
        """Root of the mean square over the mass, shape (owned values,)."""
        ones = np.tile([1.0, 0.0, 0.0], len(values) // 3)
        whole = float(ones @ self.problem.times_mass(ones, whole=True))
        return float(np.sqrt(max(values @ self.problem.times_mass(values), 0.0) / whole))

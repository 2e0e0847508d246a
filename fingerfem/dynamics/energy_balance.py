"""The energy balance of a motion: kinetic, elastic, contact; the work of loads and branches; and what is lost.

Works are added up step by step by the trapezoidal rule, which is exact to the method's own order. The loss, with its
sign, is the sum of works less the rise of the finger's energy: by the method's damping of high frequencies and by
impacts. It must not fall below zero by more than the steps' own error: that would be energy from nowhere.
"""

from dataclasses import asdict, dataclass, replace
from typing import NamedTuple

import numpy as np

from fingerfem.dynamics.generalised_alpha import MovingState
from fingerfem.dynamics.moving_problem import MovingProblem

ROUND_OFF = 1e-9  # over E a^3: an energy that is small against all others [-]


@dataclass(frozen=True, kw_only=True)
class Balance:
    """Energies at one time, and works since the beginning [J].

    Attributes:
        kinetic: seen from the base.
        strain: of rubber, all relaxed, and plates.
        contact: of the penalty.
        actuators: work of tensions and pressures.
        body: of weight and of the base's motion.
        obstacle: of the obstacle's motion.
        branches: work done on viscoelastic branches, what they store and what they dissipate.
        lost: by the method and by impacts.
        largest: of the energies until now, the scale of what is small.
    """

    kinetic: float
    strain: float
    contact: float
    actuators: float = 0.0
    body: float = 0.0
    obstacle: float = 0.0
    branches: float = 0.0
    lost: float = 0.0
    largest: float = 0.0

    def as_dict(self) -> dict[str, float]:
        """Energies by name."""
        return asdict(self)


class Forces(NamedTuple):
    """Forces that do work at one end of a step: tensions and pressures [N], [Pa]; nodal ones [N]; N of the obstacle."""

    tensions: np.ndarray
    body: np.ndarray
    branches: np.ndarray
    obstacle: float


class EnergyBalance:
    """The energies of a finger whose states follow each other.

    Args:
        problem: the finger, in its first state.
        state: the first state.
        balance: of it, if works were done before.
    """

    def __init__(self, problem: MovingProblem, state: MovingState, balance: Balance | None = None):
        self._problem = problem
        kinetic, strain, contact = self._energies(state)
        least = ROUND_OFF * problem.force_scale * problem.scene.geometry.side
        first = Balance(kinetic=kinetic, strain=strain, contact=contact, largest=least)
        self.balance = balance or first
        self.take(state)

    def take(self, state: MovingState) -> None:
        """Begin steps at a state that the problem is in, with the loads after its time."""
        self._state, self._lengths, self._distance = state, self._actuated(), self._problem.distance
        self._forces = self._acting(state)

    def after(self, state: MovingState) -> Balance:
        """The balance at the end of a step, in which the problem is, with the loads before its time."""
        was, now, ahead = self.balance, self._forces, self._acting(state)
        moved = state.displacement - self._state.displacement
        kinetic, strain, contact = self._energies(state)
        works = {
            "actuators": -float((now.tensions + ahead.tensions) @ (self._actuated() - self._lengths)) / 2,
            "body": float((now.body + ahead.body) @ moved) / 2 * self._problem.copies,
            "branches": float((now.branches + ahead.branches) @ moved) / 2 * self._problem.copies,
            "obstacle": self._obstacle_work(now, ahead, state.impact),
        }
        gained = kinetic + strain + contact - was.kinetic - was.strain - was.contact
        lost = works["actuators"] + works["body"] + works["obstacle"] - works["branches"] - gained
        summed = {name: getattr(was, name) + work for name, work in works.items()}
        largest = max(was.largest, kinetic + abs(strain) + contact, *map(abs, summed.values()))
        return replace(
            was, kinetic=kinetic, strain=strain, contact=contact, lost=was.lost + lost, largest=largest, **summed
        )

    def _obstacle_work(self, now: Forces, ahead: Forces, impact: float) -> float:
        if self._distance is None or self._problem.distance is None:
            return 0.0
        force = (now.obstacle + ahead.obstacle) / 2 + impact
        return -force * (self._problem.distance - self._distance)

    def _energies(self, state: MovingState) -> tuple[float, float, float]:
        problem = self._problem
        kinetic = problem.summed(float(state.velocity @ problem.times_mass(state.velocity)) / 2)
        contact = 0.0 if problem.contact is None else problem.contact.energy()
        return kinetic, problem.scalar(problem.forms.strain_energy), contact

    def _actuated(self) -> np.ndarray:
        """Lengths of tendons [m], then minus volumes of chambers [m^3], shape (actuators,)."""
        problem = self._problem
        return np.array([problem.tendon_length(k) for k in range(len(problem.tensions))])

    def _acting(self, state: MovingState) -> Forces:
        problem = self._problem
        body = problem.body_forces(state.velocity)
        contact = 0.0 if problem.contact is None else problem.contact.force()
        return Forces(problem.tensions.copy(), body, problem.branch_forces(), contact)

"""Friction of tendons in their guides while a finger moves.

The guide between element k and the next one towards the motor takes tau_k = T_k+1 - T_k of the tension. The slip s_k is
the sum of shortenings from the tendon's plate on. Coulomb's law with an elastic begin (Dahl 1968) is

    tau_k = tau_k0 + stiffness (s_k - s_k0),    -room <= tau_k <= room / exp(mu theta),
    room = T_k+1 (exp(mu theta) - 1) + c,

with the bounds of rod/guides.c and tau_k0, s_k0 of the last step. Tensions are those of the step's end. Newton's method
solves for them; differences measure how slips respond to tensions in a step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.rod.compiled import guides
from rom.rod.compiled.motion import Stepped
from rom.rod.guides.guided_finger import GuidedFinger
from rom.rod.motion.branches import branches_of
from rom.rod.touched_rod import TouchedRod

STIFF = 10.0  # of a guide that sticks, over that of its element by the tension in it [-]
STEPS, RENEWED = 20, 6  # of Newton's method; the response is measured anew after so many
SETTLED = 1e-6  # converged: largest change of a tension over its range [-]
DIFFERENCE = 1e-3  # of a tension for the response, over its range [-]
INCREMENTS = 8  # from rest to the first equilibrium

Taken = Callable[[np.ndarray], Stepped | None]


@brief
class Sliding(NamedTuple):
    """Tendons at the end of a step.

    Attributes:
        tensions: in every element, shape (n, t) [N].
        slips: of the tendons at the elements' ends towards the motor, shape (n, t) [m].
        motors: tensions there, shape (t,) [N].
        dissipated: since the beginning [J].
    """

    tensions: np.ndarray
    slips: np.ndarray
    motors: np.ndarray
    dissipated: float


class TendonFriction:
    """Tensions of a moving finger's tendons along their guides.

    Args:
        model: the finger and its objects, with masses.
        point: tensions [N] and d [m] of the initial equilibrium, shape (t + m,), which motors reach from rest together.
        friction: see `GuidedFinger`.
        per_length: likewise.

    Raises:
        ModelError: what `GuidedFinger` refuses, no initial equilibrium, or rubber that relaxes.
    """

    def __init__(self, model: TouchedRod, point: np.ndarray, friction: float | Sequence[float], per_length: float):
        if branches_of(model.rod) is not None:
            raise ModelError(
                "material.prony must be left out with friction of tendons, got branches, which have no guides"
            )
        self._guided, t = GuidedFinger(model=model, friction=friction, per_length=per_length), len(model.rod.names)
        begun = self._guided.arrays.motors.copy()
        for share in np.arange(1, 1 + INCREMENTS) / INCREMENTS:
            between = point.copy()
            between[:t] = begun + share * (point[:t] - begun)
            if self._guided.advance(between).status != "converged":
                raise ModelError(f"parameters must be where the finger can rest, got {point.tolist()}")
        self._paths = _paths(model)
        self._lower, self._upper = np.array([[one.lower, one.upper] for one in model.rod.parameters]).T
        arrays = self._guided.arrays
        arrays.rates[:] = np.eye(t)  # derivatives are by every element's own tensions
        found = self._elements(arrays.motors, arrays.loads)
        rubs = (arrays.friction > 0) | (arrays.drag > 0)
        self._stiffness = np.divide(STIFF, np.abs(found.yielding), out=np.zeros(rubs.shape), where=self._passed & rubs)
        self._bends = found.bends
        self.now = Sliding(arrays.tensions.copy(), self._slips(found), arrays.motors.copy(), 0.0)
        self._kind: Any = None  # of the steps whose response is known
        self._response = np.zeros((found.yielding.size,) * 2)

    @property
    def touching(self) -> Any:
        """For compiled code, a struct fingerfem_touching of which every element has its own tensions."""
        return self._guided.touching

    @property
    def loads(self) -> np.ndarray:
        """On all bodies in the initial equilibrium, shape (l,) [N, N m]."""
        return self._guided.arrays.loads

    @property
    def _passed(self) -> np.ndarray:
        """True if a tendon passes an element, shape (n, t)."""
        found = np.zeros(self._guided.arrays.tensions.shape, bool)
        for j, path in enumerate(self._paths):
            found[path, j] = True
        return found

    def place(self) -> None:
        """Give the elements their tensions at the end of the last step."""
        self._guided.arrays.tensions[:] = self.now.tensions

    def advance(
        self, take: Taken, state: np.ndarray, loads: slice, motors: np.ndarray, gravity: np.ndarray | None, kind: Any
    ) -> Stepped | None:
        """A step to tensions at the motors; None without a solution: then tendons keep theirs.

        Args:
            take: the step from a state, with the elements' present tensions.
            state: where it begins, see `rom.rod.compiled.motion.Stepper`.
            loads: where a state has the loads on all bodies.
            motors: tensions, shape (t,) [N].
            gravity: see `rom.rod.compiled.guides.elements`.
            kind: steps of one kind have about the same response, such as those of one length.
        """
        arrays, scale = self._guided.arrays, self._upper - self._lower
        tensions, _, _ = self._march(motors, None, self.now.slips, self._bends)
        for k in range(STEPS):
            arrays.tensions[:] = tensions
            found = take(state)
            if found is None:
                break
            elements = self._elements(motors, found.state[loads], gravity)
            slips = self._slips(elements)
            if self._stiffness.any() and (k % RENEWED == RENEWED - 1 or self._kind != kind):
                self._kind, self._response = kind, self._measured(take, state, loads, motors, gravity, slips)
            wanted, by_slips, inside = self._march(motors, tensions, slips, elements.bends)
            change = wanted - tensions
            if np.abs(change / scale).max() < SETTLED:
                self._bends, taken = elements.bends, self._taken(tensions, slips, motors)
                self.now = Sliding(tensions, slips, motors.copy(), self.now.dissipated + taken)
                return found._replace(inside=found.inside and inside)
            state = state.copy()
            state[loads] = found.state[loads]
            matrix = np.eye(change.size) - by_slips @ self._response
            tensions = np.clip(
                tensions + np.linalg.solve(matrix, change.ravel()).reshape(change.shape), self._lower, self._upper
            )
        self.place()
        return None

    def _elements(
        self, motors: np.ndarray, loads: np.ndarray, gravity: np.ndarray | None = None
    ) -> guides.GuidedElements:
        return guides.elements(self.touching, self._guided.arrays, motors, loads, gravity)

    def _slips(self, elements: guides.GuidedElements) -> np.ndarray:
        """Shortenings from every tendon's plate to the end of each element, shape (n, t) [m]."""
        found = np.zeros_like(elements.shortenings)
        for j, path in enumerate(self._paths):
            found[path, j] = np.cumsum(elements.shortenings[path, j])
        return found

    def _forces(self, tensions: np.ndarray, motors: np.ndarray) -> np.ndarray:
        """Forces of the guides, tau, shape (n, t) [N]."""
        found = np.zeros_like(tensions)
        for j, path in enumerate(self._paths):
            found[path, j] = np.diff(tensions[path, j], append=motors[j])
        return found

    def _march(
        self, motors: np.ndarray, tensions: np.ndarray | None, slips: np.ndarray, bends: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, bool]:
        """Tensions by the law at slips, shape (n, t) [N], their derivatives by these, and whether they are in the box.

        With present tensions, guides stick or slip by the forces that would stop their plastic slip.
        """
        arrays, (n, t) = self._guided.arrays, slips.shape
        elastic = self._forces(self.now.tensions, self.now.motors) + self._stiffness * (slips - self.now.slips)
        trial = elastic
        if tensions is not None:
            forces, soft = self._forces(tensions, motors), 1 + self._stiffness * self._compliances()
            trial = forces + (elastic - forces) / soft
        found, by, inside = np.tile(motors, (n, 1)), np.zeros((n, t, n, t)), bool((motors <= self._upper).all())
        for j, path in enumerate(self._paths):
            tension, row, bend, drag = motors[j], np.zeros(n), 0.0, 0.0  # of the motor, then of the element behind
            for k in path[::-1]:
                grows = np.exp(arrays.friction[j] * 0.5 * (bends[k] + bend))
                room = tension * (grows - 1) + 0.5 * (arrays.drag[k, j] + drag)
                if trial[k, j] > room / grows:
                    tension, row = tension - room / grows, row / grows
                elif trial[k, j] < -room:
                    tension, row = tension + room, row * grows
                else:
                    tension, row = tension - elastic[k, j], row.copy()
                    row[k] -= self._stiffness[k, j]
                held = min(max(tension, self._lower[j]), self._upper[j])
                inside &= bool(tension <= self._upper[j])
                tension, row = held, row * (held == tension)
                found[k, j], by[k, j, :, j], bend, drag = tension, row, bends[k], arrays.drag[k, j]
        return found, by.reshape(n * t, n * t), inside

    def _compliances(self) -> np.ndarray:
        """Slips of a tendon in a step through each guide by a unit of the guide's force, shape (n, t) [m/N]."""
        shape = self._stiffness.shape
        found, response = np.zeros(shape), self._response.reshape(*shape, *shape)
        for j, path in enumerate(self._paths):  # tensions fall from the tip to the guide
            found[path, j] = np.tril(response[path, j][:, path, j]).sum(axis=1)
        return np.maximum(found, 0.0)

    def _measured(
        self,
        take: Taken,
        state: np.ndarray,
        loads: slice,
        motors: np.ndarray,
        gravity: np.ndarray | None,
        slips: np.ndarray,
    ) -> np.ndarray:
        """Derivatives of all slips in a step by all tensions, shape (n t, n t) [m/N]."""
        arrays, passed = self._guided.arrays, self._passed
        kept, found = arrays.tensions.copy(), np.zeros((*slips.shape, slips.size))
        for k, j in np.argwhere(passed & (self._stiffness > 0)):
            size = DIFFERENCE * (self._upper[j] - self._lower[j])
            size = size if kept[k, j] + size <= self._upper[j] else -size
            arrays.tensions[k, j] += size
            moved = take(state)
            if moved is not None:
                own = self._elements(motors, moved.state[loads], gravity)
                found[:, :, np.ravel_multi_index((k, j), slips.shape)] = (self._slips(own) - slips) / size
            arrays.tensions[:] = kept
        return found.reshape(slips.size, slips.size)

    def _taken(self, tensions: np.ndarray, slips: np.ndarray, motors: np.ndarray) -> float:
        """Work of friction on plastic slips in a step [J]: of its mean, or where it has turned, of its last force."""
        before, after = self._forces(self.now.tensions, self.now.motors), self._forces(tensions, motors)
        elastic = np.divide(after - before, self._stiffness, out=np.zeros_like(after), where=self._stiffness > 0)
        plastic = (slips - self.now.slips - elastic) * (self._stiffness > 0)
        mean = np.where(before * after > 0, (before + after) / 2, after)
        return float((mean * plastic).sum())


def _paths(model: TouchedRod) -> list[np.ndarray]:
    """Elements that each tension passes, from its plate to the motor, counted segment by segment, shapes (...,)."""
    rod = model.rod
    ends = np.cumsum([0, *map(len, rod.pieces)])
    order = [(segment, np.arange(ends[k], ends[k + 1])) for k, segment in reversed(list(enumerate(rod.segments)))]
    return [np.concatenate([own for segment, own in order if name in segment.names]) for name in rod.names]

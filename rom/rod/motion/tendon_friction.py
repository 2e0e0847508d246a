"""Friction of tendons in their guides while a finger moves.

The guide between element k and the next one towards the motor takes tau_k = T_k+1 - T_k of the tension. The slip s_k is
the sum of shortenings from the tendon's plate on. Coulomb's law with an elastic begin (Dahl 1968) is

    tau_k = tau_k0 + stiffness (s_k - s_k0),    -room <= tau_k <= room / exp(mu theta),
    room = T_k+1 (exp(mu theta) - 1) + c,

with the bounds of rod/guides.c and tau_k0, s_k0 of the last step. Tensions are those of the step's end. Newton's method
solves for them; differences measure how slips respond to tensions in a step.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.rod.compiled.motion import Stepped
from rom.rod.guides.guided_finger import GuidedFinger
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
        speeds: mean ones of the slips over the step, shape (n, t) [m/s].
        bends: of the elements, shape (n,) [rad].
        motors: tensions there, shape (t,) [N].
        dissipated: since the beginning [J].
    """

    tensions: np.ndarray
    slips: np.ndarray
    speeds: np.ndarray
    bends: np.ndarray
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
        ModelError: what `GuidedFinger` refuses, or no initial equilibrium.
    """

    def __init__(self, model: TouchedRod, point: np.ndarray, friction: float | Sequence[float], per_length: float):
        self._guided, t = GuidedFinger(model=model, friction=friction, per_length=per_length), len(model.rod.names)
        arrays = self._guided.arrays
        begun = arrays.motors.copy()
        for share in np.arange(1, 1 + INCREMENTS) / INCREMENTS:
            between = point.copy()
            between[:t] = begun + share * (point[:t] - begun)
            if self._guided.advance(between).status != "converged":
                raise ModelError(f"parameters must be where the finger can rest, got {point.tolist()}")
        arrays.rates[:] = np.eye(t)  # derivatives are by every element's own tensions
        self._next, self._beyond = _paths(model)
        self._passed = self._beyond.any(axis=1)
        self._lower, self._upper = np.array([[one.lower, one.upper] for one in model.rod.parameters]).T
        tensions, bends, slips, motors = (
            one.copy() for one in (arrays.tensions, arrays.bends, arrays.slips, arrays.motors)
        )
        self.now = Sliding(tensions, slips, np.zeros_like(slips), bends, motors, 0.0)
        self._kind: tuple[float, bool] | None = None  # of the steps whose response is known
        self._rubs = self._passed & ((arrays.friction > 0) | (arrays.drag > 0))
        self._response = np.zeros((self._rubs.size,) * 2)
        self._drag = self._between(arrays.drag)
        self._stiffness, self._soft = np.zeros(self._rubs.shape), np.ones(self._rubs.shape)

    def stick(self, take: Taken, state: np.ndarray) -> None:
        """Set the stiffness of guides that stick by steps that end at rest, from the initial equilibrium."""
        take(state)  # slips accurate to the tolerance of positions, not of an increment's tensions
        arrays = self._guided.arrays
        self.now = self.now._replace(slips=arrays.slips.copy(), bends=arrays.bends.copy())
        yielding = np.diag(self._measured(take, state, self.now.slips)).reshape(self._rubs.shape)
        np.divide(STIFF, np.abs(yielding), out=self._stiffness, where=self._rubs)

    @property
    def touching(self) -> Any:
        """For compiled code, a struct fingerfem_touching of which every element has its own tensions."""
        return self._guided.touching

    @property
    def loads(self) -> np.ndarray:
        """On all bodies in the initial equilibrium, shape (l,) [N, N m]."""
        return self._guided.arrays.loads

    def place(self) -> None:
        """Give the elements their tensions at the end of the last step."""
        self._guided.arrays.tensions[:] = self.now.tensions

    def advance(
        self, take: Taken, state: np.ndarray, loads: slice, motors: np.ndarray, kind: tuple[float, bool]
    ) -> Stepped | None:
        """A step to tensions at the motors; None without a solution: then tendons keep theirs.

        Args:
            take: the step from a state, with the elements' present tensions.
            state: where it begins, see `rom.rod.compiled.motion.Stepper`.
            loads: where a state has the loads on all bodies.
            motors: tensions, shape (t,) [N].
            kind: length of the step [s], and whether it ends at rest; steps of one kind have about the same response.
        """
        arrays, scale = self._guided.arrays, self._upper - self._lower
        tensions, slips, bends = self.now.tensions, self.now.slips + kind[0] * self.now.speeds, self.now.bends
        found: Stepped | None = None
        for k in range(STEPS):
            missing, matrix, slide, inside = self._equations(tensions, motors, slips, bends)
            change = np.linalg.solve(matrix, missing.ravel()).reshape(missing.shape)
            if found is not None and np.abs(change / scale).max() < SETTLED:
                taken = self._taken(tensions, slips, motors, slide)
                speeds = (slips - self.now.slips) / kind[0]
                self.now = Sliding(tensions, slips, speeds, bends, motors.copy(), self.now.dissipated + taken)
                return found._replace(inside=found.inside and inside)
            arrays.tensions[:] = tensions = self._held(tensions + change, motors)
            found = take(state)
            if found is None:
                break
            state, slips, bends = state.copy(), arrays.slips.copy(), arrays.bends.copy()
            state[loads] = found.state[loads]
            if self._rubs.any() and (k % RENEWED == RENEWED - 1 or self._kind != kind):
                self._kind, self._response = kind, self._measured(take, state, slips)
                self._soft = 1 + self._stiffness * self._compliances()
        self.place()
        return None

    def _held(self, tensions: np.ndarray, motors: np.ndarray) -> np.ndarray:
        """Tensions within their limits; of a tendon without friction that of its motor."""
        return np.where(self._rubs.any(axis=0), np.clip(tensions, self._lower, self._upper), motors)

    def _towards_motors(self, values: np.ndarray, motors: np.ndarray) -> np.ndarray:
        """Values of the next elements towards the motors, or those there, shape (n, t)."""
        return np.append(values, motors)[self._next]

    def _between(self, values: np.ndarray) -> np.ndarray:
        """Means of the values of each element and the next one towards the motor, whose value is 0, shape (n, t)."""
        own = self._passed * values
        return np.asarray(0.5 * (own + self._towards_motors(own, np.zeros(own.shape[1]))))

    def _equations(
        self, tensions: np.ndarray, motors: np.ndarray, slips: np.ndarray, bends: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
        """Equations of Newton's method. Guides stick or slip by the forces that would stop their plastic slip.

        Returns:
            tensions by the law less the present ones, shape (n, t) [N]; the derivative of minus these by the present
            ones, shape (n t, n t) [-]; true in guides that slip, shape (n, t); and whether all tensions are in the box.
        """
        arrays = self._guided.arrays
        behind = self._towards_motors(tensions, motors)
        grows = np.exp(self._between(arrays.friction * bends[:, None]))
        room = behind * (grows - 1) + self._drag
        elastic = self._forces(self.now.tensions, self.now.motors) + self._stiffness * (slips - self.now.slips)
        trial = behind - tensions + (elastic - behind + tensions) / self._soft
        pulled, let_out = trial > room / grows, trial < -room
        force = np.where(pulled, room / grows, np.where(let_out, -room, elastic))
        wanted = behind - force
        held = self._held(wanted, motors)
        gains = np.where(pulled, 1 / grows, np.where(let_out, grows, 1.0)) * (held == wanted)
        sticks = self._stiffness * (held == wanted) * ~(pulled | let_out)
        matrix = np.eye(slips.size) + sticks.reshape(-1, 1) * self._response
        rows = np.flatnonzero(self._next < slips.size)  # all but those at motors
        matrix[rows, self._next.flat[rows]] -= gains.flat[rows]
        inside = bool((wanted <= self._upper).all() and ((motors >= self._lower) & (motors <= self._upper)).all())
        return held - tensions, matrix, pulled | let_out, inside

    def _forces(self, tensions: np.ndarray, motors: np.ndarray) -> np.ndarray:
        """Forces of the guides, tau, shape (n, t) [N]."""
        return np.asarray(self._towards_motors(tensions, motors) - tensions)

    def _compliances(self) -> np.ndarray:
        """Slips of a tendon in a step through each guide by a unit of the guide's force, shape (n, t) [m/N]."""
        shape = self._rubs.shape  # tensions fall from the tip to the guide
        return np.maximum(np.einsum("klj,kjlj->kj", self._beyond, self._response.reshape(*shape, *shape)), 0.0)

    def _measured(self, take: Taken, state: np.ndarray, slips: np.ndarray) -> np.ndarray:
        """Derivatives of all slips in a step by all tensions, shape (n t, n t) [m/N]."""
        arrays = self._guided.arrays
        kept, found = arrays.tensions.copy(), np.zeros((*slips.shape, slips.size))
        for k, j in np.argwhere(self._rubs):
            size = DIFFERENCE * (self._upper[j] - self._lower[j])
            size = size if kept[k, j] + size <= self._upper[j] else -size
            arrays.tensions[k, j] += size
            if take(state) is not None:
                found[:, :, np.ravel_multi_index((k, j), slips.shape)] = (arrays.slips - slips) / size
            arrays.tensions[:] = kept
        return found.reshape(slips.size, slips.size)

    def _taken(self, tensions: np.ndarray, slips: np.ndarray, motors: np.ndarray, slide: np.ndarray) -> float:
        """Work of friction on plastic slips in a step [J]: of its mean, or where it has turned, of its last force."""
        before, after = self._forces(self.now.tensions, self.now.motors), self._forces(tensions, motors)
        elastic = np.divide(after - before, self._stiffness, out=np.zeros_like(after), where=self._rubs)
        plastic = (slips - self.now.slips - elastic) * slide
        mean = np.where(before * after > 0, (before + after) / 2, after)
        return float((mean * plastic).sum())


def _paths(model: TouchedRod) -> tuple[np.ndarray, np.ndarray]:
    """The elements behind each element of a tendon, and those from its plate to there.

    Elements are counted segment by segment, each from its plate.

    Returns:
        the place of the next tension towards the motor among those of all elements, then of the motors, shape (n, t);
        that of the motor where a tendon does not pass. Then true where an element is between the tendon's plate and
        another one, or is that one, shape (n, n, t).
    """
    rod = model.rod
    ends = np.cumsum([0, *map(len, rod.pieces)])
    order = [(segment, np.arange(ends[k], ends[k + 1])) for k, segment in reversed(list(enumerate(rod.segments)))]
    n, t = int(ends[-1]), len(rod.names)
    behind, beyond = np.tile(n * t + np.arange(t), (n, 1)), np.zeros((n, n, t), bool)
    for j, name in enumerate(rod.names):
        path = np.concatenate([own for segment, own in order if name in segment.names])
        behind[path[:-1], j] = path[1:] * t + j
        beyond[path[:, None], path, j] = np.tri(len(path), dtype=bool)
    return behind, beyond

"""Steps of time of a finger before objects, by compiled code (segment.h)."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of

MOVING = LIBRARY.constants.FINGERFEM_MOVING  # numbers of a body
BASE = LIBRARY.constants.FINGERFEM_BASE
MOST_BODIES = LIBRARY.constants.FINGERFEM_MOST_BODIES
MOST_BRANCHES = LIBRARY.constants.FINGERFEM_MOST_BRANCHES


@brief
class Stepped(NamedTuple):
    """End of a time step.

    Attributes:
        state: see `Stepper`.
        forces: mean over the step on every object against its direction, shape (m,) [N].
        energy: kinetic [J].
        inside: whether tensions, loads and contacts lie where the elements were trained.
    """

    state: np.ndarray
    forces: np.ndarray
    energy: float
    inside: bool


class Stepper:
    """Steps of one finger, in memory of its own.

    A state is one array: of every body 30 numbers, see segment.h; the loads on all bodies, those of contacts and of
    inertia, shape (6 bodies,) [N, N m]; then what relaxes in viscoelastic rubber; and what presses, a struct
    fingerfem_pressed.

    Args:
        touching: the finger and its objects, a struct fingerfem_touching.
        inertia: masses and their moments by the names in segment.h, see `rom.rod.motion.lumps.Lumps`.
        radius: spectral radius of the method for high frequencies [-].
        branches: of the rubber by the names in segment.h; None if it is elastic.
    """

    def __init__(
        self, touching: Any, inertia: Mapping[str, np.ndarray], radius: float, branches: Mapping[str, Any] | None = None
    ):
        chain, bodies, self.branches = touching.chain, len(inertia["masses"]), 0
        more: dict[str, Any] = {"radius": radius}
        if branches is not None:
            self.branches = len(branches["moduli"])
            more["branches"] = LIBRARY.struct("fingerfem_branches", count=self.branches, **branches)
        tensions = chain.tensions * (bodies if chain.guides else 1)
        self._bodies, relaxing = bodies, (6 * bodies + tensions) * (1 + self.branches) * bool(self.branches)
        self._touching = touching
        self._moves, self._rests = (
            LIBRARY.struct("fingerfem_inertia", **inertia, **more, rests=rests) for rests in (False, True)
        )
        ends = np.cumsum([bodies * MOVING, bodies * 6, relaxing])
        self._memory, self._state = memory_of(chain), np.zeros(ends[-1] + LIBRARY.ffi.sizeof("fingerfem_pressed") // 8)
        self._point, self._base = np.zeros(chain.tensions + touching.count), np.zeros(BASE)
        self._forces, self._energy, self._inside = np.zeros(touching.count), np.zeros(1), np.zeros(1, np.int32)
        self.loads = slice(*ends[:2])  # of a state, the loads on all bodies
        moving, loads, relaxing_of, pressed = map(pointer, np.split(self._state, ends))
        self._pressed = LIBRARY.ffi.cast("fingerfem_pressed *", pressed)
        results = pointer(self._forces), pointer(self._energy), pointer(self._inside, "int32_t[]"), self._pressed
        self._results = (self._memory, moving, relaxing_of, loads, *results)
        self._given, self._turned = pointer(self._point), pointer(self._base)

    def moving(self, state: np.ndarray) -> np.ndarray:
        """Motions of the bodies in a state, shape (bodies, 30), see FINGERFEM_MOVING in segment.h."""
        return state[: self._bodies * MOVING].reshape(-1, MOVING)

    def at_rest(self, point: np.ndarray, loads: np.ndarray) -> np.ndarray | None:
        """The state at rest at tensions and every d, shape (t + m,), by its loads; None without an answer."""
        state = np.zeros(len(self._state))
        state[self.loads] = loads
        found = self.step(state, point, np.inf, has_mass=False)
        return found.state if found else None

    def linearised(self, point: np.ndarray, loads: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Mass matrix, and motions of all bodies by wrenches, shapes (6 bodies, 6 bodies), about an equilibrium.

        Args:
            point: tensions and every d, shape (t + m,) [N, m].
            loads: on all bodies there [N, N m].

        Returns:
            None without an equilibrium.
        """
        matrices = np.empty((2, 6 * self._bodies, 6 * self._bodies))
        given = (np.array(one, float) for one in (point, loads))
        arguments = *map(pointer, given), self._memory, *map(pointer, matrices)
        known = LIBRARY.functions.fingerfem_linearise(self._touching, self._moves, *arguments)
        return (matrices[0], matrices[1]) if known else None

    def step(
        self,
        state: np.ndarray,
        point: np.ndarray,
        length: float,
        base: np.ndarray | None = None,
        has_mass: bool = True,
    ) -> Stepped | None:
        """A step [s] from a state to tensions and every d, shape (t + m,); None without an answer.

        Args:
            state: see above.
            point: [N, m].
            length: [s].
            base: how it moves at the step's end, shape (9,), see segment.h; None if it rests.
            has_mass: whether it has; else the step ends at rest.
        """
        self._state[:], self._point[:] = state, point
        turned = LIBRARY.ffi.NULL
        if base is not None:
            self._base[:], turned = base, self._turned
        evaluations = LIBRARY.functions.fingerfem_step(
            self._touching, self._moves if has_mass else self._rests, self._given, turned, length, *self._results
        )
        if evaluations <= 0:
            return None
        return Stepped(self._state.copy(), self._forces.copy(), float(self._energy[0]), bool(self._inside[0]))

"""A finger that moves: steps of time before rigid objects.

Elements are as compliant as at rest, and have the consistent mass of beams between their sections.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from rom.brief import brief
from rom.dataset.actuators import refuse_chambers
from rom.files.checked_file import ModelError
from rom.rod.compiled import memory_of
from rom.rod.compiled.motion import Stepped, at_rest, inertia_struct, step
from rom.rod.compiled.touched import touches
from rom.rod.motion.lumps import lumps_of
from rom.rod.touched_rod import TouchedRod
from rom.rod.weight import DENSEST

HALVINGS = 8  # of a step that finds no answer
ROUNDING = 1e-12  # of a step's length
SHORTEST = 1e-6  # step, in which the tolerance of positions makes a kinetic energy of a nJ or less [s]
RADIUS = 0.8  # spectral radius of the method for high frequencies [-]
Status = Literal["converged", "out_of_domain", "no_equilibrium"]


@brief
@dataclass(frozen=True, kw_only=True)
class MotionState:
    """Position and velocity of a finger at the end of a step.

    Attributes:
        status: `out_of_domain` where the elements were not trained; `no_equilibrium` if the step has no solution,
            however short: then the finger keeps its state from before the step, and numbers are nan.
        time: [s].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        velocity: of the tip plate's centre, shape (3,) [m/s].
        contact_forces: of every object against its direction, shape (m,) [N].
        kinetic_energy: [J].
    """

    status: Status
    time: float
    tip: np.ndarray
    velocity: np.ndarray
    contact_forces: np.ndarray
    kinetic_energy: float


class MovingFinger:
    """A finger before objects in steps of time, begun at rest.

    Args:
        model: the finger and its objects, without friction. Its weight acts if its scene has [gravity].
        parameters: tensions [N] and d [m] at which it rests, without contact, shape (t + m,).
        density: of the rubber [kg/m^3]; that of [gravity] if left out.
        plate_density: likewise of the plates.
        radius: spectral radius of the method for high frequencies, 0 to 1 [-]; 1 damps nothing.
        parts: into which interior elements are cut; more of them have more exact higher frequencies.

    Raises:
        ModelError: no density, no equilibrium to begin with, or more sections than compiled code holds.

    Example:
        >>> finger = rom.MovingFinger(rom.load(), [0.0, 0.0, 0.02], density=1100.0)
        >>> finger.step([20.0, 0.0, 0.02], 1e-3).tip
    """

    def __init__(
        self,
        model: TouchedRod,
        parameters: ArrayLike,
        density: float | None = None,
        plate_density: float | None = None,
        radius: float = RADIUS,
        parts: int = 1,
    ):
        refuse_chambers(model.rod.scene, "motion")
        weight = model.rod.scene.get("gravity") or {}
        density, plate_density = density or weight.get("density"), plate_density or weight.get("plate_density", 7850.0)
        if density is None:
            raise ModelError("density must be given [kg/m^3], as the scene has no [gravity], got none")
        for name, value in (("density", density), ("plate_density", plate_density)):
            if not 0 < value <= DENSEST:
                raise ModelError(f"{name} must be above 0 and at most {DENSEST:g} kg/m^3, got {value}")
        if not 0 <= radius <= 1:
            raise ModelError(f"radius must be from 0 to 1, got {radius}")
        if not isinstance(parts, int) or parts < 1:
            raise ModelError(f"parts must be an integer of at least 1, got {parts}")
        model = replace(model, rod=replace(model.rod, parts=parts))
        self.model, self.radius, self.time = model, radius, 0.0
        self.lumps = lumps_of(model.rod, density, plate_density)
        self._t = len(model.rod.names)
        self._compile()
        self._point = self._checked(parameters)
        begun = touches(model.touching, self._point[None])
        if not begun.inside[0]:
            raise ModelError(f"parameters must be where the finger can rest, got {self._point.tolist()}")
        moving = at_rest(model.touching.chain, self._point[: self._t], begun.loads[0])
        if moving is None:
            raise ModelError(f"a moving finger must have fewer sections, got {len(self.lumps.masses)}")
        self._moving, self._loads = moving, begun.loads[0]

    def _compile(self) -> None:
        self._inertia, self._memory = inertia_struct(*self.lumps), memory_of(self.model.touching.chain)

    def __getstate__(self) -> dict[str, Any]:
        """All but what compiled code reads."""
        return {name: one for name, one in vars(self).items() if name not in ("_inertia", "_memory")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._compile()

    def _checked(self, parameters: ArrayLike) -> np.ndarray:
        point = self.model.checked(parameters, most=1)
        if np.isnan(point).any() or np.isinf(point[: self._t]).any():
            raise ModelError(f"parameters must be numbers {', '.join(self.model.names)}, got {point.tolist()}")
        return point

    def step(self, parameters: ArrayLike, length: float) -> MotionState:
        """A step of time, in which tensions and distances change linearly; without a solution it is halved.

        Args:
            parameters: at its end, tensions [N] and d [m]; infinite where an object is away, shape (t + m,).
            length: [s].

        Raises:
            ModelError: another number of parameters, parameters that are not numbers, or a length below 1 µs.
        """
        goal = self._checked(parameters)
        if not SHORTEST <= length < np.inf:
            raise ModelError(f"length must be at least {SHORTEST:g} s, and finite, got {length}")
        begun, before = self.time, (self.time, self._moving, self._loads)
        found, ahead, inside = None, length, self._objects_in_range(goal)
        while self.time < begun + length * (1 - ROUNDING):
            ahead = min(ahead, begun + length - self.time)
            now = self._advance(self._parameters_at(goal, (self.time + ahead - begun) / length), ahead)
            if now is None:
                ahead /= 2
                if ahead < length / 2**HALVINGS:
                    self.time, self._moving, self._loads = before
                    return self._report(None)
                continue
            found, self.time, inside = now, self.time + ahead, inside and now.inside
        self._point = goal
        return self._report(found._replace(inside=inside) if found else None)

    def _objects_in_range(self, goal: np.ndarray) -> bool:
        """Whether objects are within their distances, or away."""
        lower, upper = (end[self._t :] for end in self.model.limits)
        d = goal[self._t :]
        return bool(((d == np.inf) | ((d >= lower) & (d <= upper))).all())

    def _parameters_at(self, goal: np.ndarray, share: float) -> np.ndarray:
        """Parameters at a share of the step [-]; an object that comes from away, or goes there, is there at once."""
        left = 1 - share
        if left <= ROUNDING:
            return goal
        both = np.isfinite(goal) & np.isfinite(self._point)
        return np.where(both, goal - left * np.where(both, goal - self._point, 0.0), goal)

    def _advance(self, point: np.ndarray, length: float) -> Stepped | None:
        found = step(
            self.model.touching, self._inertia, self._memory, point, length, self.radius, self._moving, self._loads
        )
        if found.evaluations <= 0:
            return None
        self._moving, self._loads = found.moving, found.loads
        return found

    def _report(self, found: Stepped | None) -> MotionState:
        last = self.model.rod.scene["geometry"]["segments"]
        tip = self._moving[len(last) - 1]
        if found is None:
            nothing = np.full(3, np.nan)
            return MotionState(
                status="no_equilibrium",
                time=self.time,
                tip=nothing,
                velocity=nothing,
                contact_forces=np.full(len(self.model.objects), np.nan),
                kinetic_energy=np.nan,
            )
        return MotionState(
            status="converged" if found.inside else "out_of_domain",
            time=self.time,
            tip=tip[:3] - self.model.rod.rest,
            velocity=tip[12:15],
            contact_forces=found.forces,
            kinetic_energy=found.energy,
        )

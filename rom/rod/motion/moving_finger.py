"""Motion of a finger in time steps, in contact with rigid objects, on a base that may move.

Elements have the compliance of their static laws, or viscoelastic branches, and the consistent mass of beams.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import eigh

from rom.dataset.actuators import refuse_chambers
from rom.dataset.rigid_motion import BaseMotion
from rom.files.checked_file import ModelError
from rom.rod.compiled.motion import MOST_BODIES, Stepped, Stepper
from rom.rod.compiled.touched import touches
from rom.rod.motion.base import RESTING, Base, checked
from rom.rod.motion.branches import branches_of
from rom.rod.motion.lumps import lumps_of
from rom.rod.motion.motion_state import MotionState
from rom.rod.motion.tendon_friction import TendonFriction
from rom.rod.scene.materials_of_rod import DENSEST
from rom.rod.shape import placed
from rom.rod.touched_rod import TouchedRod

HALVINGS = 8  # largest number for a step without a solution
ROUNDING = 1e-12  # relative error of a step's length [-]
SHORTEST = 1e-6  # shortest step, in which the tolerance of positions is a kinetic energy of at most a nJ [s]
LONG = 1.0  # step at rest in which the response of tendons that stick is measured [s]
RADIUS = 0.8  # spectral radius of the method for high frequencies [-]


class MovingFinger:
    """A finger with frictionless objects, which moves in time steps from an equilibrium.

    Args:
        model: the finger and its objects. Weight acts if the scene has [gravity], and rubber relaxes if the scene has
            `material.prony`; all branches are relaxed initially.
        parameters: tensions [N] and d [m] of the initial equilibrium, shape (t + m,).
        density: of the rubber [kg/m^3]; by default that of [gravity].
        plate_density: likewise of the plates.
        radius: spectral radius of the method for high frequencies, 0 to 1 [-]; 1 has no damping. Rubber in contact is
            such a spring, too. A plate does not rebound by itself.
        parts: number of parts of every interior element; more parts increase the accuracy of higher frequencies.
        friction: of the tendons in their guides, as of `rom.GuidedFinger` [-]; None: a tendon has one tension. Motors
            have reached the initial tensions from rest together.
        per_length: friction besides [N/m].

    Raises:
        ModelError: no density, no initial equilibrium, or more sections than compiled code supports.

    Example:
        >>> finger = rom.MovingFinger(rom.load(), [0.0, 0.0, 0.02], density=1100.0)
        >>> finger.step([20.0, 0.0, 0.02], 1e-3).tip

    At small strain, relaxation is exact for stretch, bending and twist; shear across the finger relaxes like bending.
    Indentation and the surface between sections are those of relaxed rubber.
    """

    def __init__(
        self,
        model: TouchedRod,
        parameters: ArrayLike,
        density: float | None = None,
        plate_density: float | None = None,
        radius: float = RADIUS,
        parts: int = 1,
        friction: float | Sequence[float] | None = None,
        per_length: float = 0.0,
    ):
        refuse_chambers(model.rod.scene, "motion")
        weight = model.rod.scene.get("gravity") or {"direction": [0.0, -1.0, 0.0], "acceleration": 0.0}
        density = weight.get("density") if density is None else density
        plate_density = weight.get("plate_density", 7850.0) if plate_density is None else plate_density
        if density is None:
            raise ModelError("density must be given [kg/m^3], as the scene has no [gravity], got none")
        for name, value in (("density", density), ("plate_density", plate_density)):
            if not 0 < value <= DENSEST:
                raise ModelError(f"{name} must be above 0 and at most {DENSEST:g} kg/m^3, got {value}")
        if not 0 <= radius <= 1:
            raise ModelError(f"radius must be from 0 to 1, got {radius}")
        if not isinstance(parts, int) or parts < 1:
            raise ModelError(f"parts must be an integer of at least 1, got {parts}")
        gravity = weight | {"density": density, "plate_density": plate_density}  # masses for a base that moves, too
        if (model.rod.parts, model.rod.scene.get("gravity")) != (parts, gravity):
            model = replace(model, rod=replace(model.rod, parts=parts, scene=model.rod.scene | {"gravity": gravity}))
        self.model, self.radius, self.time = model, radius, 0.0
        self.lumps = lumps_of(model.rod, density, plate_density)
        self._t = len(model.rod.names)
        self._base: Base | None = None  # moves once it is given a motion
        self._ranges = np.array([one.distances for one in model.objects]).tolist()
        self._point = self._checked(parameters)
        self._friction: TendonFriction | None = None
        if friction is None:
            begun = touches(model.touching, self._point[None])
            if not begun.inside[0]:
                raise ModelError(f"parameters must be where the finger can rest, got {self._point.tolist()}")
            loads = begun.loads[0]
        else:
            self._friction = TendonFriction(model, self._point, friction, per_length)
            loads = self._friction.loads
        self._compile()
        if len(self.lumps.masses) > MOST_BODIES:
            raise ModelError(f"a moving finger must have fewer sections, got {len(self.lumps.masses)}")
        state = self._stepper.at_rest(self._point, loads)
        if state is None:
            raise ModelError(f"parameters must be where the finger can rest, got {self._point.tolist()}")
        self._state = state
        if self._friction is not None:
            self._friction.stick(lambda begun: self._stepper.step(begun, self._point, LONG, has_mass=False), state)

    def _compile(self) -> None:
        branches = branches_of(self.model.rod)
        touching = self.model.touching if self._friction is None else self._friction.touching
        self._stepper = Stepper(touching, self.lumps._asdict(), self.radius, branches)
        self._rest, self._tip = self.model.rod.rest, len(self.model.rod.scene["geometry"]["segments"]) - 1
        self._gravity = np.array(list(self.model.touching.chain.gravity))

    def __getstate__(self) -> dict[str, Any]:
        """All but what compiled code reads."""
        return {name: one for name, one in vars(self).items() if name != "_stepper"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._compile()

    def _checked(self, parameters: ArrayLike) -> np.ndarray:
        point = self.model.checked(parameters, most=1)
        given = point.tolist()
        if not all(value > -np.inf for value in given) or np.inf in given[: self._t]:
            raise ModelError(f"parameters must be numbers {', '.join(self.model.names)}, got {given}")
        return point

    def step(
        self, parameters: ArrayLike, length: float, base: BaseMotion | None = None, at_rest: bool = False
    ) -> MotionState:
        """Advance by a time step with linear changes of parameters and base motion; halve it without a solution.

        Args:
            parameters: tensions [N] and d [m] at its end, shape (t + m,); an infinite d removes the object.
            length: of the step [s].
            base: motion of the base at the step's end; None for a base at rest. Objects move with the base.
            at_rest: whether the step has no inertia and ends at rest, for long steps of creep.

        Raises:
            ModelError: another number of parameters, parameters that are not numbers, or a length below 1 µs.
        """
        goal = self._checked(parameters)
        if not SHORTEST <= length < np.inf:
            raise ModelError(f"length must be at least {SHORTEST:g} s, and finite, got {length}")
        if base is not None and self._base is None:
            self._base = Base(RESTING, np.eye(3))
        moves = RESTING if base is None else checked(base)
        begun, before = self.time, (self.time, self._state, self._base)
        slid = None if self._friction is None else self._friction.now
        found, ahead, inside = None, length, self._objects_in_range(goal)
        while self.time < begun + length * (1 - ROUNDING):
            ahead = min(ahead, begun + length - self.time)
            share = (self.time + ahead - begun) / length
            left = begun + length - self.time
            base_after = None if self._base is None else self._base.after(moves, min(ahead / left, 1.0), ahead)
            now = None
            if self._base is None or base_after is not None:
                now = self._advance(self._parameters_at(goal, share), base_after, ahead, at_rest)
            if now is None:
                ahead /= 2
                if ahead < length / 2**HALVINGS:
                    self.time, self._state, self._base = before
                    if self._friction is not None and slid is not None:
                        self._friction.now = slid
                    return self._report(None)
                continue
            found, self.time, inside = now, self.time + ahead, inside and now.inside
        self._point = goal
        return self._report(found, inside)

    def frequencies(self, parameters: ArrayLike, count: int = 3) -> np.ndarray:
        """Return natural frequencies about the relaxed equilibrium, shape (count,) [Hz].

        Contacts that press stay closed, without friction; all others stay open. Compressed sections are wider than at
        rest, by which twist is slower.

        Args:
            parameters: tensions [N] and d [m] as of `step`, shape (t + m,), or tensions alone, without objects.
            count: at most six for every plate and every section between elements.

        Raises:
            ModelError: the wrong number of parameters or frequencies, no stable equilibrium in the elements' domain, or
                friction of tendons.
        """
        if self._friction is not None:
            raise ModelError("friction of tendons must be left out for frequencies: a guide that slips has none")
        given = np.ravel(parameters)
        away = np.full(len(self._ranges), np.inf)
        point = self._checked(np.append(given, away) if given.shape == (self._t,) else given)
        most = 6 * len(self.lumps.masses)
        if not 0 < count <= most:
            raise ModelError(f"count must be from 1 to {most}, got {count}")
        begun = touches(self.model.touching, point[None])
        found = self._stepper_at(point, begun.loads[0]).linearised(point, begun.loads[0]) if begun.inside[0] else None
        if found is None:
            raise ModelError(f"parameters must have a stable equilibrium in the domain, got {given.tolist()}")
        mass, compliance = found  # D M f = f / w^2; D is singular along closed contacts
        squares = eigh((compliance + compliance.T) / 2, mass, type=2, eigvals_only=True)[::-1][:count]
        if squares[-1] <= 0:
            raise ModelError(f"count must be at most {(squares > 0).sum()} with these contacts, got {count}")
        return np.asarray(1 / (2 * np.pi * np.sqrt(squares)))

    def _stepper_at(self, point: np.ndarray, loads: np.ndarray) -> Stepper:
        """A stepper with sections as wide as at tensions and loads of an equilibrium."""
        rod = self.model.rod
        stretches = [one.stretch for one in placed(rod, point[: self._t], loads)]
        gravity = rod.scene["gravity"]
        lumps = lumps_of(rod, gravity["density"], gravity["plate_density"], stretches)
        return Stepper(self.model.touching, lumps._asdict(), self.radius)

    @property
    def element_tensions(self) -> np.ndarray:
        """Tensions along the finger, segment by segment, each from its plate to its clamp, shape (n, t) [N]."""
        if self._friction is not None:
            return self._friction.now.tensions.copy()
        return np.tile(self._point[: self._t], (sum(map(len, self.model.rod.pieces)), 1))

    def _objects_in_range(self, goal: np.ndarray) -> bool:
        """True if objects are within their distances, or away."""
        given = zip(goal[self._t :].tolist(), self._ranges, strict=True)
        return all(d == np.inf or nearest <= d <= farthest for d, (nearest, farthest) in given)

    def _parameters_at(self, goal: np.ndarray, share: float) -> np.ndarray:
        """Parameters at a share of the step [-]; an object that comes from away, or goes there, is there at once."""
        left = 1 - share
        if left <= ROUNDING:
            return goal
        both = np.isfinite(goal) & np.isfinite(self._point)
        return goal - left * np.subtract(goal, self._point, out=np.zeros_like(goal), where=both)

    def _advance(self, point: np.ndarray, base: Base | None, length: float, at_rest: bool) -> Stepped | None:
        given = None if base is None else base.numbers(self._gravity)

        def take(state: np.ndarray) -> Stepped | None:
            return self._stepper.step(state, point, length, given, has_mass=not at_rest)

        if self._friction is None:
            found = take(self._state)
        else:
            kind = round(length, 9), at_rest
            found = self._friction.advance(take, self._state, self._stepper.loads, point[: self._t], kind)
        if found is not None:
            self._state, self._base = found.state, base
        return found

    def _report(self, found: Stepped | None, inside: bool = False) -> MotionState:
        tip = self._stepper.moving(self._state)[self._tip]
        if found is None:
            nothing = np.full(3, np.nan)
            return MotionState(
                status="no_equilibrium",
                time=self.time,
                tip=nothing,
                velocity=nothing,
                contact_forces=np.full(len(self._ranges), np.nan),
                kinetic_energy=np.nan,
                dissipated=np.nan,
            )
        return MotionState(
            status="converged" if inside else "out_of_domain",
            time=self.time,
            tip=tip[:3] - self._rest,
            velocity=tip[12:15].copy(),
            contact_forces=found.forces,
            kinetic_energy=found.energy,
            dissipated=0.0 if self._friction is None else self._friction.now.dissipated,
        )

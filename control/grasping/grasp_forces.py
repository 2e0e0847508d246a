"""Contact forces that neither drop an object nor crush it, or why there are none.

Fingers evenly around an object press on it inwards; friction carries its weight. With contact forces N_i along -e_i and
friction forces of at most mu N_i in the faces they press on, forces and moments on the object must balance: a linear
programme, with the friction cone replaced by a polygon inside it (so that what is found holds in the cone).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from rom.brief import brief

GRAVITY = 9.80665  # [m/s^2]
SIDES = 32  # of the polygon inside the friction circle


@dataclass(frozen=True, kw_only=True)
class Object:
    """What is to be held, by its middle.

    Attributes:
        mass: [kg].
        friction: coefficient between it and the fingers [-].
        admissible_force: of one finger, above which it is crushed [N].
        lean: most that its faces may lean from what fingers press along, any way [rad]: it takes as much from the
            angle of friction.
        down: direction of gravity in the gripper's axes: along the fingers to their tips, then the plane of
            Gripper.directions; shape (3,) [-].
    """

    mass: float
    friction: float
    admissible_force: float
    down: tuple[float, float, float] = (1.0, 0.0, 0.0)
    lean: float = 0.0

    def __post_init__(self) -> None:
        for name in ("mass", "friction", "admissible_force"):
            if not 0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be above 0, got {getattr(self, name)}")
        if np.shape(self.down) != (3,) or not np.isfinite(self.down).all() or not np.any(self.down):
            raise ValueError(f"down must be a direction, three finite numbers that are not all 0, got {self.down}")
        if not 0 <= self.lean <= np.pi / 2:
            raise ValueError(f"lean must be from 0 to a right angle, got {self.lean}")

    @property
    def weight(self) -> float:
        """Its weight [N]."""
        return self.mass * GRAVITY

    @property
    def grip(self) -> float:
        """Friction that is left, however its faces lean [-]; 0 if none is."""
        return float(np.tan(max(np.arctan(self.friction) - self.lean, 0.0)))


@brief
@dataclass(frozen=True, kw_only=True)
class Targets:
    """Contact forces for an object.

    Attributes:
        contact_forces: of every finger, shape (fingers,) [N]; nan if there are none.
        least: what the hardest pressing finger needs so that the object is not dropped [N]; inf if nothing holds it.
        most: what none may exceed so that it is not crushed [N].
        reason: why there are none; empty if there are.
    """

    contact_forces: np.ndarray
    least: float
    most: float
    reason: str = ""

    @property
    def exist(self) -> bool:
        """Whether there are any."""
        return not self.reason


def targets(directions: np.ndarray, held: Object, margin: float = 0.1) -> Targets:
    """Contact forces that hold an object as far as possible, in ratio, from dropping and from crushing it.

    Args:
        directions: of the fingers from the object's middle, evenly around, shape (fingers, 2) [-].
        held: the object.
        margin: on both sides, that forces may be off [-].
    """
    if not 0 <= margin < np.inf:
        raise ValueError(f"margin must be at least 0, got {margin}")
    most, nothing = held.admissible_force, np.full(len(directions), np.nan)
    if held.grip == 0:
        reason = f"faces that may lean by {np.degrees(held.lean):.3g} degrees slip at a friction of {held.friction:.3g}"
        return Targets(contact_forces=nothing, least=np.inf, most=most, reason=reason)
    least, pattern = _least(directions, held)
    if not np.isfinite(least):
        return Targets(contact_forces=nothing, least=least, most=most, reason="no contact forces balance its weight")
    if least * (1 + margin) ** 2 > most:
        reason = (
            f"{held.mass:g} kg at a friction of {held.friction:g} drop below {least:.3g} N a finger, but are crushed "
            f"above {most:.3g} N: forces may be off by {margin:.0%}"
        )
        return Targets(contact_forces=nothing, least=least, most=most, reason=reason)
    if len(directions) < 2:
        return Targets(contact_forces=pattern, least=least, most=most)
    # Equal forces evenly around balance each other, whatever is added.
    return Targets(contact_forces=pattern + (np.sqrt(least * most) - least), least=least, most=most)


def carries(directions: np.ndarray, held: Object, contact_forces: np.ndarray) -> bool:
    """Whether friction at these contact forces, shape (fingers,) [N], carries the object."""
    system, right, cone = _balance(directions, held)
    n = len(directions)
    found = linprog(
        np.zeros(3 * n),
        A_ub=cone,
        b_ub=np.zeros(len(cone)),
        A_eq=np.vstack([system, np.eye(n, 3 * n)]),
        b_eq=np.concatenate([right, np.asarray(contact_forces, float) / held.weight]),
        bounds=(None, None),
    )
    return bool(found.status == 0)


def _least(directions: np.ndarray, held: Object) -> tuple[float, np.ndarray]:
    """The least largest contact force that carries the object [N], and all of them, shape (fingers,) [N]."""
    system, right, cone = _balance(directions, held)
    n = len(directions)
    aim = np.zeros(3 * n + 1)
    aim[-1] = 1.0
    below = np.hstack([np.eye(n, 3 * n), np.full((n, 1), -1.0)])
    found = linprog(
        aim,
        A_ub=np.vstack([np.hstack([cone, np.zeros((len(cone), 1))]), below]),
        b_ub=np.zeros(len(cone) + n),
        A_eq=np.hstack([system, np.zeros((len(system), 1))]),
        b_eq=right,
        bounds=[(0, None)] * n + [(None, None)] * (2 * n + 1),
    )
    if found.status != 0:
        return float("inf"), np.full(n, np.nan)
    return held.weight * float(found.x[-1]), held.weight * np.asarray(found.x[:n])


def _balance(directions: np.ndarray, held: Object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Balance of forces and moments, A x = b, friction, C x <= 0; x: contact, axial, tangential forces by weight."""
    n = len(directions)
    down = np.asarray(held.down, float) / np.abs(held.down).max()
    down /= np.linalg.norm(down)
    none, across = np.zeros(n), np.column_stack([-directions[:, 1], directions[:, 0]])
    forces = [
        np.concatenate([none, np.ones(n), none]),
        *(np.concatenate([-directions[:, a], none, across[:, a]]) for a in (0, 1)),
    ]
    moments = [np.concatenate([none, none, np.ones(n)])]
    moments += [np.concatenate([none, directions[:, a], none]) for a in (0, 1)]
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    inner = held.grip * np.cos(np.pi / SIDES)
    cone = [
        np.concatenate([-inner * np.eye(n)[i], np.cos(angle) * np.eye(n)[i], np.sin(angle) * np.eye(n)[i]])
        for i in range(n)
        for angle in angles
    ]
    return np.array(forces + moments), np.concatenate([-down, np.zeros(3)]), np.array(cone)

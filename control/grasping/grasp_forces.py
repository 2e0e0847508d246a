"""Contact forces that neither drop an object nor crush it, or why there are none.

Fingers evenly around an object press on it inwards; friction carries its weight. With contact forces N_i along -e_i and
friction forces of at most mu N_i in the faces they press on, forces and moments on the object must balance: a linear
programme, with the friction cone replaced by a polygon inside it (so that what is found holds in the cone).

Faces that lean change directions of contact forces. If the pose is uncertain, an object has several cases of faces:
the contact forces, and all between them and the bounds, balance the weight in every case.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linprog

from rom.brief import brief

GRAVITY = 9.80665  # [m/s^2]
HARDEST = 1000.0  # largest contact force over the weight that is looked at, beyond the admissible one [-]
SIDES = 32  # of the polygon inside the friction circle


@brief
@dataclass(frozen=True, kw_only=True)
class Object:
    """Object to be held by its middle.

    Attributes:
        mass: [kg].
        friction: coefficient between it and the fingers [-].
        admissible_force: of one finger, above which it is crushed [N].
        faces: inward unit normals of the faces that fingers touch, in axes of `down`, for every case of an uncertain
            pose, shape (cases, fingers, 3) [-]; None where they face the fingers.
        down: direction of gravity in the gripper's axes: along the fingers to their tips, then the plane of
            Gripper.directions; shape (3,) [-].
    """

    mass: float
    friction: float
    admissible_force: float
    down: tuple[float, float, float] = (1.0, 0.0, 0.0)
    faces: np.ndarray | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        for name in ("mass", "friction", "admissible_force"):
            if not 0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be above 0, got {getattr(self, name)}")
        if np.shape(self.down) != (3,) or not np.isfinite(self.down).all() or not np.any(self.down):
            raise ValueError(f"down must be a direction, three finite numbers that are not all 0, got {self.down}")
        if self.faces is not None and (np.ndim(self.faces) != 3 or not np.isfinite(self.faces).all()):
            raise ValueError(f"faces must be finite, of shape (cases, fingers, 3), got shape {np.shape(self.faces)}")

    @property
    def weight(self) -> float:
        """Its weight [N]."""
        return self.mass * GRAVITY


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
        """True if there are such forces."""
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
    straight = straight_faces(directions)
    least, pattern = _least(directions, straight, held)
    if not np.isfinite(least):
        return Targets(contact_forces=nothing, least=least, most=most, reason="no contact forces balance its weight")
    if held.faces is not None:
        if np.shape(held.faces)[1:] != straight.shape:
            raise ValueError(f"faces must be of {len(directions)} fingers, got shape {np.shape(held.faces)}")
        touched = (np.einsum("kij,ij->ki", held.faces, straight) > 0).all()
        highest = most + HARDEST * held.weight
        ends = list[tuple[float, float]]()
        for one in held.faces if touched else ():
            ends.append(_added(directions, one, held, pattern, highest))
            if np.isnan(ends[-1]).any():
                break
        added = np.array(ends)
        if not (touched and np.isfinite(added).all() and added[:, 0].max() <= added[:, 1].min()):
            slips = "no contact forces balance its weight on all faces that fingers may touch"
            return Targets(contact_forces=nothing, least=np.inf, most=most, reason=slips)
        most = min(most, least + float(added[:, 1].min()))
        least, pattern = least + float(added[:, 0].max()), pattern + added[:, 0].max()
    if least * (1 + margin) ** 2 > most:
        fate = "crushed" if most == held.admissible_force else "pushed out"
        reason = (
            f"{held.mass:g} kg at a friction of {held.friction:g} drop below {least:.3g} N a finger, but are {fate} "
            f"above {most:.3g} N: forces may be off by {margin:.0%}"
        )
        return Targets(contact_forces=nothing, least=least, most=most, reason=reason)
    if len(directions) < 2:
        return Targets(contact_forces=pattern, least=least, most=most)
    # Equal forces evenly around balance each other, whatever is added.
    return Targets(contact_forces=pattern + (np.sqrt(least * most) - least), least=least, most=most)


def straight_faces(directions: np.ndarray) -> np.ndarray:
    """Return inward normals of faces that face fingers from directions, shape (fingers, 2); shape (fingers, 3) [-]."""
    return np.column_stack([np.zeros(len(directions)), -directions])


def carries(directions: np.ndarray, held: Object, contact_forces: np.ndarray) -> bool:
    """True if friction at these contact forces, shape (fingers,) [N], carries the object in all cases of its faces."""
    cases = [straight_faces(directions)] if held.faces is None else list(held.faces)
    return all(np.isfinite(_added(directions, one, held, contact_forces, 0.0)[0]) for one in cases)


def _added(
    directions: np.ndarray, faces: np.ndarray, held: Object, pattern: np.ndarray, most: float
) -> tuple[float, float]:
    """Least and most, up to +-most, that may be added to all contact forces of a pattern [N]; nan if nothing may."""
    system, right, cone = _balance(directions, faces, held)
    n, weight = len(directions), held.weight
    # Contact forces are pattern + added: their columns become one.
    merged = [np.hstack([one[:, :n].sum(axis=1, keepdims=True), one[:, n:]]) for one in (system, cone)]
    given = [one[:, :n] @ np.asarray(pattern, float) / weight for one in (system, cone)]
    bounds = [(max(-most, -float(np.min(pattern))) / weight, most / weight)] + [(None, None)] * (2 * n)
    ends = list[float]()
    for sign in (1.0, -1.0):
        found = linprog(
            np.concatenate([[sign], np.zeros(2 * n)]),
            A_ub=merged[1],
            b_ub=-given[1],
            A_eq=merged[0],
            b_eq=right - given[0],
            bounds=bounds,
        )
        ends.append(sign * float(found.fun) * weight if found.status == 0 else np.nan)
    return ends[0], ends[1]


def _least(directions: np.ndarray, faces: np.ndarray, held: Object) -> tuple[float, np.ndarray]:
    """The least largest contact force that carries the object [N], and all of them, shape (fingers,) [N]."""
    system, right, cone = _balance(directions, faces, held)
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


def _balance(directions: np.ndarray, faces: np.ndarray, held: Object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Balance of forces and moments, A x = b, friction, C x <= 0; x: contact, axial, tangential forces by weight.

    Faces are inward normals, shape (fingers, 3). Friction acts along two directions in each face: one without part
    across the finger, and one horizontal where the fingers point down.
    """
    n = len(directions)
    down = np.asarray(held.down, float) / np.abs(held.down).max()
    down /= np.linalg.norm(down)
    sideways = np.column_stack([np.zeros(n), faces[:, 2], -faces[:, 1]])
    sideways /= np.linalg.norm(sideways, axis=1)[:, None]
    axes = faces, np.cross(faces, sideways), sideways
    # forces of x along the axis and in the plane, shape (3, 3 n)
    forces = np.array([np.concatenate([axis[:, a] for axis in axes]) for a in range(3)])
    x, y = (np.tile(directions[:, a], 3) for a in (0, 1))
    moments = [x * forces[2] - y * forces[1], x * forces[0], y * forces[0]]
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    inner = held.friction * np.cos(np.pi / SIDES)
    one_each, circle = np.eye(n), (np.cos(angles)[:, None], np.sin(angles)[:, None])
    parts = [-inner * np.ones((SIDES, 1)), *circle]
    cone = np.hstack([np.kron(one_each, part) for part in parts])
    return np.vstack([forces, moments]), np.concatenate([-down, np.zeros(3)]), cone

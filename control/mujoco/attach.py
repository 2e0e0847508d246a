"""A finger as bodies of a MuJoCo model: a plate at every segment's end, free to move before the one it is held by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from control.mujoco import keyframes
from control.mujoco.rod import CLAMP_SECTIONS, END_SECTIONS, Beam, Lump, united
from rom import Rod
from rom.brief import brief

STIFF = (0.999, 0.9999, 1e-5, 0.5, 2.0)  # impedance of contacts: MuJoCo's own gives way by millimetres
FAST = 2.0  # time constant of contacts, in steps: MuJoCo's least
# Of bodies that overlap by micrometres MuJoCo misses the contact now and then. So a plate is a box smaller by this all
# round [m], and touches what is as near.
MARGIN = 3e-6

# Whatever a model's defaults are for others.
FREE = {"damping": 0.0, "stiffness": 0.0, "armature": 0.0, "frictionloss": 0.0, "limited": 0, "actfrclimited": 0}
TOUCHES = {"contype": 1, "conaffinity": 1, "condim": 3, "priority": 0, "gap": 0.0}


@brief
@dataclass(frozen=True)
class Attached:
    """A finger in a MuJoCo model.

    Attributes:
        name: of it; its bodies' names begin so.
        rod: what it is assembled from.
        clamp: name of the body that its first segment stands on.
        plates: names of its plates' bodies, from clamp to tip.
        rubbers: names of the geoms that distances of the rubber are measured with.
        joints: names of the joints of every plate: three slides along the axes of what holds it, and a ball.
        relaxation: of the rubber [s]: a force on a plate that moves is as much larger as it would be so much later.
        beams: mass and length of the rubber of every segment.
    """

    name: str
    rod: Rod
    clamp: str
    plates: tuple[str, ...]
    rubbers: tuple[str, ...]
    joints: tuple[tuple[str, ...], ...]
    relaxation: float
    beams: tuple[Beam, ...]

    @property
    def elements(self) -> list[tuple[mujoco.mjtObj, str]]:
        """Types and names of all that it has in the model."""
        kinds = mujoco.mjtObj
        bodies = [(kinds.mjOBJ_BODY, one) for one in (self.clamp, *self.plates)]
        joints = [(kinds.mjOBJ_JOINT, one) for names in self.joints for one in names]
        return [
            *bodies,
            *joints,
            *((kinds.mjOBJ_GEOM, one) for one in (*self.plates, *self.rubbers)),
        ]

    def renamed(self, prefix: str = "", suffix: str = "") -> Attached:
        """The same finger, whose model is part of another: `spec.attach(hand, prefix=..., suffix=...)`.

        Example:
            >>> arm.attach(hand, prefix="left/", site="flange")
            >>> simulation = Simulation(arm.compile(), [finger.renamed(prefix="left/") for finger in fingers])
        """

        def new(names: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(f"{prefix}{name}{suffix}" for name in names)

        name, clamp = new((self.name, self.clamp))
        plates, rubbers, joints = new(self.plates), new(self.rubbers), tuple(map(new, self.joints))
        return replace(self, name=name, clamp=clamp, plates=plates, rubbers=rubbers, joints=joints)


def attach(
    spec: mujoco.MjSpec,
    rod: Rod,
    palm: str,
    position: ArrayLike = (0.0, 0.0, 0.0),
    quaternion: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    name: str = "finger",
    relaxation: float = 0.005,
    density: float = 1100.0,
    friction: float = 0.0,
) -> Attached:
    """Mount a finger on a body of a model that is not compiled yet.

    Args:
        spec: the model.
        rod: the finger; MuJoCo's gravity acts on it, and its scene's [gravity] does not.
        palm: name of the body that holds it; "world" for none.
        position: of the clamp's middle on that body [m].
        quaternion: of the clamp, w first: x is the finger's axis, y points to what it bends towards.
        name: of the finger, of its own in the model.
        relaxation: of the rubber [s], its damping over its stiffness (Kelvin-Voigt); 5 ms by default.
        density: of rubber and plates [kg/m^3].
        friction: of the plates [-]. MuJoCo takes the larger of both sides': with 0 the object's counts.

    Raises:
        ValueError: no such body, a name that is in use, a keyframe of another size, numbers that cannot be, or a
            tapered finger, whose mass is not modelled.

    Example:
        >>> spec = mujoco.MjSpec.from_file("hand.xml")
        >>> finger = attach(spec, Rod.load("finger.h5"), "palm", position=(0.025, 0.0, 0.0))
        >>> simulation = Simulation(spec.compile(), [finger])
    """
    parent = spec.body(palm)
    if parent is None:
        raise ValueError(f"palm must be a body of the model, got {palm!r}")
    if taper := rod.scene["geometry"].get("taper"):
        raise ValueError(f"rod must be a finger without taper, as its mass in MuJoCo is that of one, got {taper}")
    place, turned = np.asarray(position, float), np.asarray(quaternion, float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ValueError(f"position must be three lengths [m], got {place.tolist()}")
    if turned.shape != (4,) or not (np.isfinite(turned).all() and turned.any()):
        raise ValueError(f"quaternion must be four numbers, not all 0, got {turned.tolist()}")
    for what, value, least in (
        ("relaxation", relaxation, relaxation >= 0),
        ("density", density, density > 0),
        ("friction", friction, friction >= 0),
    ):
        if not (least and np.isfinite(value)):
            raise ValueError(f"{what} must be a number that is not negative, the density above 0, got {value}")
    finger = _named(name, rod, relaxation, density)
    _require_free(spec, finger)
    keyframes.check(spec)
    body = parent.add_body(name=finger.clamp, pos=place, quat=turned / np.linalg.norm(turned))
    _weigh(body, [finger.beams[0].clamp(0.0)], finger.beams[0].mass * CLAMP_SECTIONS * _sections(finger))
    for k in range(len(finger.plates)):
        body = _add_plate(body, finger, k, density)
        _add_geoms(body, finger, k, friction, spec.option.timestep)
    keyframes.insert(spec, finger.clamp, len(finger.plates))
    return finger


def _named(name: str, rod: Rod, relaxation: float, density: float) -> Attached:
    """A finger with the names and masses of its parts."""
    half = rod.half_lengths
    lengths = [length - 2 * half[0] for length in rod.scene["geometry"]["segments"]]
    plates = tuple(f"{name} plate {k}" for k in range(len(lengths)))
    return Attached(
        name=name,
        rod=rod,
        clamp=f"{name} clamp",
        plates=plates,
        rubbers=tuple(f"{plate} rubber" for plate in plates),
        joints=tuple(tuple(f"{plate} {kind}" for kind in ("x", "y", "z", "turn")) for plate in plates),
        relaxation=relaxation,
        beams=tuple(Beam(4 * density * half[1] * half[2] * length, length) for length in lengths),
    )


def _require_free(spec: mujoco.MjSpec, finger: Attached) -> None:
    """Raise if the model has an element of a name already."""
    for kind, one in finger.elements:
        if getattr(spec, kind.name.removeprefix("mjOBJ_").lower())(one) is not None:
            raise ValueError(
                f"name must be free in the model, got {finger.name!r} where {one!r} exists: give another name"
            )


def _sections(finger: Attached) -> np.ndarray:
    """Moments of the rubber's sections about x, y, z over its mass, shape (3,) [m^2]."""
    _, y, z = finger.rod.half_lengths**2 / 3
    return np.array([y + z, z, y])


def _add_plate(parent: mujoco.MjsBody, finger: Attached, k: int, density: float) -> mujoco.MjsBody:
    """Add plate k of a finger, which moves before its parent."""
    half, beam = finger.rod.half_lengths, finger.beams[k]
    before = half[0] if k else 0.0  # a plate's centre lies half a plate before the clamp of the next
    body = parent.add_body(name=finger.plates[k], pos=[before + beam.length + half[0], 0.0, 0.0])
    mass = 8 * density * float(np.prod(half))
    lumps, moments = [Lump(mass, 0.0, 0.0), beam.end(-half[0])], mass * (half @ half - half**2) / 3
    moments += beam.mass * END_SECTIONS * _sections(finger)
    for after in finger.beams[k + 1 : k + 2]:
        lumps.append(after.clamp(half[0]))
        moments += after.mass * CLAMP_SECTIONS * _sections(finger)
    _weigh(body, lumps, moments)
    *slides, turn = finger.joints[k]
    for joint, axis in zip(slides, np.eye(3), strict=True):
        body.add_joint(name=joint, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, **FREE)
    body.add_joint(name=turn, type=mujoco.mjtJoint.mjJNT_BALL, **FREE)
    return body


def _add_geoms(body: mujoco.MjsBody, finger: Attached, k: int, friction: float, step: float) -> None:
    """Add what of a plate touches, and the geom that distances are measured from."""
    half = finger.rod.half_lengths
    body.add_geom(
        name=body.name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=half - MARGIN,
        margin=MARGIN,
        mass=0.0,
        friction=[friction, 0.0, 0.0],
        **TOUCHES,
        solref=[FAST * step, 1.0],
        solimp=STIFF,
        solmix=1e6,  # how stiff a contact is, its plate says
        rgba=[0.2, 0.2, 0.22, 1.0],
    )
    # What distances are measured from, see control.mujoco.rubber: it touches nothing and is not seen.
    body.add_geom(
        name=finger.rubbers[k],
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=half,
        mass=0.0,
        group=5,
        **dict.fromkeys(TOUCHES, 0) | {"condim": 3},
    )


def attach_gripper(
    spec: mujoco.MjSpec,
    rod: Rod,
    palm: str,
    fingers: int = 3,
    radius: float = 0.025,
    name: str = "finger",
    **options: Any,
) -> list[Attached]:
    """Mount fingers evenly around the z axis of a body, as `control.Gripper` has them; they point along -z.

    Args:
        spec: the model.
        rod: every finger.
        palm: name of the body that holds them.
        fingers: how many.
        radius: of the circle that their surfaces stand on [m].
        name: of the fingers, which a number follows: "finger 0" and so on.
        options: see `attach`.

    Raises:
        ValueError: less than one finger; see `attach`.
    """
    if fingers < 1:
        raise ValueError(f"fingers must be at least 1, got {fingers}")
    side = 2 * rod.half_lengths[1]
    found = []
    for k, angle in enumerate(2 * np.pi * np.arange(fingers) / fingers):
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        down = np.array([0.0, 0.0, -1.0])
        frame, quaternion = np.column_stack([down, -out, np.cross(down, -out)]), np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, frame.ravel())
        place = (radius + side / 2) * out
        found.append(attach(spec, rod, palm, place, quaternion, name=f"{name} {k}", **options))
    return found


def _weigh(body: mujoco.MjsBody, lumps: Sequence[Lump], moments: np.ndarray) -> None:
    """Set a body's inertia: lumps on its x axis, and further moments about x, y, z, shape (3,) [kg m^2]."""
    one = united(lumps)
    body.explicitinertial, body.mass = True, one.mass
    body.ipos, body.inertia = [one.x, 0.0, 0.0], moments + one.moment * np.array([0.0, 1.0, 1.0])

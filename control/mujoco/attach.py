"""A finger as bodies of a MuJoCo model: a chain of sections, each free to move relative to the previous one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from control.mujoco import keyframes
from control.mujoco.sections import Block, Body, bodies_of
from rom import Rod
from rom.brief import brief

STIFF = (0.999, 0.9999, 1e-5, 0.5, 2.0)  # impedance of contacts: MuJoCo's default allows overlaps of millimetres
FAST = 2.0  # time constant of contacts over a step, MuJoCo's minimum [-]
# MuJoCo sometimes misses contacts that overlap by micrometres. So a block is smaller by this on all sides [m], and its
# contact margin is as large.
MARGIN = 3e-6
# Distance at which blocks of rubber find objects, over their half side: more than that of the rubber from them [-].
AROUND_RUBBER = 0.2
NEIGHBOURS = 2  # largest distance along the chain of bodies without contact with each other
AROUND = 32  # points of an outline that is not a rectangle
COLORS = {True: (0.2, 0.2, 0.22, 1.0), False: (0.98, 0.68, 0.52, 1.0)}  # of plates, of rubber
NET_FORCE = 3  # how MuJoCo's sensors of contact reduce several contacts to one

# Independent of a model's own defaults.
FREE = {"damping": 0.0, "stiffness": 0.0, "armature": 0.0, "frictionloss": 0.0, "limited": 0, "actfrclimited": 0}
TOUCHES = {"contype": 1, "conaffinity": 1, "condim": 3, "priority": 0}


@brief
@dataclass(frozen=True)
class Attached:
    """A finger in a MuJoCo model.

    Attributes:
        name: of the finger, with which the names of its bodies begin.
        rod: the finger.
        clamp: name of the body at the proximal end.
        sections: names of the bodies of its other sections, from clamp to tip.
        plates: those of its plates among them.
        joints: names of the joints of every section: three slides along the axes of its parent, and a ball.
        sensors: names of the sensors of contact force, along the world's axes [N], of the clamp and every section; a
            contact of an element's rubber counts for the section at its distal end.
        relaxation: damping over stiffness of the rubber [s].
        density: of rubber and plates [kg/m^3].
    """

    name: str
    rod: Rod
    clamp: str
    sections: tuple[str, ...]
    plates: tuple[str, ...]
    joints: tuple[tuple[str, ...], ...]
    sensors: tuple[str, ...]
    relaxation: float
    density: float

    @property
    def elements(self) -> list[tuple[mujoco.mjtObj, str]]:
        """Types and names of the finger's bodies, joints and sensors."""
        kinds = mujoco.mjtObj
        bodies = [(kinds.mjOBJ_BODY, one) for one in (self.clamp, *self.sections)]
        joints = [(kinds.mjOBJ_JOINT, one) for names in self.joints for one in names]
        return [*bodies, *joints, *((kinds.mjOBJ_SENSOR, one) for one in self.sensors)]

    def renamed(self, prefix: str = "", suffix: str = "") -> Attached:
        """Return the finger with the names it has after `spec.attach(hand, prefix=..., suffix=...)`.

        Example:
            >>> arm.attach(hand, prefix="left/", site="flange")
            >>> simulation = Simulation(arm.compile(), [finger.renamed(prefix="left/") for finger in fingers])
        """

        def new(names: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(f"{prefix}{name}{suffix}" for name in names)

        name, clamp = new((self.name, self.clamp))
        sections, plates, sensors = map(new, (self.sections, self.plates, self.sensors))
        joints = tuple(map(new, self.joints))
        return replace(self, name=name, clamp=clamp, sections=sections, plates=plates, joints=joints, sensors=sensors)


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
        rod: the finger; MuJoCo's gravity replaces the [gravity] of its scene.
        palm: name of the parent body, "world" for a fixed finger.
        position: of the clamp's centre on that body [m].
        quaternion: of the clamp, w first: x is the finger's axis, y the bending direction of the lead tendon.
        name: of the finger, unique in the model.
        relaxation: damping over stiffness of the rubber (Kelvin-Voigt) [s].
        density: of rubber and plates [kg/m^3].
        friction: of the finger [-]. MuJoCo takes the larger friction of both sides.

    Raises:
        ValueError: no such body, a name in use, a keyframe of another size, or numbers out of range.

    Example:
        >>> spec = mujoco.MjSpec.from_file("hand.xml")
        >>> finger = attach(spec, Rod.load("finger.h5"), "palm", position=(0.025, 0.0, 0.0))
        >>> simulation = Simulation(spec.compile(), [finger])
    """
    parent = spec.body(palm)
    if parent is None:
        raise ValueError(f"palm must be a body of the model, got {palm!r}")
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
            raise ValueError(f"{what} must be finite and at least 0, a density above 0, got {value}")
    bodies = bodies_of(rod)
    finger = _named(name, rod, bodies, relaxation, density)
    _require_free(spec, finger)
    keyframes.check(spec)
    names, body = (finger.clamp, *finger.sections), parent
    for k, one in enumerate(bodies):
        pose = {"pos": place, "quat": turned / np.linalg.norm(turned)} if k == 0 else {"pos": [one.offset, 0.0, 0.0]}
        body = body.add_body(name=names[k], **pose)
        if k:
            _free(body, finger.joints[k - 1])
        body.explicitinertial = True
        body.mass, body.ipos, body.inertia = one.inertia(rod, density)
        for j, block in enumerate(one.blocks):
            _add_geom(spec, body, f"{names[k]} part {j}", rod, block, friction)
        _add_sensor(spec, finger.sensors[k], names[k])
        near = [palm] * (palm != "world") + list(names[:k])
        for other in near[-NEIGHBOURS:]:
            spec.add_exclude(bodyname1=other, bodyname2=names[k])
    keyframes.insert(spec, finger.clamp, len(finger.sections))
    return finger


def _named(name: str, rod: Rod, bodies: list[Body], relaxation: float, density: float) -> Attached:
    """Name the parts of a finger."""
    sections = list[str]()
    for body in bodies[1:]:
        kind = "plate" if body.is_plate else "section"
        sections.append(f"{name} {kind} {sum(one.startswith(f'{name} {kind}') for one in sections)}")
    return Attached(
        name=name,
        rod=rod,
        clamp=f"{name} clamp",
        sections=tuple(sections),
        plates=tuple(one for one, body in zip(sections, bodies[1:], strict=True) if body.is_plate),
        joints=tuple(tuple(f"{one} {kind}" for kind in ("x", "y", "z", "turn")) for one in sections),
        sensors=tuple(f"{one} force" for one in (f"{name} clamp", *sections)),
        relaxation=relaxation,
        density=density,
    )


def _require_free(spec: mujoco.MjSpec, finger: Attached) -> None:
    """Raise if a name of the finger is in use in the model."""
    for kind, one in finger.elements:
        if getattr(spec, kind.name.removeprefix("mjOBJ_").lower())(one) is not None:
            raise ValueError(
                f"name must be free in the model, got {finger.name!r} where {one!r} exists: give another name"
            )


def _free(body: mujoco.MjsBody, joints: tuple[str, ...]) -> None:
    """Let a section move relative to its parent."""
    *slides, turn = joints
    for joint, axis in zip(slides, np.eye(3), strict=True):
        body.add_joint(name=joint, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, **FREE)
    body.add_joint(name=turn, type=mujoco.mjtJoint.mjJNT_BALL, **FREE)


def _add_sensor(spec: mujoco.MjSpec, name: str, body: str) -> None:
    """Add a sensor of the sum of all contact forces on a body."""
    spec.add_sensor(
        name=name,
        type=mujoco.mjtSensor.mjSENS_CONTACT,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        objname=body,
        intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
    )


def _add_geom(spec: mujoco.MjSpec, body: mujoco.MjsBody, mesh: str, rod: Rod, block: Block, friction: float) -> None:
    """Add a block with its own outline: a box, or a mesh of points on the outline."""
    section, length = rod.own.section.scaled(block.size), block.end - block.begin
    half = np.array([length / 2, *section.box]) - MARGIN
    if section.is_rectangle:
        form: dict[str, Any] = {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": half}
    else:
        around = section.points(AROUND) * half[1:] / section.box
        ends = [np.column_stack([np.full(AROUND, x), around]) for x in (-half[0], half[0])]
        spec.add_mesh(name=mesh, uservert=np.concatenate(ends).ravel())
        form = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": mesh}
    body.add_geom(
        pos=[block.begin + length / 2, 0.0, 0.0],
        margin=MARGIN,
        gap=0.0 if block.is_plate else AROUND_RUBBER * float(np.mean(section.box)),
        mass=0.0,
        friction=[friction, 0.0, 0.0],
        **TOUCHES,
        solref=[FAST * spec.option.timestep, 1.0],
        solimp=STIFF,
        solmix=1e6,  # the finger's stiffness applies to the contact
        rgba=COLORS[block.is_plate],
        **form,
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
    """Mount fingers evenly around the z axis of a body, along -z, in the arrangement of `control.Gripper`.

    Args:
        spec: the model.
        rod: model of every finger.
        palm: name of the parent body.
        fingers: number of fingers.
        radius: of the circle through their surfaces [m].
        name: prefix of the fingers' names: "finger 0" and so on.
        options: of `attach`.

    Raises:
        ValueError: fewer than one finger; see `attach`.
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

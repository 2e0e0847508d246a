"""The rubber of one segment in a compiled model: a spring of six directions between a plate and its parent."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from control.mujoco.attach import Attached
from control.mujoco.rod import Coupling
from control.mujoco.rubber import Rubber
from rom.brief import brief
from rom.rod.inverse_map import InverseMap

LOWER = np.tril_indices(6)
BODY = mujoco.mjtObj.mjOBJ_BODY
# What a compiler of MuJoCo's may do to bodies and geoms that look superfluous, and to masses.
KEEP = "compile it without fusestatic, discardvisual, settotalmass and boundmass"


@brief
@dataclass
class Held:
    """A plate's last pose that has an inverse, (7,), with its wrench, force (6,) and stiffness (6, 6) there.

    `trained` is its last position within the trained domain, shape (3,) [m].
    """

    position: np.ndarray
    wrench: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray
    trained: np.ndarray


@brief
@dataclass(frozen=True)
class Spring:
    """One segment's rubber in a compiled model.

    Attributes:
        inverse: of its map.
        finger, pulled: whose it is, and which of that one's tensions are its own.
        body: of its plate.
        position: where its seven coordinates begin.
        velocity: where its six velocities begin.
        inertia: places of the lower triangle of its block of MuJoCo's inertia, row by row, shape (21,).
        offset: of its plate's centre from what holds it, undeformed, shape (3,) [m], seen from the clamp.
        relaxation: [s].
        held: its last pose within the trained domain.
        rubber: what of it may touch something.
        coupling: its inertia and weight between clamp and plate.
    """

    inverse: InverseMap
    finger: int
    pulled: list[int]
    body: int
    position: int
    velocity: int
    inertia: np.ndarray
    offset: np.ndarray
    relaxation: float
    held: Held
    rubber: Rubber
    coupling: Coupling

    def reset(self, data: mujoco.MjData) -> None:
        """Begin without a wrench, at the current position."""
        self.inverse.forget()
        self.held.wrench[:] = 0.0
        self.held.position[:] = data.qpos[self.position : self.position + 7]
        self.held.trained[:] = self.held.position[:3]

    def weigh(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Set the plate's inverse inertia that MuJoCo scales its contacts with: at rest, with the rubber of a step.

        MuJoCo's own has the plate alone. Contacts of a plate that is light before stiff rubber would give way.
        """
        mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)
        self.reset(data)
        _, stiffness = self.pull(data, np.zeros(len(self.pulled)))
        own, h = np.zeros((6, 6)), model.opt.timestep
        own[LOWER] = data.M[self.inertia]
        inverse = np.linalg.inv(own + np.tril(own, -1).T + h * (self.relaxation + h) * stiffness)
        model.body_invweight0[self.body] = np.trace(inverse[:3, :3]) / 3, np.trace(inverse[3:, 3:]) / 3

    def pull(self, data: mujoco.MjData, tensions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and stiffness at the current position, see `InverseMap.spring`; linear where the map has no pose."""
        inverse, held = self.inverse, self.held
        place = data.qpos[self.position : self.position + 7]
        inverse.find(tensions, self.offset + place[:3], place[3:])
        if inverse.converged:
            held.position[:], held.wrench[:] = place, inverse.wrench
            held.force, held.stiffness = inverse.spring()
            if inverse.inside:
                held.trained[:] = place[:3]
            return held.force, held.stiffness
        inverse.wrench[:] = held.wrench  # from there it tries again
        turn, back, relative = np.zeros(3), np.zeros(4), np.zeros(4)
        mujoco.mju_negQuat(back, held.position[3:])
        mujoco.mju_mulQuat(relative, back, place[3:])
        mujoco.mju_quat2Vel(turn, relative, 1.0)
        moved = np.concatenate([place[:3] - held.position[:3], turn])
        return held.force + held.stiffness @ moved, held.stiffness

    def away(self, data: mujoco.MjData) -> float:
        """Distance of the plate from where it was last within the trained domain [m]."""
        away = data.qpos[self.position : self.position + 3] - self.held.trained
        return float(np.sqrt(away @ away))


def check(model: mujoco.MjModel, finger: Attached) -> None:
    """Check that a compiled model has a finger as it was attached.

    Raises:
        ValueError: parts are missing or renamed, or have another mass.
    """
    for kind, name in finger.elements:
        if mujoco.mj_name2id(model, kind, name) < 0:
            others = [mujoco.mj_id2name(model, kind, k) or "" for k in range(model.nbody if kind == BODY else 0)]
            (prefix, suffix), *_ = [*(one.split(name) for one in others if one.count(name) == 1), ("", "")]
            advice = f"use Attached.renamed(prefix={prefix!r}, suffix={suffix!r})" if prefix or suffix else KEEP
            raise ValueError(f"model must have {name!r} of {finger.name!r}, got none: {advice}")
    mass, expected = model.body(finger.clamp).mass[0], finger.beams[0].clamp(0.0).mass
    if not np.isclose(mass, expected):
        raise ValueError(f"mass of {finger.clamp!r} must be {expected:g} kg, got {mass:g} kg: {KEEP}")


def springs_of(model: mujoco.MjModel, data: mujoco.MjData, finger: int, attached: Attached) -> list[Spring]:
    """The segments of a finger in a compiled model, from clamp to tip.

    Raises:
        ValueError: a part of it is missing in the model, or MuJoCo stores the inertia in another form.
    """
    check(model, attached)
    rod, half = attached.rod, float(attached.rod.half_lengths[0])
    found: list[Spring] = []
    own = np.isin(model.geom_bodyid, [model.body(plate).id for plate in attached.plates])
    parts = zip(rod.segments, attached.plates, attached.rubbers, attached.joints, attached.beams, strict=True)
    for segment, plate, geom, joints, beam in parts:
        joint = model.joint(joints[0]).id
        body, first = model.body(plate).id, int(model.jnt_dofadr[joint])
        rows = [first + i for i in range(6)]
        last = model.M_rowadr[rows] + model.M_rownnz[rows] - 1  # the diagonal's place ends a row
        inertia = np.array([last[i] - (i - j) for i in range(6) for j in range(i + 1)])
        if not np.array_equal(model.M_colind[inertia], [first + j for i in range(6) for j in range(i + 1)]):
            raise ValueError(f"MuJoCo must keep the inertia of {plate!r} as one block")
        found.append(
            Spring(
                inverse=InverseMap(segment),
                finger=finger,
                pulled=[rod.names.index(name) for name in segment.names],
                body=body,
                position=int(model.jnt_qposadr[joint]),
                velocity=first,
                inertia=inertia,
                offset=segment.rest,
                relaxation=attached.relaxation,
                rubber=Rubber(model, segment, plate, geom, own, first=not found),
                coupling=Coupling(model, data, body, half if found else 0.0, -half, beam),
                held=Held(np.zeros(7), np.zeros(6), np.zeros(6), np.zeros((6, 6)), np.zeros(3)),
            )
        )
    return found

"""The elements of a finger in a compiled model: springs of six directions between neighbouring sections."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from control.mujoco.attach import Attached
from control.mujoco.sections import bodies_of
from control.native import CONTROL
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of, struct
from rom.rod.segment import Segment

COORDINATES = CONTROL.constants.CONTROL_COORDINATES
MOST_TENSIONS = LIBRARY.constants.FINGERFEM_MOST_TENSIONS
BODY = mujoco.mjtObj.mjOBJ_BODY
KEEP = "compile it without settotalmass and boundmass"  # options of MuJoCo's compiler


class Rubber:
    """Rubber and tendons of a finger in a compiled model, by the inverse of every element's law (native/sections.h).

    Attributes:
        attached: the finger.
        positions, velocities: where coordinates and velocities of its sections begin, shape (n,).
        bodies: indices of its clamp and sections, shape (n + 1,).
        wrenches: of the elements' laws at the current poses, in the sections' frames, shape (n, 6) [N, N m].
        inside: whether elements are within their trained domain, and reach the pose, shape (n, 2).
        struct: control_sections.

    Args:
        model: compiled.
        data: its state, whose arrays must stay in memory.
        attached: the finger.

    Raises:
        ValueError: a part of the finger is missing in the model, or MuJoCo stores the inertia in another form.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, attached: Attached):
        check(model, attached)
        self._arguments, rod, n = (model, data, attached), attached.rod, len(attached.sections)
        self.attached, self._loads = attached, np.zeros(len(rod.names))
        self.bodies = np.array([model.body(one).id for one in (attached.clamp, *attached.sections)])
        joints = [model.joint(one[0]).id for one in attached.joints]
        self.positions, self.velocities = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self.wrenches, self.inside = np.zeros((n, 6)), np.ones((n, 2), np.int32)
        self._held, self._trained = np.zeros((n, COORDINATES)), np.zeros((n, 3))
        self._state = {"held": self._held, "wrenches": self.wrenches, "trained": self._trained}
        self._state |= {"forces": np.zeros((n, 6)), "stiffness": np.zeros((n, 6, 6))}
        pulled, elements = np.zeros((n, MOST_TENSIONS), np.int32), list[Any]()
        for segment in rod.segments:
            own = [rod.names.index(name) for name in segment.names]
            for one in _elements(segment):
                pulled[len(elements), : len(own)] = own
                elements.append(one)
        integers = {"pulled": pulled, "positions": self.positions, "velocities": self.velocities}
        integers |= {"bodies": self.bodies[1:], "geoms": model.body_geomadr[self.bodies[1:]]}
        integers["inertia"] = np.array([_places(model, int(one)) for one in self.velocities])
        arrays = {name: getattr(data, name) for name in ("qpos", "qvel", "qfrc_applied", "M")} | self._state
        arrays["offsets"] = np.array([[one.length, 0.0, 0.0] for one in bodies_of(rod)[1:]])
        arrays |= {"loads": self._loads, "places": np.zeros((n, 3)), "rotations": np.zeros((n, 3, 3))}
        memory = max((memory_of(one) for one in (*elements, rod.struct)), key=len)
        integers = {name: np.ascontiguousarray(one, np.int32) for name, one in integers.items()}
        pointers = CONTROL.ffi.new("fingerfem_segment *[]", elements)
        self._kept = arrays, integers, elements, memory, pointers
        values = {"n": n, "clamp": self.bodies[0], "relaxation": attached.relaxation, "memory": memory}
        self.struct = CONTROL.ffi.new(
            "control_sections *",
            {
                **values,
                **{"elements": pointers, "chain": rod.struct},
                **{name: pointer(array) for name, array in arrays.items()},
                **{name: pointer(array, "int32_t[]") for name, array in integers.items()},
            },
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters and state, without addresses."""
        return type(self), self._arguments, {name: one.copy() for name, one in self._state.items()}

    def __setstate__(self, state: dict[str, np.ndarray]) -> None:
        for name, one in state.items():
            self._state[name][:] = one

    def reset(self) -> None:
        """Begin without wrenches, at the current positions."""
        for one in self._state.values():
            one[:] = 0.0
        qpos = self._arguments[1].qpos
        self._held[:] = qpos[self.positions[:, None] + np.arange(COORDINATES)]
        self._trained[:] = self._held[:, :3]

    def pull(self, tensions: np.ndarray, step: float) -> bool:
        """Set forces and add to the inertia of a step [s], between MuJoCo's mj_step1 and the factorisation.

        Returns:
            True if all are `inside`.
        """
        self._loads[:] = tensions
        return bool(CONTROL.functions.control_pull(self.struct, step, pointer(self.inside, "int32_t[]")))

    @property
    def away(self) -> float:
        """Largest distance of a section from its last position within the trained domain [m]."""
        slides = self._arguments[1].qpos[self.positions[:, None] + np.arange(3)]
        return float(np.linalg.norm(slides - self._trained, axis=1).max())


def weigh(model: mujoco.MjModel, data: mujoco.MjData, fingers: list[Rubber], loads: int) -> None:
    """Set the inverse inertia of sections, by which MuJoCo scales contacts: at rest, including the rubber of a step.

    MuJoCo's own inverse inertia has only the masses, with which contacts of light sections would be too compliant.
    """
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    for one in fingers:
        one.reset()
        one.pull(np.zeros(loads), model.opt.timestep)
    mujoco.mj_factorM(model, data)
    jacobian, inverse = np.zeros((6, model.nv)), np.zeros((6, model.nv))
    for body in np.concatenate([one.bodies[1:] for one in fingers]):
        mujoco.mj_jacBodyCom(model, data, jacobian[:3], jacobian[3:], body)
        mujoco.mj_solveM(model, data, inverse, jacobian)
        moves = np.einsum("ij,ij->i", jacobian, inverse)
        model.body_invweight0[body] = moves[:3].mean(), moves[3:].mean()


def check(model: mujoco.MjModel, finger: Attached) -> None:
    """Check that a compiled model contains a finger without changes.

    Raises:
        ValueError: parts are missing or renamed, or have another mass.
    """
    for kind, name in finger.elements:
        if mujoco.mj_name2id(model, kind, name) < 0:
            others = [mujoco.mj_id2name(model, kind, k) or "" for k in range(model.nbody if kind == BODY else 0)]
            (prefix, suffix), *_ = [*(one.split(name) for one in others if one.count(name) == 1), ("", "")]
            advice = f"use Attached.renamed(prefix={prefix!r}, suffix={suffix!r})" if prefix or suffix else KEEP
            raise ValueError(f"model must have {name!r} of {finger.name!r}, got none: {advice}")
    mass, (expected, *_) = (
        model.body(finger.clamp).mass[0],
        bodies_of(finger.rod)[0].inertia(finger.rod, finger.density),
    )
    if not np.isclose(mass, expected):
        raise ValueError(f"mass of {finger.clamp!r} must be {expected:g} kg, got {mass:g} kg: {KEEP}")


def _elements(segment: Segment) -> list[Any]:
    """Structs fingerfem_segment of the elements of a segment from clamp to tip, each alone."""
    whole = replace(segment.condensed, outlines=None, depths=None, bulges=None, shortenings=None)
    return [struct(replace(whole, elements=[law])) for law in reversed(whole.elements)]


def _places(model: mujoco.MjModel, first: int) -> np.ndarray:
    """Places of the lower triangle of a section's block of MuJoCo's inertia, row by row, shape (21,)."""
    rows = first + np.arange(6)
    last = model.M_rowadr[rows] + model.M_rownnz[rows] - 1  # the diagonal's place ends a row
    found = np.array([last[i] - (i - j) for i in range(6) for j in range(i + 1)])
    if not np.array_equal(model.M_colind[found], [first + j for i in range(6) for j in range(i + 1)]):
        raise ValueError(
            "MuJoCo must store the inertia of a section as one block, got another layout: install another version"
        )
    return found

"""Inertia and weight of the rubber between two bodies: a rod with the consistent mass matrix of cubic shapes.

For deflection and slope at both ends, with mass m and length L (Archer, J. Struct. Div. ASCE 89, 1963):

    m / 420 [[156, 22 L, 54, -13 L], [22 L, 4 L^2, 13 L, -3 L^2], [54, 13 L, 156, -22 L], [-13 L, -3 L^2, -22 L, 4 L^2]]

The block of the moving end is a rigid body on the plate. The rest of a straight rod is a rigid body on the clamp.
MuJoCo has no element for the block between both ends: `Coupling` adds it to the inertia and to the forces of a step.
With it the load of gravity, or of a base that accelerates, is the consistent one: m g / 2 and m g L / 12 at each end.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np

from control.native import CONTROL
from rom.native import pointer

MOTION = ("xpos", "xmat", "subtree_com", "cvel", "cdof", "cdof_dot", "qvel", "M", "qfrc_bias")  # of MuJoCo's mjData


class Lump(NamedTuple):
    """A rigid body on the x axis of a MuJoCo body.

    Attributes:
        mass: [kg].
        x: position of its centre [m].
        moment: of inertia about its centre, across the axis [kg m^2].
    """

    mass: float
    x: float
    moment: float


class Beam(NamedTuple):
    """The rubber of one segment, as a beam.

    Attributes:
        mass: [kg].
        length: without the plate [m].
    """

    mass: float
    length: float

    def end(self, x: float) -> Lump:
        """The inertia at its moving end, which is at x [m]: the block of the consistent mass matrix."""
        moment = 1 / 105 - 13 / 35 * (11 / 78) ** 2
        return Lump(13 / 35 * self.mass, x - 11 / 78 * self.length, moment * self.mass * self.length**2)

    def clamp(self, x: float) -> Lump:
        """The rest at its other end, which is at x [m]: with `end` a straight rod has its rigid inertia."""
        moment = 2 / 35 - 22 / 35 * (19 / 66) ** 2
        return Lump(22 / 35 * self.mass, x + 19 / 66 * self.length, moment * self.mass * self.length**2)


# Shares of the moments of the rubber's sections at either end: linear in the turn. About all axes alike, so that the
# inertia of a short and thick finger is that of a body, which MuJoCo asks for [-].
END_SECTIONS, CLAMP_SECTIONS = 1 / 3, 2 / 3


def united(lumps: Sequence[Lump]) -> Lump:
    """Lumps of one body as one."""
    mass = sum(one.mass for one in lumps)
    x = sum(one.mass * one.x for one in lumps) / mass
    return Lump(mass, x, sum(one.moment + one.mass * (one.x - x) ** 2 for one in lumps))


class Coupling:
    """The block between both ends of one segment's rubber in a compiled model (control/native/rod_inertia.c).

    With the velocities p of both ends as points of the clamp's body, and q as points of the plate's, shape (6,), the
    kinetic energy is m p . C (q - p), C = [[10, 31], [3, 10]] / 420: none where the rubber does not bend.

    Args:
        model: compiled.
        data: its state, which keeps its arrays.
        plate: number of the plate's body; its parent has the clamp.
        begin: of the rubber, from the origin of the parent along its x axis [m].
        end: of the rubber, from the plate's centre along its x axis [m].
        rod: the rubber.

    Raises:
        ValueError: MuJoCo does not store the inertia in full rows.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, plate: int, begin: float, end: float, rod: Beam):
        path: list[int] = []
        last = int(model.body_dofadr[plate] + model.body_dofnum[plate]) - 1
        while last >= 0:
            path.insert(0, last)
            last = int(model.dof_parentid[last])
        if not np.array_equal(model.M_rownnz[path], np.arange(len(path)) + 1):
            raise ValueError(f"MuJoCo must store the inertia of {model.body(plate).name!r} in full rows")
        self._given = model, data, plate, begin, end, rod
        self._model = model
        arrays = {name: getattr(data, name) for name in MOTION}
        arrays |= {"memory": np.zeros(12 * len(path))}
        integers = {"path": np.array(path, np.int32), "rows": np.array(model.M_rowadr[path], np.int32)}
        self._kept = arrays, integers
        self._struct = CONTROL.ffi.new(
            "control_rod *",
            {
                **{"n": len(path), "own": int(model.body_dofnum[plate]), "plate": plate},
                **{"clamp": int(model.body_parentid[plate]), "root": int(model.body_rootid[plate])},
                **{"mass": rod.mass, "length": rod.length, "begin": begin, "end": end},
                **{name: pointer(array) for name, array in arrays.items()},
                **{name: pointer(array, "int32_t[]") for name, array in integers.items()},
            },
        )
        self._gravity = np.zeros(3)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters, without addresses."""
        return type(self), self._given

    def add(self) -> None:
        """Add it to the inertia and to the bias forces of a step, between MuJoCo's mj_step1 and the factorisation."""
        option = self._model.opt
        off = option.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
        self._gravity[:] = 0.0 if off else option.gravity
        CONTROL.functions.control_couple(self._struct, pointer(self._gravity))

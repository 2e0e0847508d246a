"""Contacts of rubber in a MuJoCo model: those of the rod's surface, with their compliance, in place of those of blocks.

The blocks between sections only find the objects that are near. Contacts are those of slices that bend, bulge and yield
(docs/theory/contact.md). Let h be the step and t the relaxation time of the rubber where it is pressed in, else 0. With
the gap g, its rate v, the compliance c and the normal force f, a step ends where

    g + (h + t) v + c f >= 0,    f >= 0,    one of them 0.

So MuJoCo's regularisation is c / (h (h + t)), and its reference acceleration -(g / (h + t) + v) / h. Along the
surface the rubber yields by c times the change of the tangential force. If p is that of the step before, Coulomb's law
has the slip rate v + c (f - p) / h: the regularisation is c / h^2, the reference acceleration -v / h + c p / h^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from control.mujoco.contact.engine import Engine
from control.mujoco.contact.near import Near, is_known
from control.mujoco.rubber import Rubber
from control.mujoco.sections import bodies_of
from control.native import CONTROL
from rom.native import pointer


class RubberContacts:
    """Contacts of all fingers' rubber with geoms that are not of fingers.

    Args:
        engine: of the model.
        rubber: of every finger.

    Attributes:
        buried: whether a geom was in the rubber without contact since `reset`, as if it were deeper than it is large,
            shape (fingers,).
    """

    def __init__(self, engine: Engine, rubber: list[Rubber]):
        model = engine.model
        self._engine, self._rubber, self.buried = engine, rubber, np.zeros(len(rubber), bool)
        self._near = dict[int, Near]()  # by finger and geom
        finger_of = np.full(model.ngeom, -1, np.int32)  # of blocks of rubber
        is_object = np.array([is_known(model, geom) for geom in range(model.ngeom)])
        for k, one in enumerate(rubber):
            is_object[np.isin(model.geom_bodyid, one.bodies)] = False
            for body, own in zip(one.bodies, bodies_of(one.attached.rod), strict=True):
                first = model.body_geomadr[body]
                finger_of[[first + j for j, block in enumerate(own.blocks) if not block.is_plate]] = k
        near, met = (CONTROL.ffi.new("control_near *[]", len(rubber) * model.ngeom) for _ in range(2))
        self._kept = finger_of, is_object, near, met
        values = {"fingers": len(rubber), "geoms": model.ngeom, "near": near, "met": met}
        values |= {"finger_of": pointer(finger_of, "int32_t[]"), "is_object": pointer(is_object, "uint8_t[]")}
        self._struct = CONTROL.ffi.new("control_rubbers *", values)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters and the contacts of the last step, without addresses."""
        return type(self), (self._engine, self._rubber), {pair: one.contacts for pair, one in self._near.items()}

    def __setstate__(self, contacts: dict[int, bytes]) -> None:
        for pair, own in contacts.items():
            self._add(pair)
            self._near[pair].contacts = own

    def _add(self, pair: int) -> None:
        """Prepare contacts of a finger with a geom."""
        finger, geom = divmod(pair, self._engine.model.ngeom)
        self._near[pair] = Near(self._engine.model, self._rubber[finger].struct, finger, geom)
        self._struct.near[pair] = self._near[pair].struct

    def reset(self) -> None:
        """Forget all contacts."""
        self._struct.count, self.buried[:] = 0, False
        for one in self._near.values():
            one.struct.found.count = 0

    def replace(self) -> None:
        """Replace contacts of blocks, after mj_step1 and `Rubber.pull`, and set the engine's addresses."""
        model, data, compiled = self._engine.model, self._engine.data, CONTROL.functions
        self._engine.set_contacts()
        while (pair := compiled.control_rubber_meet(self._engine.struct, self._struct)) >= 0:
            self._add(pair)
        for near in self._met():
            compiled.control_rubber_find(self._engine.struct, near)
            self.buried[near.finger] |= near.is_buried
            near.first = data.ncon
            for _ in range(near.count):
                mujoco.mj_addContact(model, data, data.contact[near.like])
            if near.count:
                near.count = data.ncon - near.first  # MuJoCo warns if it has no memory for more
                self._engine.set_contacts()
                compiled.control_rubber_place(self._engine.struct, near)
        if self._struct.count:
            mujoco.mj_makeConstraint(model, data)
            mujoco.mj_referenceConstraint(model, data)
        self._engine.set_constraints()
        for near in self._met():
            compiled.control_rubber_constrain(self._engine.struct, near, model.opt.timestep)

    def _met(self) -> Sequence[Any]:
        """Structs control_near of fingers and geoms that met in this step."""
        return self._struct.met[0 : self._struct.count]

    def note(self) -> None:
        """Note the forces of a step, about which contacts of the next one are linearised."""
        for near in self._met():
            CONTROL.functions.control_rubber_note(self._engine.struct, near)

"""Contacts and constraints of a MuJoCo model's data for compiled code (control/native/engine.h)."""

from __future__ import annotations

from typing import Any

import mujoco

from control.native import CONTROL
from rom.native import pointer

FIXED = ("qvel", "qacc", "xpos", "xmat", "geom_xpos", "geom_xmat")
CONTACT = {
    "double[]": ("dist", "pos", "frame", "includemargin", "friction", "mu"),
    "int32_t[]": ("dim", "geom", "geom1", "geom2", "exclude", "efc_address"),
}
CONSTRAINTS = ("efc_J", "efc_R", "efc_D", "efc_aref", "efc_vel", "efc_force")
SPARSE = ("efc_J_rownnz", "efc_J_rowadr", "efc_J_colind")


class Engine:
    """Addresses of contacts and constraints, which MuJoCo moves in a step.

    Attributes:
        model, data: MuJoCo's.
        struct: control_engine.

    Args:
        model: compiled.
        data: its state, whose arrays must stay in memory.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData):
        self.model, self.data = model, data
        self.struct = CONTROL.ffi.new("control_engine *", {"nv": model.nv})
        self._set(FIXED)
        self._is_sparse = mujoco.mj_isSparse(model)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters, without addresses."""
        return type(self), (self.model, self.data)

    def _set(self, names: tuple[str, ...], kind: str = "double[]") -> None:
        for name in names:
            setattr(self.struct, name, pointer(getattr(self.data, name), kind))

    def set_contacts(self) -> None:
        """Set their number and addresses, after mj_step1 or mj_addContact."""
        self.struct.ncon, contact = self.data.ncon, self.data.contact
        if self.struct.ncon and pointer(contact.dist[:1]) != self.struct.dist:
            self.struct.stride = contact.dist.strides[0]
            for kind, names in CONTACT.items():
                for name in names:
                    setattr(self.struct, name, pointer(getattr(contact, name)[:1], kind))

    def set_constraints(self) -> None:
        """Set addresses of constraints, after mj_step1 or mj_makeConstraint."""
        self._set(CONSTRAINTS)
        if self._is_sparse:
            self._set(SPARSE, "int32_t[]")

"""Rigid contacts that stick without creep: MuJoCo's friction about the forces of the step before.

MuJoCo regularises friction. With the regularisation R and the reference acceleration -b v, a contact with the force f
along the surface slides at R f / b, as long as it is loaded; it turns under a torsional moment, too. Let p be the force
of the step before. With R p - b v it slides at R (f - p) / b: it yields by a fixed distance, as on rubber
(control.mujoco.contact.rubber_contacts).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from control.mujoco.contact.engine import Engine
from control.native import CONTROL
from rom.native import pointer


class Sticking:
    """Friction of rigid contacts in the last step.

    Args:
        engine: of the model.
        own: of which geoms contacts stick, shape (geoms,), bool.
    """

    def __init__(self, engine: Engine, own: np.ndarray):
        self._engine, self._own = engine, own
        self.reset()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled and copied by its parameters and the contacts of the last step, without addresses."""
        size = self._count * CONTROL.ffi.sizeof("control_stuck")
        return type(self), (self._engine, self._own), bytes(CONTROL.ffi.buffer(self._contacts)[:size])

    def __setstate__(self, contacts: bytes) -> None:
        self._contacts = CONTROL.ffi.new("control_stuck[]", len(contacts) // CONTROL.ffi.sizeof("control_stuck"))
        CONTROL.ffi.buffer(self._contacts)[:] = contacts
        self._count = len(self._contacts)

    def reset(self) -> None:
        """Forget all contacts."""
        self._contacts, self._count = CONTROL.ffi.new("control_stuck[]", 0), 0

    def recall(self, contacts: int) -> None:
        """Begin a step about the last forces of the first contacts: each about that of its geoms' nearest one."""
        now, last = CONTROL.ffi.new("control_stuck[]", contacts), (self._contacts, self._count)
        chosen = self._engine.struct, pointer(self._own, "uint8_t[]"), contacts
        self._contacts, self._count = now, CONTROL.functions.control_stick_recall(*chosen, *last, now)

    def note(self) -> None:
        """Note the forces of a step."""
        CONTROL.functions.control_stick_note(self._engine.struct, self._contacts, self._count)

"""Steps of time of a finger before objects, by compiled code (segment.h)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of

MOVING = LIBRARY.constants.FINGERFEM_MOVING  # numbers of a body


@brief
class Stepped(NamedTuple):
    """Where a step of time ends.

    Attributes:
        moving: of every body, shape (bodies, 30), see segment.h.
        loads: on all bodies, those of contacts and of inertia, shape (6 bodies,) [N, N m].
        forces: of every object against its direction, shape (m,) [N].
        energy: kinetic [J].
        inside: whether tensions, loads and contacts lie where the elements were trained.
        evaluations: of the map, negative without an answer.
    """

    moving: np.ndarray
    loads: np.ndarray
    forces: np.ndarray
    energy: float
    inside: bool
    evaluations: int


def inertia_struct(masses: np.ndarray, moments: np.ndarray, inertias: np.ndarray, elements: np.ndarray) -> Any:
    """A struct fingerfem_inertia, see `rom.rod.motion.lumps.Lumps`."""
    return LIBRARY.struct("fingerfem_inertia", masses=masses, moments=moments, inertias=inertias, elements=elements)


def at_rest(compiled: Any, tensions: np.ndarray, loads: np.ndarray) -> np.ndarray | None:
    """The bodies of a struct fingerfem_chain at rest, shape (bodies, 30); None if there are too many of them."""
    moving = np.zeros((len(loads) // 6, MOVING))
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, loads)]
    known = LIBRARY.functions.fingerfem_at_rest(compiled, *given, memory_of(compiled), pointer(moving))
    return moving if known else None


def step(
    touching: Any,
    inertia: Any,
    memory: Any,
    point: np.ndarray,
    length: float,
    radius: float,
    moving: np.ndarray,
    loads: np.ndarray,
) -> Stepped:
    """A step to tensions and every d, shape (t + m,), from where the bodies move so, under loads of the last step."""
    found, pressed, forces, energy = moving.copy(), loads.copy(), np.zeros(touching.count), np.zeros(1)
    inside = np.zeros(1, np.int32)
    evaluations = LIBRARY.functions.fingerfem_step(
        touching,
        inertia,
        pointer(np.ascontiguousarray(point, float)),
        length,
        radius,
        memory,
        *map(pointer, (found, pressed, forces, energy)),
        pointer(inside, "int32_t[]"),
        LIBRARY.ffi.NULL,
    )
    return Stepped(found, pressed, forces, float(energy[0]), bool(inside[0]), evaluations)

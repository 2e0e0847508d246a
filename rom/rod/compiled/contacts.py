"""Possible contacts of a finger and an object under given loads, and motions by forces there (possible_contacts.c)."""

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of

Label = tuple[int, int]  # of a contact: its plate or slice of rubber, and what of it; the same wherever the finger is
AXES, ENDS = 3, 2  # normal and two tangents; bodies that a force goes to, at most


@brief
class Contacts(NamedTuple):
    """B bodies that bear wrenches, among them the n plates, and m contacts.

    Attributes:
        inside: whether tensions and wrenches lie where the elements were trained, and no contact that may press is
            missing for want of room.
        centres, rotations: of the plates, shapes (n, 3) [m] and (n, 3, 3).
        bodies: the index of each one's load, see `rom.rod.compiled.loads`, shape (B,).
        motions: R^T dc, R^T dtheta of all bodies by all of their wrenches, shape (6 B, 6 B).
        labels: of the contacts.
        segments: at which each is, shape (m,).
        rubber: whether it is rubber that may touch, shape (m,).
        gaps: negative inside the object, shape (m,) [m].
        compliances: how far each yields by itself with a unit force at every one, shape (m, m) [m/N].
        places: of the finger's points, shape (m, 3) [m].
        axes: normals out of the object and two tangents, shape (m, 3, 3).
        arms: the wrenches on all bodies of unit forces along these axes, shape (6 B, 3 m).
        on: rows of motions and arms of the bodies that each contact loads, shape (m, 12); for the fixed clamp, the
            number of rows.
        changes: of the wrenches in these rows as the bodies there move, shape (m, 3, 12, 12).
        compiled: a struct fingerfem_contacts.
    """

    inside: bool
    centres: np.ndarray
    rotations: np.ndarray
    bodies: np.ndarray
    motions: np.ndarray
    labels: list[Label]
    segments: np.ndarray
    rubber: np.ndarray
    gaps: np.ndarray
    compliances: np.ndarray
    places: np.ndarray
    axes: np.ndarray
    arms: np.ndarray
    on: np.ndarray
    changes: np.ndarray
    compiled: Any


def find_contacts(
    touching: Any, tensions: np.ndarray, d: float, moved: np.ndarray, loads: np.ndarray
) -> Contacts | None:
    """Contacts of an object; None if it touches more sections than compiled code holds.

    Args:
        touching: a struct fingerfem_touching.
        tensions: shape (t,) [N].
        d: of the object along its direction [m].
        moved: of the object besides, shape (3,) [m].
        loads: as of `Touched`, shape (l,) [N, N m].
    """
    compiled = LIBRARY.ffi.new("fingerfem_contacts *")
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, moved, loads)]
    memory, n = memory_of(touching.chain), touching.chain.plates
    if not LIBRARY.functions.fingerfem_find_contacts(touching, given[0], d, *given[1:], memory, compiled):
        return None
    count, m = compiled.bodies, compiled.contacts

    def numbers(name: str, most: int, shape: tuple[int, ...] = ()) -> np.ndarray:
        kind = np.int32 if name in ("loads", "parts", "names", "segments", "rubber", "on") else float
        values = np.frombuffer(LIBRARY.ffi.buffer(getattr(compiled, name)), kind)
        return values[: most * int(np.prod(shape))].reshape(most, *shape).copy()  # the struct may go before it

    bodies = numbers("on", m, (ENDS,))
    on = np.where(bodies[..., None] < 0, 6 * count, 6 * bodies[..., None] + np.arange(6)).reshape(m, 6 * ENDS)
    arms, own = np.zeros((6 * count + 1, AXES * m)), numbers("arms", m, (AXES, 6 * ENDS))
    for k in range(m):
        arms[on[k], AXES * k : AXES * (k + 1)] = own[k].T
    return Contacts(
        inside=bool(compiled.inside),
        centres=numbers("centres", n, (3,)),
        rotations=numbers("rotations", n, (3, 3)),
        bodies=numbers("loads", count),
        motions=numbers("motions", 6 * count, (6 * count,)),
        labels=list(zip(numbers("parts", m).tolist(), numbers("names", m).tolist(), strict=True)),
        segments=numbers("segments", m),
        rubber=numbers("rubber", m).astype(bool),
        gaps=numbers("gaps", m),
        compliances=numbers("compliances", m * m).reshape(m, m),
        places=numbers("places", m, (3,)),
        axes=numbers("axes", m, (AXES, 3)),
        arms=arms[:-1],
        on=on,
        changes=numbers("changes", m, (AXES, 6 * ENDS, 6 * ENDS)),
        compiled=compiled,
    )


def indented(contacts: Contacts, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gaps [m] and compliances by own forces [m/N], shapes (m,), linearised about forces (shapes/indentation.c).

    Args:
        contacts: m of them.
        forces: normal ones, shape (m,) [N].
    """
    gaps, compliances = np.empty_like(contacts.gaps), np.empty_like(contacts.gaps)
    given = np.ascontiguousarray(forces, float)
    LIBRARY.functions.fingerfem_indent(contacts.compiled, pointer(given), pointer(gaps), pointer(compliances))
    return gaps, compliances


def material_points(chain: Any, tensions: np.ndarray, loads: np.ndarray, contacts: Contacts) -> np.ndarray:
    """Positions of contacts' material points under other tensions and loads, shape (m, 3) [m].

    Args:
        chain: a struct fingerfem_chain.
        tensions: shape (t,) [N].
        loads: as of `Touched`, shape (l,) [N, N m].
        contacts: that have these points.
    """
    points = np.empty((len(contacts.gaps), 3))
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, loads)]
    memory = memory_of(chain)
    LIBRARY.functions.fingerfem_material_points(chain, *given, memory, contacts.compiled, pointer(points))
    return points

"""Answers of compiled code before objects, and the contacts that press there (segment.h)."""

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import memory_of


@brief
class Touched(NamedTuple):
    """Answers at n points before m objects.

    Attributes:
        out: tip displacement x, y, z [m], contact forces [N], touch distances [m], shape (n, 3 + 2 m).
        jacobians: of these by tensions and every d, shape (n, 3 + 2 m, t + m).
        by_object: of these by the place of every object and its turning about x, y, z through its centre, shape
            (n, 3 + 2 m, 6 m) [m, N, m per m or rad]; None if not asked for.
        loads: wrenches on every plate and on the sections between elements, in their frames, see `loads`, shape (n, m)
            [N, N m].
        inside: whether tensions, loads and d lie where the elements were trained, and there is an answer that is
            stable, shape (n,).
        evaluations: of the map, negative where there is no answer, shape (n,).
        plates: how many the finger has.
    """

    out: np.ndarray
    jacobians: np.ndarray
    by_object: np.ndarray | None
    loads: np.ndarray
    inside: np.ndarray
    evaluations: np.ndarray
    plates: int

    @property
    def wrenches(self) -> np.ndarray:
        """Wrenches on the plates, part of the loads, shape (n, 6 plates) [N, N m]."""
        return self.loads[:, : 6 * self.plates]


def rows_of(touching: Any) -> int:
    """Rows of an answer before m objects, 3 + 2 m: tip, forces, touch distances."""
    return 3 + 2 * int(touching.count)


def touches(touching: Any, points: np.ndarray, loads: np.ndarray | None = None, by_object: bool = False) -> Touched:
    """Answers at tensions and every d, shape (n, t + m).

    Args:
        touching: a struct fingerfem_touching.
        points: [N], [m].
        loads: where each solve begins, or wrenches on the plates alone, shape (n, m) [N, N m]; without contact if None.
        by_object: whether derivatives by the objects' places and turning are wanted too.
    """
    m, rows = touching.count, rows_of(touching)
    points, (n, p) = np.ascontiguousarray(points, float), points.shape
    begun = np.zeros((n, LIBRARY.functions.fingerfem_chain_loads(touching.chain)))
    if loads is not None:
        begun[:, : loads.shape[1]] = loads
    counts, moved = np.empty((2, n), np.int32), np.empty((n, rows, 6 * m)) if by_object else None
    touched = Touched(
        np.empty((n, rows)), np.empty((n, rows, p)), moved, begun, counts[0], counts[1], touching.chain.plates
    )
    kinds = ("double[]",) * 4 + ("int32_t[]",) * 2
    parts = zip(touched[:-1], kinds, strict=True)
    given = [LIBRARY.ffi.NULL if part is None else pointer(part, kind) for part, kind in parts]
    LIBRARY.functions.fingerfem_touches(touching, n, pointer(points), memory_of(touching.chain), *given)
    return touched._replace(inside=touched.inside.astype(bool))


@brief
class PressingContacts(NamedTuple):
    """Contacts that press, m of them.

    Attributes:
        plates: of which plate, or of the rubber before which, shape (m,).
        objects: with which object, shape (m,).
        rubber: whether it is rubber, shape (m,).
        places: in space, shape (m, 3) [m].
        normals: out of the object, shape (m, 3) [-].
        forces: along these on the finger, shape (m,) [N].
    """

    plates: np.ndarray
    objects: np.ndarray
    rubber: np.ndarray
    places: np.ndarray
    normals: np.ndarray
    forces: np.ndarray


def pressing(touching: Any, point: np.ndarray) -> PressingContacts:
    """Contacts that press at tensions and every d, shape (t + m,); none without an equilibrium."""
    given = np.array(point, float), np.zeros(LIBRARY.functions.fingerfem_chain_loads(touching.chain))
    compiled = LIBRARY.ffi.new("fingerfem_pressing *")
    at, loads = map(pointer, given)
    LIBRARY.functions.fingerfem_touch_pressing(touching, at, memory_of(touching.chain), loads, compiled)
    shapes: dict[str, tuple[type, tuple[int, ...]]] = dict.fromkeys(("plates", "objects", "rubber"), (np.int32, ()))
    shapes |= {"places": (float, (3,)), "normals": (float, (3,)), "forces": (float, ())}
    contacts: dict[str, np.ndarray] = {
        name: np.frombuffer(LIBRARY.ffi.buffer(getattr(compiled, name)), kind)
        .reshape(-1, *shape)[: compiled.count]
        .copy()
        for name, (kind, shape) in shapes.items()
    }
    return PressingContacts(**contacts | {"rubber": contacts["rubber"].astype(bool)})

"""A finger whose tendons rub in their guides, by compiled code (rod/guides.c, contact/guided.c)."""

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled.reports import Reports
from rom.rod.compiled.touched import rows_of


@brief
class GuideArrays(NamedTuple):
    """Guides of t tendons through n elements, and where the last increment has ended; C reads and writes these arrays.

    Attributes:
        friction: coefficients, shape (t,) [-].
        drag: friction per length times an element's length, shape (n, t) [N].
        tensions: in every element, shape (n, t) [N].
        rates: their derivatives by the tensions at the motors, shape (n, t, t) [-].
        bends: of the elements, shape (n,) [rad].
        slips: how far each tendon has moved at the element's end towards the clamp, shape (n, t) [m].
        motors: tensions there, shape (t,) [N].
        loads: of the contact, see `rom.rod.compiled.loads`, shape (l,) [N, N m].
    """

    friction: np.ndarray
    drag: np.ndarray
    tensions: np.ndarray
    rates: np.ndarray
    bends: np.ndarray
    slips: np.ndarray
    motors: np.ndarray
    loads: np.ndarray

    def keep(self) -> list[np.ndarray]:
        """Copies of what an increment changes, for `restore`."""
        return [one.copy() for one in self[2:]]

    def restore(self, kept: list[np.ndarray]) -> None:
        """Back to the end of an earlier increment."""
        for own, one in zip(self[2:], kept, strict=True):
            own[...] = one


def guided(chain: Any, objects: Any, count: int, arrays: GuideArrays) -> Any:
    """A struct fingerfem_touching of a chain with guides before `count` objects; all that is given must outlive it."""
    guides = LIBRARY.ffi.new("fingerfem_guides *")
    for name in ("friction", "drag", "tensions", "rates", "bends", "slips"):
        setattr(guides, name, pointer(getattr(arrays, name)))
    own = LIBRARY.struct("fingerfem_chain", guides=guides)
    for name, _ in LIBRARY.ffi.typeof("fingerfem_chain").fields:
        if name != "guides":
            setattr(own, name, getattr(chain, name))
    return LIBRARY.struct("fingerfem_touching", chain=own, count=count, objects=objects)


def advance(touching: Any, arrays: GuideArrays, point: np.ndarray, wound: np.ndarray) -> tuple[int, np.ndarray, bool]:
    """One increment, in place of the arrays.

    Args:
        touching: of `guided`.
        arrays: its own.
        point: tensions, or of the tendons that are wound shortenings, then every d, shape (t + m,) [N, m].
        wound: shape (t,).

    Returns:
        the number of steps, not above 0 without an equilibrium; work of the motors and what friction took of it, shape
        (2,) [J]; and whether all tensions are within their box.
    """
    work, inside = np.zeros(2), np.zeros(1, np.int32)
    memory = np.empty(LIBRARY.functions.fingerfem_chain_memory(touching.chain))
    given = np.array(point, float), np.array(wound, np.int32)
    steps = LIBRARY.functions.fingerfem_guides_advance(
        touching,
        pointer(given[0]),
        pointer(given[1], "int32_t[]"),
        *map(pointer, (memory, arrays.loads, arrays.motors, work)),
        pointer(inside, "int32_t[]"),
    )
    return steps, work, bool(inside[0])


@brief
class GuidedAnswer(NamedTuple):
    """An answer at the end of an increment, as in `Evaluation`, of one point without its first axis."""

    out: np.ndarray
    jacobian: np.ndarray
    errors: np.ndarray
    inside: bool
    reports: Reports


def answer(touching: Any, arrays: GuideArrays, distances: np.ndarray) -> GuidedAnswer:
    """The answer at the arrays' tensions and every d, shape (m,) [m], from the arrays' loads."""
    point, rows = np.append(arrays.motors, distances), rows_of(touching)
    out, jacobian, errors = np.empty(rows), np.empty((rows, len(point))), np.empty(rows - 2)
    inside, reports = np.zeros(1, np.int32), Reports.empty(1, len(arrays.motors), len(distances))
    memory = np.empty(LIBRARY.functions.fingerfem_chain_memory(touching.chain))
    given = map(pointer, (point, memory, arrays.loads, out, jacobian, errors))
    LIBRARY.functions.fingerfem_evaluate(touching, *given, pointer(inside, "int32_t[]"), reports.struct)
    return GuidedAnswer(out, jacobian, errors, bool(inside[0]), reports)

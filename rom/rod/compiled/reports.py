"""Compiled reports of a finger besides answers: orientations, shortenings, and positions of its elements."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import loads, memory_of

QUATERNION, ERRORS = LIBRARY.constants.FINGERFEM_QUATERNION, LIBRARY.constants.FINGERFEM_REPORT_ERRORS  # their numbers


@brief
class Reports(NamedTuple):
    """Reports of a finger with t tendons before m objects at n points, and their derivatives by tensions and every d.

    Attributes:
        rows: tip orientation w, x, y, z [-], then shortenings [m], shape (n, 4 + t).
        jacobians: of the rows by tensions and every d, shape (n, 4 + t, t + m).
        errors: estimated, of the orientation [rad] and of shortenings [m], shape (n, 2).
    """

    rows: np.ndarray
    jacobians: np.ndarray
    errors: np.ndarray

    @classmethod
    def empty(cls, n: int, t: int, m: int) -> Reports:
        """Arrays to be filled."""
        return cls(np.empty((n, QUATERNION + t)), np.empty((n, QUATERNION + t, t + m)), np.empty((n, ERRORS)))

    @property
    def struct(self) -> Any:
        """A struct fingerfem_report of these arrays, which must outlive it."""
        struct = LIBRARY.ffi.new("fingerfem_report *")
        for name, array in zip(("rows", "jacobian", "errors"), self, strict=True):
            setattr(struct, name, pointer(array))
        return struct


def shortenings(compiled: Any, tensions: np.ndarray, wrenches: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shortenings of the t tendons of a chain with n plates, shape (t,) [m], and their derivatives.

    Args:
        compiled: a struct fingerfem_chain.
        tensions: shape (t,) [N].
        wrenches: on the plates in their own frames, shape (n, 6) [N, N m].

    Returns:
        both; derivatives by tensions, then wrenches, have shape (t, t + 6 n).
    """
    t = len(tensions)
    values, changes = np.empty(t), np.empty((t, t + 6 * compiled.plates))
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, loads(compiled, wrenches))]
    LIBRARY.functions.fingerfem_chain_shortenings(
        compiled, *given, memory_of(compiled), pointer(values), pointer(changes)
    )
    return values, changes


def shortenings_by_force(
    compiled: Any, tensions: np.ndarray, position: float, force: np.ndarray
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Shortenings of the t tendons of a chain under one force across it, shape (t,) [m].

    Args:
        compiled: a struct fingerfem_chain.
        tensions: shape (t,) [N].
        position: of the force along the axis at rest, from the clamp [m].
        force: its components along y and z of the cross-section there, shape (2,) [N].

    Returns:
        the shortenings; their derivatives by tensions, position and both components, shape (t, t + 3); and whether
        all inputs are inside.
    """
    t = len(tensions)
    values, changes = np.empty(t), np.empty((t, t + 3))
    pulled, pressing = (np.ascontiguousarray(one, float) for one in (tensions, force))
    inside = LIBRARY.functions.fingerfem_chain_point_force(
        compiled, pointer(pulled), position, pointer(pressing), memory_of(compiled), pointer(values), pointer(changes)
    )
    return values, changes, bool(inside)


def elements(
    compiled: Any, tensions: np.ndarray, wrenches: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """The distal sections of every segment's m elements, from its plate to its clamp; arguments of `shortenings`.

    Returns:
        of every segment: places in space, shape (m, 3) [m], rotations of their frames, shape (m, 3, 3) [-], and the
        wrenches that they transmit, in these frames, shape (m, 6) [N, N m].
    """
    counts = [compiled.segments[k].elements for k in range(compiled.plates)]
    arrays = [np.empty((sum(counts), *shape)) for shape in ((3,), (3, 3), (6,))]
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, loads(compiled, wrenches))]
    LIBRARY.functions.fingerfem_chain_elements(compiled, *given, memory_of(compiled), *map(pointer, arrays))
    ends = np.cumsum(counts)[:-1]
    return list(zip(*(np.split(one, ends) for one in arrays), strict=True))

"""Answers of a touched rod with their estimated errors, and its surface as it is drawn (segment.h)."""

from typing import Any, NamedTuple

import numpy as np

from rom.brief import brief
from rom.native import LIBRARY, pointer
from rom.rod.compiled import ENDS, loads, memory_of
from rom.rod.compiled.reports import Reports
from rom.rod.compiled.touched import rows_of


@brief
class Evaluation(NamedTuple):
    """Answers at n points with their estimated errors.

    Attributes:
        out: as in `Touched`; the touch distance is the rubber's where that touches first.
        errors: estimated, of the tip, contact forces and touch distances, shape (n, 1 + 2 m) [m, N, m].
        inside: as in `Touched`.
        reports: what the finger reports there besides.
    """

    out: np.ndarray
    errors: np.ndarray
    inside: np.ndarray
    reports: Reports


def evaluate(touching: Any, points: np.ndarray) -> Evaluation:
    """Answers and their estimated errors at tensions and every d, shape (n, t + m), each solved from rest."""
    points, n, rows = np.ascontiguousarray(points, float), len(points), rows_of(touching)
    out, errors, inside = np.empty((n, rows)), np.empty((n, rows - 2)), np.empty(n, np.int32)
    memory, reports = memory_of(touching.chain), Reports.empty(n, touching.chain.tensions, touching.count)
    given = pointer(points), memory, pointer(out), pointer(errors), pointer(inside, "int32_t[]")
    LIBRARY.functions.fingerfem_evaluate_many(touching, n, *given, reports.struct)
    return Evaluation(out, errors, inside.astype(bool), reports)


def sections(compiled: Any, tensions: np.ndarray, wrenches: np.ndarray) -> list[np.ndarray] | None:
    """The surface of a chain, a struct fingerfem_chain, as sections of every segment, shapes (m, 4, 3) [m].

    Sections of a segment: the start of its rubber, positions along it, its plate's back and front. Corners: -y -z,
    -y z, y -z and y z. None if a segment has no outlines of its rubber.
    """
    counts = [compiled.segments[k].places + ENDS for k in range(compiled.plates)]
    corners = np.empty((sum(counts), 4, 3))
    given = [pointer(np.ascontiguousarray(one, float)) for one in (tensions, loads(compiled, wrenches))]
    if not LIBRARY.functions.fingerfem_chain_sections(compiled, *given, memory_of(compiled), pointer(corners)):
        return None
    return np.split(corners, np.cumsum(counts)[:-1])

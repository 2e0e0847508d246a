"""The ends of every range: what is accurate, against which reference, and what is refused, with its reason.

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import partial
from multiprocessing import get_context

from studies.extremes import bodies, loads, queries, tensors
from studies.extremes.verdicts import INACCURATE, Row
from studies.parts import Run

Part = Callable[[], Iterator[Row]]
CORES = 2


def parts(run: Run) -> list[Part]:
    """What yields rows, in the page's order."""
    fingers = [bodies.rubbers, bodies.sizes, bodies.meshes, bodies.contact_stiffness]
    return [
        tensors.rows,
        partial(queries.rows, 100_000),
        loads.rows,
        *fingers,
    ]


def tried(part: Part) -> list[Row]:
    """The rows of one part, printed one by one."""
    found = []
    for row in part():
        found.append(row)
        error = "" if row.error is None else f"{row.error:.1e}"
        print(f"  {row.outcome:8s} {row.part}: {row.extreme}, {row.case}: {error} {row.reference}", flush=True)
    return found


def measure(run: Run) -> list[dict]:
    """Try them all, a part a process.

    Raises:
        SystemExit: a row is neither accurate nor refused.
    """
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        found = [row for rows in pool.map(tried, parts(run)) for row in rows]
    inaccurate = sum(row.outcome == INACCURATE for row in found)
    print(f"  {len(found)} extremes, {inaccurate} of them neither accurate nor refused")
    if inaccurate:
        raise SystemExit(3)
    return [asdict(row) for row in found]

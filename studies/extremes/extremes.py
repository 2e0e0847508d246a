"""The ends of every range: what is accurate, against which reference, and what is refused, with its reason.

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from studies.extremes import bodies, data, loads, queries
from studies.extremes.verdicts import INACCURATE, Row
from studies.runner import Run


def rows(folder: Path, quick: bool) -> Iterator[Row]:
    """Every extreme of every part."""
    yield from data.rows(folder)
    yield from queries.rows(folder, 10_000 if quick else 1_000_000)
    yield from loads.rows(quick)
    yield from bodies.rows()


def measure(run: Run) -> list[dict]:
    """Try them all.

    Raises:
        SystemExit: a row is neither accurate nor refused.
    """
    found = []
    for row in rows(run.sets, run.quick):
        found.append(row)
        error = "" if row.error is None else f"{row.error:.1e}"
        print(f"  {row.outcome:8s} {row.part}: {row.extreme}, {row.case}: {error} {row.reference}", flush=True)
    inaccurate = sum(row.outcome == INACCURATE for row in found)
    print(f"  {len(found)} extremes, {inaccurate} of them neither accurate nor refused")
    if inaccurate:
        raise SystemExit(3)
    return [asdict(row) for row in found]

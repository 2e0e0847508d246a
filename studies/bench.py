"""The short form of every study, and what differs from the numbers on record.

python3 studies/bench.py [OUT] [--record] [--only NAME ...]    writes OUT/bench.json (out/bench by default)

Counts (iterations, states, terms, forms, verdicts) must be those of docs/bench.json; errors and bytes may differ by a
hundredth of themselves. Times are of the machine: only those taken in one run are compared with each other, as ratios
that may change by a factor, or by what one of them has grown beside the others of its study. --record makes what was
found the record.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import statistics
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from studies import runner

RECORD = ROOT / "docs" / "bench.json"
# Words of a name: ratios of times; times, and those too unsteady to be compared with others of the run; what else is of
# the machine and its moment.
RATIOS = {"faster", "over", "speedup"}
TIMES = {"seconds", "us"}
UNSTEADY = {"max", "p99", "p999", "first", "build", "start", "restart", "load"}
MOMENT = {"second", "memory", "overhead", "missed", "share"}
NAMES = ("scene", "name", "part", "extreme", "case")  # of a table's rows
WITHIN, FACTOR, LONGER = 0.01, 2.0, 3.0  # of errors and bytes; factor on ratios; factor on one time among others


def run(name: str, folder: Path) -> tuple[Any, float]:
    """A study's short form: what it writes, and how long it took [s]."""
    begun = time.perf_counter()
    runner.complete(name, folder, quick=True)
    found, _ = runner.results(name, folder, quick=True)
    return found, time.perf_counter() - begun


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every leaf with the way to it; rows of a table by their names."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, f"{path}/{key}")
    elif isinstance(value, list):
        seen: set[str] = set()
        for k, item in enumerate(value):
            name = ", ".join(item[key] for key in NAMES if key in item) if isinstance(item, dict) else ""
            name = f"{name} ({k})" if name in seen else name or str(k)
            seen.add(name)
            yield from numbers(item, f"{path}/{name}")
    else:
        yield path, value


def words_of(path: str) -> set[str]:
    """Of a number's own name; places in lists have none."""
    return set(next((key for key in reversed(path.split("/")) if not key.isdigit()), "").split("_"))


def differs(path: str, ours: Any, theirs: Any) -> bool:
    """Whether a number is not the one on record."""
    words = words_of(path)
    if words & RATIOS:
        return not 1 / FACTOR <= (ours or math.nan) / (theirs or math.nan) <= FACTOR
    if words & (TIMES | MOMENT):
        return False
    if (isinstance(ours, float) and isinstance(theirs, float)) or "bytes" in words:
        both_nan = math.isnan(ours) and math.isnan(theirs)
        return not math.isclose(ours, theirs, rel_tol=WITHIN, abs_tol=1e-9) and not both_nan
    return bool(ours != theirs)


def slower(ours: dict[str, Any], theirs: dict[str, Any]) -> list[str]:
    """One line for every time of a study that has grown far more than the study's others."""
    steady = [path for path in ours if (words := words_of(path)) & TIMES and not words & UNSTEADY]
    grown = {path: ours[path] / theirs[path] for path in steady if ours[path] and theirs.get(path)}
    pace = statistics.median(grown.values()) if grown else 1.0
    return [
        f"{path}: {by:.2g} times as long as on record, the others of its study {pace:.2g} times"
        for path, by in grown.items()
        if by > LONGER * pace
    ]


def compare(found: dict, record: dict) -> list[str]:
    """One line for every number of a study that differs, is new, is gone, or takes longer."""
    ours, theirs = (dict(numbers(one)) for one in (found, record))
    lines = slower(ours, theirs) + [
        f"{path}: {theirs[path]} on record, now {ours[path]}"
        for path in ours.keys() & theirs.keys()
        if differs(path, ours[path], theirs[path])
    ]
    lines += [f"{path}: not on record, now {ours[path]}" for path in ours.keys() - theirs.keys()]
    return sorted(lines + [f"{path}: {theirs[path]} on record, now gone" for path in theirs.keys() - ours.keys()])


def main() -> None:
    """Run, write, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default=str(ROOT / "out" / "bench"))
    parser.add_argument("--record", action="store_true", help="make what was found the record")
    parser.add_argument("--only", nargs="+", choices=runner.STUDIES, default=runner.STUDIES, help="these studies")
    options = parser.parse_args()
    folder = Path(options.out).resolve()
    shutil.rmtree(runner.place("any/part", folder, quick=True).folder.parent, ignore_errors=True)  # begin anew
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    found: dict[str, Any] = {}
    took: dict[str, float] = {}
    lines: list[str] = []
    for name in options.only:
        found[name], took[name] = run(name, folder)
        runner.write_json(folder / "bench.json", {"studies": found, "seconds": took})
        if options.record:
            RECORD.write_text(json.dumps(record | found, indent=1) + "\n")
        else:
            lines += compare({name: found[name]}, {name: record.get(name, {})})
    if options.record:
        return
    print("\n".join(lines) or "every number is the one on record, within its tolerance")
    raise SystemExit(3 if lines else 0)


if __name__ == "__main__":
    main()

"""The short form of every study, and what differs from the numbers on record.

python3 studies/bench.py [OUT] [--record] [--only NAME ...]    writes OUT/bench.json (out/bench by default)

Counts (iterations, states, terms, forms, bytes, verdicts) must be those of docs/bench.json; errors may differ by a
hundredth of themselves; times are of the machine and are not compared, but ratios of times taken in one run are, within
a factor. --record makes what was found the record.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

RECORD = ROOT / "docs" / "bench.json"
# All but two_meshes, of which tradeoff has a short form, and others, which wants other packages.
STUDIES = (
    *("solver", "choices", "scenes", "training", "refinement", "surrogate", "growth"),
    *("control", "tradeoff", "required", "extremes"),
)
TIME = re.compile(r"seconds|(^|_)us($|_)|_ms$|memory|rate|per_second|share|load_|missed|periods|wall")
RATIO = re.compile(r"ratio|speedup|times_faster")
ERRORS, RATIOS = 0.01, 2.0  # relative difference of errors; factor on ratios of times


def run(name: str, folder: Path) -> tuple[Any, float]:
    """A study's short form: what it writes, and how long it took [s]."""
    place, begun = folder / name, time.perf_counter()
    done = subprocess.run([sys.executable, str(ROOT / "studies" / f"{name}.py"), str(place), "--quick"], cwd=ROOT)
    if done.returncode:
        raise SystemExit(f"studies/{name}.py --quick ended with {done.returncode}")
    return json.loads((place / f"{name}.json").read_text()), time.perf_counter() - begun


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every leaf with the way to it; rows of a table by their names."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, f"{path}/{key}")
    elif isinstance(value, list):
        for k, item in enumerate(value):
            named = item.get("name") or item.get("scene") if isinstance(item, dict) else None
            yield from numbers(item, f"{path}/{named or k}")
    else:
        yield path, value


def differs(path: str, ours: Any, theirs: Any) -> bool:
    """Whether a number is not the one on record."""
    key = path.rsplit("/", 1)[-1]
    if RATIO.search(key):
        return not 1 / RATIOS <= (ours or math.nan) / (theirs or math.nan) <= RATIOS
    if TIME.search(key):
        return False
    if isinstance(ours, float) and isinstance(theirs, float):
        return not math.isclose(ours, theirs, rel_tol=ERRORS, abs_tol=1e-9) and not (
            math.isnan(ours) and math.isnan(theirs)
        )
    return bool(ours != theirs)


def compare(found: dict, record: dict) -> list[str]:
    """One line for every number that differs, is new, or is gone."""
    ours, theirs = (dict(numbers(one)) for one in (found, record))
    lines = [
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
    parser.add_argument("--only", nargs="+", choices=STUDIES, default=STUDIES, help="these studies")
    options = parser.parse_args()
    folder = Path(options.out).resolve()
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    found: dict[str, Any] = {}
    took: dict[str, float] = {}
    lines: list[str] = []
    for name in options.only:
        found[name], took[name] = run(name, folder)
        (folder / "bench.json").write_text(json.dumps({"studies": found, "seconds": took}, indent=1))
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

"""The ends of every range: what comes out right, against which reference, and what is refused, with its reason.

python3 studies/extremes/extremes.py [OUT] [--quick]
    prints a table, writes OUT/extremes.json (out/extremes by default)

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from studies.extremes import data, fingers, queries
from studies.extremes.verdicts import WRONG, Row


def rows(folder: Path, quick: bool) -> Iterator[Row]:
    """Every extreme of every part."""
    yield from data.rows(folder)
    yield from queries.rows(folder, 10_000 if quick else 1_000_000)
    yield from fingers.rows(quick)


def main() -> None:
    """Try, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default=str(ROOT / "out" / "extremes"))
    parser.add_argument("--quick", action="store_true", help="the draft mesh everywhere, and fewer random queries")
    options = parser.parse_args()
    folder, found = Path(options.out).resolve(), []
    folder.mkdir(parents=True, exist_ok=True)
    for row in rows(folder, options.quick):
        found.append(row)
        error = "" if row.error is None else f"{row.error:.1e}"
        print(f"{row.outcome:8s} {row.part}: {row.extreme}, {row.case}: {error} {row.reference}", flush=True)
    (folder / "extremes.json").write_text(json.dumps({"rows": [asdict(row) for row in found]}, indent=1))
    wrong = sum(row.outcome == WRONG for row in found)
    print(f"{len(found)} extremes, {wrong} of them neither right nor refused")
    raise SystemExit(3 if wrong else 0)


if __name__ == "__main__":
    main()

"""The ends of every range: what comes out right, against which reference, and what is refused, with its reason.

python3 studies/extremes.py [OUT] [--quick]    prints a table, writes OUT/extremes.json (out/extremes by default)

There is no third outcome: a row that is neither ends the study with code 3.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

RIGHT, REFUSED, WRONG = "right", "refused", "WRONG"


@dataclass(frozen=True, kw_only=True)
class Row:
    """What became of one extreme.

    Attributes:
        part: of the software.
        extreme: which range is at its end.
        case: how far.
        outcome: right, refused or WRONG.
        error: against the reference, relative [-]; None if it was refused.
        bound: that the error must keep [-].
        reference: what the answer is compared with; or the reason of a refusal.
    """

    part: str
    extreme: str
    case: str
    outcome: str
    error: float | None
    bound: float | None
    reference: str


class Refused(Exception):
    """A result that says why it is none."""


def judged(part: str, extreme: str, case: str, reference: str, bound: float, error: Callable[[], float]) -> Row:
    """One row: `error` computes the relative error, or raises what refuses with a reason."""
    from fingerfem.convergence import LoadNotReached

    try:
        found = float(error())
    except (ValueError, LoadNotReached, Refused) as refusal:
        reason = str(refusal).strip().replace(f"{ROOT}/", "")
        outcome = REFUSED if reason and "\n" not in reason else WRONG
        return Row(part=part, extreme=extreme, case=case, outcome=outcome, error=None, bound=None, reference=reason)
    outcome = RIGHT if found <= bound else WRONG
    return Row(part=part, extreme=extreme, case=case, outcome=outcome, error=found, bound=bound, reference=reference)


def rows(folder: Path, quick: bool) -> Iterator[Row]:
    """Every extreme of every part."""
    from studies import extreme_data, extreme_fingers, extreme_queries

    yield from extreme_data.rows(folder)
    yield from extreme_queries.rows(folder, 10_000 if quick else 1_000_000)
    yield from extreme_fingers.rows(quick)


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

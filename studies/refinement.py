"""States against error: uniform grids, and a grid refined where the surrogate's doubt is largest, on the draft finger.

python3 studies/refinement.py [OUT] [--quick]    prints tables, writes OUT/refinement.json (out/farm by default)
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from rom.enrichment import EnrichmentOptions  # noqa: E402
from rom.errors import check  # noqa: E402
from rom.snapshots import SnapshotSet  # noqa: E402
from rom.training import train  # noqa: E402
from studies.solver import say  # noqa: E402
from studies.training import DRAFT, farm, scene  # noqa: E402

GRIDS = ((5, 9), (9, 9), (9, 12), (9, 17), (13, 17))  # nodes along a tension, along contact
OPTIONS = EnrichmentOptions(tolerance=1e-4, terms=160)  # so many that sampling, not separation, makes the error
MEASURES = ("force_median", "force_p95", "displacement_median", "displacement_p95")


def errors(snapshots: SnapshotSet, held_out: SnapshotSet) -> dict:
    """States and held-out errors of a surrogate of all states of a set."""
    report = check(train(snapshots, OPTIONS), held_out)
    force, field = report["contact_force"], report["displacement"]
    found = {"states": snapshots.states, "newton_iterations": snapshots.iterations}
    found |= {"force_median": force["median"], "force_p95": force["p95"], "force_max": force["max"]}
    return found | {"displacement_median": field["median"], "displacement_p95": field["p95"]}


def uniform(folder: Path, grids, held_out: SnapshotSet) -> list[dict]:
    """Uniform grids; those that hold the nodes of the one before use its states again."""
    rows: list[dict] = []
    for before, (tensions, contact) in zip((None, *grids), grids, strict=False):
        path = folder / f"uniform-{tensions}-{contact}"
        shutil.rmtree(path, ignore_errors=True)
        nests = before is not None and all(
            (a - 1) % (b - 1) == 0 for a, b in zip((tensions, contact), before, strict=True)
        )
        options = ["--reuse", str(folder / "uniform-{}-{}".format(*before))] if nests else []
        farm(2, scene(folder, tensions, contact), path, *options)
        row = {"tension_nodes": tensions, "contact_nodes": contact} | errors(SnapshotSet(path), held_out)
        row["reuses_the_grid_before"] = nests
        say(row)
        rows.append(row)
    return rows


def refined(folder: Path, until: float, held_out: SnapshotSet) -> list[dict]:
    """A refined set after every second of its rounds, and after the last."""
    path, rows = folder / "refined", []
    shutil.rmtree(path, ignore_errors=True)
    farm(2, DRAFT, path, "--until", str(until))
    rounds = SnapshotSet(path).plan.rounds
    for count in sorted({*range(0, len(rounds), 2), len(rounds) - 1}):
        found = rounds[count]
        snapshots = SnapshotSet(path)
        solved = set(snapshots.description.lines).union(*(one.lines for one in rounds[:count]))
        snapshots.plan.lines = {task: line for task, line in snapshots.plan.lines.items() if task in solved}
        row = {"round": count, "estimated_error": found.error} | errors(snapshots, held_out)
        say(row)
        rows.append(row)
    return rows


def as_good(row: dict, curve: list[dict], measures) -> dict | None:
    """The first refined set whose errors are at most those of a uniform grid."""
    for one in curve:
        if all(one[name] <= row[name] for name in measures):
            return {"states": one["states"], "of_the_uniform_grid": one["states"] / row["states"]}
    return None


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default="out/farm")
    parser.add_argument("--quick", action="store_true", help="two coarse grids, few held-out states")
    options = parser.parse_args()
    folder = Path(options.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / "held-out", ignore_errors=True)
    farm(2, DRAFT, folder / "held-out", "--random", "40" if options.quick else "400", "--seed", "7")
    held_out = SnapshotSet(folder / "held-out")
    print("uniform grids")
    rows = uniform(folder, GRIDS[:2] if options.quick else GRIDS, held_out)
    print("refined, round by round")
    curve = refined(folder, 0.1 if options.quick else 0.012, held_out)
    print("states of the first refined set that is as good as a uniform grid")
    for row in rows:
        row["as_good_in_95_percent"] = as_good(row, curve, [name for name in MEASURES if name.endswith("p95")])
        row["as_good_in_all"] = as_good(row, curve, MEASURES)
        say(
            {
                name: row[name]
                for name in ("tension_nodes", "contact_nodes", "states", "as_good_in_95_percent", "as_good_in_all")
            }
        )
    (folder / "refinement.json").write_text(
        json.dumps({"held_out": len(held_out.random("tip")), "uniform": rows, "refined": curve}, indent=1)
    )


if __name__ == "__main__":
    main()

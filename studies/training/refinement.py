"""States against error: uniform grids, and a grid refined where the surrogate's doubt is largest, on the draft finger.

python3 studies/training/refinement.py [OUT] [--quick]
    prints tables, writes OUT/refinement.json (out/farm by default)
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from rom.build import train
from rom.held_out import check
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from studies.solver.solver import say
from studies.training.training import DRAFT, farm, scene

GRIDS = ((5, 9), (9, 9), (9, 12), (9, 17), (13, 17))  # nodes along a tension, along contact
OPTIONS = EnrichmentOptions(tolerance=2e-5, terms=160)  # so many that sampling, not separation, makes the error
MEASURES = ("force_median", "force_p95", "displacement_median", "displacement_p95")


def errors(snapshots: SnapshotSet, held_out: SnapshotSet) -> dict:
    """States and held-out errors of a surrogate of all states of a set."""
    report = check(train(snapshots, OPTIONS), held_out)
    force, field = report["contact_force"], report["displacement"]
    found = {"states": snapshots.states, "newton_iterations": snapshots.iterations}
    found |= {"force_median": force["median"], "force_p95": force["p95"], "force_max": force["max"]}
    return found | {"displacement_median": field["median"], "displacement_p95": field["p95"]}


def uniform(folder: Path, grids, held_out: SnapshotSet) -> list[dict]:
    """Uniform grids, each solved alone."""
    rows: list[dict] = []
    for tensions, contact in grids:
        path = folder / f"uniform-{tensions}-{contact}"
        shutil.rmtree(path, ignore_errors=True)
        farm(2, scene(folder, tensions, contact), path)
        rows.append({"tension_nodes": tensions, "contact_nodes": contact} | errors(SnapshotSet(path), held_out))
        say(rows[-1])
    return rows


def reused(folder: Path, rows: list[dict]) -> list[dict]:
    """The same grids from the states of a coarser one, wherever that nests."""
    found = []
    for fine in rows:
        for coarse in rows:
            names = ("tension_nodes", "contact_nodes")
            ratios = [(fine[name] - 1) / (coarse[name] - 1) for name in names]
            if coarse is not fine and set(ratios) <= {1.0, 2.0}:
                path = folder / "reused"
                shutil.rmtree(path, ignore_errors=True)
                of = [f"{row['tension_nodes']}-{row['contact_nodes']}" for row in (coarse, fine)]
                file = folder / f"draft-{of[1]}.toml"
                report = farm(2, file, path, "--reuse", str(folder / f"uniform-{of[0]}"))
                row = {"of": of[0].replace("-", " x "), "for": of[1].replace("-", " x ")}
                row |= {"newton_iterations": report["newton_iterations"], "alone": fine["newton_iterations"]}
                found.append(row)
                say(row)
    return found


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
    print("uniform grids from the states of coarser ones")
    again = reused(folder, rows)
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
        json.dumps(
            {"held_out": len(held_out.random("tip")), "uniform": rows, "reused": again, "refined": curve}, indent=1
        )
    )


if __name__ == "__main__":
    main()

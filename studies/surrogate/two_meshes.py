"""Many states on a coarse mesh and few on a fine one: error of the mesh and of the surrogate (figure 9 of the paper).

python3 studies/surrogate/two_meshes.py [OUT]
    prints, writes OUT/two_meshes.json (out/surrogate by default) and its picture

The draft mesh corrected by states on the middle mesh; a third mesh, finer than both, says what the meshes err.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from rom.build import train
from rom.error_model import calibrated
from rom.held_out import FELT, check
from rom.separation.alternating_directions import EnrichmentOptions
from rom.snapshots.folder import create
from rom.snapshots.snapshot_set import Description, SnapshotSet, read_description
from rom.surrogate import Surrogate
from studies import sets
from studies.solver.solver import say
from studies.surrogate.surrogate import honesty, quantiles

REFERENCE = 48  # states on the finest mesh, the first of the fresh ones
LINES = (5, 7, 10, 14, 20, 30, 60)  # on the fine mesh
HEADLINE = 14
OPTIONS = EnrichmentOptions()


def first_lines(of: SnapshotSet, count: int, fields: bool = False) -> SnapshotSet:
    """The first lines of a set of scattered lines, as a set of their own beside it."""
    place = of.path.parent / f"first-{count}{'-fields' if fields else ''}"
    shutil.rmtree(place, ignore_errors=True)
    whole = read_description(of.path)
    description = whole if fields else without_store(whole)
    create(place, replace(description, scattered=whole.scattered[:count]))
    for k in range(count):
        shutil.copy(of.path / "tasks" / f"scattered-{k}.npz", place / "tasks")
    shutil.copy(of.path / "body.npz", place)
    return SnapshotSet(place)


def without_fields(of: SnapshotSet) -> SnapshotSet:
    """The same set, its fields not read."""
    found = SnapshotSet(of.path)
    found.description = without_store(found.description)
    return found


def without_store(description: Description) -> Description:
    """A set's description with nothing stored besides what always is."""
    scene = description.scene
    return replace(description, scene=scene | {"sampling": scene["sampling"] | {"store": []}})


def force_errors(said: np.ndarray, true: np.ndarray) -> dict:
    """Relative errors of contact forces that are felt."""
    felt = true > FELT
    return quantiles(np.abs(said - true)[felt] / true[felt])


def errors(model: Surrogate, fresh: SnapshotSet, points: np.ndarray, true: np.ndarray) -> dict:
    """Of a surrogate: against its own mesh, and against the finest."""
    return {
        "surrogate": check(model, fresh)["contact_force"],
        "total": force_errors(model.evaluate(points).contact_force, true),
    }


def curves(files: dict[str, Path]) -> dict:
    """Errors against the number of states on the fine mesh."""
    finest = sets.held_out(files["reference"], "fresh", REFERENCE, sets.FRESH[1])
    fresh = {name: sets.held_out(files[name], "fresh", *sets.FRESH) for name in ("draft", "middle")}
    points, true = finest.random("parameters"), finest.random("contact_force")
    found: dict = {"mesh": {}, "rows": []}
    for name, own in fresh.items():
        assert np.array_equal(own.random("parameters")[:REFERENCE], points)
        found["mesh"][name] = force_errors(own.random("contact_force")[:REFERENCE], true)
        say({"mesh": name} | found["mesh"][name])
    coarse, few = without_fields(sets.training(files["draft"])), sets.training(files["middle few"])
    found["coarse_states"] = coarse.states

    def row(kind: str, states: int, model: Surrogate, own: SnapshotSet, lines: int = 0) -> None:
        one = {"kind": kind, "lines": lines, "states": states} | errors(model, own, points, true)
        found["rows"].append(one)
        say(one)

    row("draft mesh", coarse.states, train(coarse, OPTIONS), fresh["draft"])
    middle = without_fields(sets.training(files["middle"]))
    row("middle mesh, all its states", middle.states, train(middle, OPTIONS), fresh["middle"])
    for lines in LINES:
        some = first_lines(few, lines)
        row("middle mesh alone", some.states, train(some, OPTIONS), fresh["middle"], lines)
        row("both meshes", some.states, train(some, OPTIONS, coarse), fresh["middle"], lines)
    return found


def headline(files: dict[str, Path]) -> dict:
    """One model of two meshes with its field: errors, and how what it says of them compares."""
    fresh, scaling = (
        sets.held_out(files["middle"], kind, *drawn)
        for kind, drawn in (("fresh", sets.FRESH), ("scaling", sets.SCALING))
    )
    few = first_lines(sets.training(files["middle few"]), HEADLINE, fields=True)
    model = train(few, OPTIONS, sets.training(files["draft"]))
    report = check(model, fresh)
    found = {"lines": HEADLINE} | {key: report[key] for key in ("contact_force", "displacement", "touch")}
    found["scaling_states"] = len(scaling.description.random)
    found["said_unscaled"] = honesty(model, fresh)
    found["said"] = honesty(calibrated(model, scaling), fresh)
    say(found)
    return found


def draw(found: dict, file: Path) -> None:
    """Errors of contact force against states on the middle mesh."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    colours = {"both meshes": "tab:blue", "middle mesh alone": "tab:orange"}
    for ax, key, title in (
        (axes[0], "surrogate", "of the surrogate, against its mesh"),
        (axes[1], "total", f"of both, against a third mesh ({REFERENCE} states)"),
    ):
        for kind, colour in colours.items():
            rows = [row for row in found["rows"] if row["kind"] == kind]
            states = [row["states"] for row in rows]
            label = f"{kind} (draft mesh: {found['coarse_states']:,} states)" if kind == "both meshes" else kind
            ax.loglog(states, [100 * row[key]["median"] for row in rows], "o-", color=colour, label=f"{label}, median")
            ax.loglog(states, [100 * row[key]["p95"] for row in rows], "s:", color=colour, mfc="none", label="95 %")
        for name, style in (("draft", "--"), ("middle", "-.")):
            error = 100 * found["mesh"][name]["median"]
            ax.axhline(error, color="black", linestyle=style, label=f"error of the {name} mesh, median")
        ax.set(title=title, xlabel="states on the middle mesh")
        ax.grid(True, which="both", alpha=0.2)
    axes[0].set_ylabel("relative error of the contact force [%]")
    axes[1].legend(fontsize=7)
    figure.savefig(file, dpi=110)


def main() -> None:
    """Measure, print, write, draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default=str(ROOT / "out" / "surrogate"))
    parser.add_argument("--headline", action="store_true", help="that model again, the curves as they are")
    options = parser.parse_args()
    folder = Path(options.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    files = {name: sets.scene(folder, name) for name in ("draft", "middle", "middle few", "reference")}
    results = folder / "two_meshes.json"
    found = json.loads(results.read_text()) if options.headline else curves(files)
    results.write_text(json.dumps(found | {"headline": headline(files)}, indent=1))
    draw(found, ROOT / "docs" / "two_meshes.png")


if __name__ == "__main__":
    main()

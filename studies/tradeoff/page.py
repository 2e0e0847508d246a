"""Write docs/tradeoff.md, its picture, README's presets and fingerfem/front.json from what tradeoff.py measured.

python3 studies/tradeoff/page.py [OUT]    (out/tradeoff by default; docs, where the numbers are kept, to write them anew)
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from fingerfem.scene.presets import FRONT
from studies.readme import put, table
from studies.surrogate.page import percent
from studies.tradeoff.tradeoff import PRESETS, front

BEGIN = "<!-- presets: written by `make tradeoff` -->"  # in README
USUAL = 3e-4  # tolerance of the separation
NAMES = {"mor": "e_MOR", "total": "total"}
INTRO = """# Speed against accuracy

Written by `make tradeoff` from `studies/tradeoff/tradeoff.py`, on the draft scene's finger (one segment, two tendons, one plane). Every model and every
mesh answers the same {states} fresh states, {felt} of them with more than 0.1 N of contact force; the reference is a mesh finer than all
others, {reference} with {unknowns:,} unknowns. Errors of contact force are relative, where it is above 0.1 N; of displacement, the relative
2-norm of the field. Core-seconds count every Newton iteration of the training set on the machine that wrote this.

**e_FEM** is what the mesh errs against the reference, **e_MOR** what the surrogate errs against fresh states on its own mesh (figure 9 of the
paper); the **total** is measured, not added up.
"""

PAGE = """
## Presets

A scene names one by `preset`, or says `accuracy = "1 %"` (of the contact force) or `budget = "20min"` (of core time), and leaves `mesh` and
`sampling.lines` out. The choice is taken from the second table: the presets, and what no other choice of one mesh beats in both cost and error.
`snapshots` says what is expected, `rom check` what was got. Other fingers get cells of the same shape and as many lines a tension; what
these cost is scaled by cells and lines, and what they err is the draft finger's until it is measured.

{presets}

{listing}

![cost against error; mesh and surrogate](tradeoff.png)

## Meshes and contact methods: e_FEM

{meshes}

## Models

No other model is both cheaper to train and nearer to the reference (contact force, 95 %) than one of the front.

{models}
"""


def spread(found: dict, keys: tuple[str, ...] = ("median", "p95")) -> list[str]:
    """Quantiles for a table."""
    return [percent(found[key]) for key in keys]


def meshes(found: dict) -> str:
    """What meshes err, and what a state costs on them."""
    header = ["mesh", "unknowns", "fresh states", "core-seconds a state", "Newton iterations a state"]
    header += ["displacement, median", "95 %", "contact force, median", "95 %"]
    rows = [
        [
            row["name"],
            f"{row['unknowns']:,}",
            str(row["states"]),
            f"{row['core_seconds'] / row['states']:.2g}",
            f"{row['iterations'] / row['states']:.1f}",
            *spread(row["fem"]["displacement"]),
            *spread(row["fem"]["contact_force"]),
        ]
        for row in found["meshes"]
    ]
    return table(header, rows)


def models(rows: list[dict], front: list[str]) -> str:
    """What models cost and err."""
    header = ["", "mesh", "sampling", "correcting", "tolerance", "states", "core-seconds", "kB", "terms"]
    header += ["query [us]", "solve [us]", "displacement, median", "e_MOR, median", "95 %", "total, median", "95 %"]
    header += ["held force, median", "95 %"]
    cells = []
    for row in sorted(rows, key=lambda row: row["core_seconds"]):
        one = row["training"]
        coarse = (
            f"{one['coarse'][0]['cells'][0]} x {one['coarse'][0]['cells'][1]}, order {one['coarse'][0]['order']}, {one['coarse'][1]}"
            if one["coarse"]
            else ""
        )
        cells.append(
            [
                "**front**" if row["name"] in front else "",
                mesh_of(row),
                one["sampling"],
                coarse,
                f"{one['tolerance']:g}",
                f"{row['states']:,}",
                f"{row['core_seconds']:.0f}",
                f"{row['bytes'] / 1000:,.0f}",
                str(row["terms"]),
                f"{row['query_us']:.1f}",
                f"{row['solve_us']:.1f}",
                percent(row["total"]["displacement"]["median"]),
                *spread(row["mor"]["contact_force"]),
                *spread(row["total"]["contact_force"]),
                *spread(row["total"]["held_force"]),
            ]
        )
    return table(header, cells)


def choices(found: dict) -> list[dict]:
    """What a scene can choose: models of one mesh by lines that none beats in cost and error, and the presets."""
    of_mesh = {row["name"]: row["fem"] for row in found["meshes"]}
    plain = [
        row
        for row in found["models"]
        if row["training"]["coarse"] is None
        and row["training"].get("functions", "hermite") == "hermite"
        and "lines" in row["training"]["sampling"]
    ]
    presets = {training.name: preset for preset, training in PRESETS.items()}
    best = front(plain, "core_seconds")
    listed = [
        _choice(row, of_mesh) | {"preset": presets.get(row["name"])}
        for row in plain
        if row["name"] in best or row["name"] in presets
    ]
    return sorted(listed, key=lambda one: one["core_seconds"])


def _choice(row: dict, of_mesh: dict[str, dict]) -> dict:
    """What a scene's choice needs to know of a model."""
    one = row["training"]
    mesh = of_mesh[f"{one['mesh']['cells'][0]} x {one['mesh']['cells'][1]} order {one['mesh']['order']}"]
    found = {
        "cells": one["mesh"]["cells"],
        "order": one["mesh"]["order"],
        "lines": int(one["sampling"].split()[0]) / 2,
        "tolerance": one["tolerance"],
    }
    for quantity in ("contact_force", "displacement"):
        found[quantity] = row["total"][quantity]["p95"]
        found[f"{quantity}_of_mesh"] = mesh[quantity]["p95"]
        found[f"{quantity}_of_surrogate"] = row["mor"][quantity]["p95"]
    found["contact_force_median"] = row["total"]["contact_force"]["median"]
    found["held_force"] = row["total"]["held_force"]["p95"]
    return found | {key: row[key] for key in ("core_seconds", "states", "bytes", "terms", "query_us")}


def listing(listed: list[dict]) -> str:
    """All that a scene can choose from."""
    header = [
        "cells, order",
        "lines a tension",
        "tolerance",
        "core-seconds",
        "terms",
        "contact force, 95 %",
        "of the mesh",
    ]
    header += ["of the surrogate", "preset"]
    rows = [
        [
            f"{one['cells'][0]} x {one['cells'][1]}, {one['order']}",
            f"{one['lines']:g}",
            f"{one['tolerance']:g}",
            f"{one['core_seconds']:.0f}",
            str(one["terms"]),
            *(percent(one[f"contact_force{part}"]) for part in ("", "_of_mesh", "_of_surrogate")),
            one["preset"] or "",
        ]
        for one in listed
    ]
    return table(header, rows)


def presets(listed: list[dict]) -> str:
    """The presets as a table, for the page and README."""
    header = ["preset", "cells, order", "lines a tension", "states", "core-minutes", "model [kB]", "query [us]"]
    header += ["displacement, 95 %", "contact force, median", "95 %", "held force, 95 %"]
    rows = [
        [
            one["preset"],
            f"{one['cells'][0]} x {one['cells'][1]}, {one['order']}",
            f"{one['lines']:g}",
            f"{one['states']:,}",
            f"{one['core_seconds'] / 60:.1f}",
            f"{one['bytes'] / 1000:,.0f}",
            f"{one['query_us']:.1f}",
            percent(one["displacement"]),
            percent(one["contact_force_median"]),
            percent(one["contact_force"]),
            percent(one["held_force"]),
        ]
        for one in listed
        if one["preset"]
    ]
    return table(header, rows)


def draw(found: dict, file: Path) -> None:
    """Cost against error of every model, and both parts of the error against the states of the draft mesh."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    usual = [
        row
        for row in found["models"]
        if row["training"].get("functions", "hermite") == "hermite" and row["training"]["tolerance"] == USUAL
    ]
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    kinds: dict[str, list[dict]] = {}
    for row in usual:
        kinds.setdefault("two meshes" if row["training"]["coarse"] else mesh_of(row), []).append(row)
    for label, rows in sorted(kinds.items()):
        left.loglog(*_curve(rows, "total"), "s" if label == "two meshes" else "o", label=label)
    best = [next(row for row in found["models"] if row["name"] == name) for name in found["front"]]
    left.loglog(*_curve(best, "total"), "k-", lw=1, label="front")
    left.set(xlabel="training [core-seconds]", title="against the reference")
    for label, colour in (("20 x 5, order 1", "tab:blue"), ("10 x 5, order 2", "tab:orange")):
        rows = sorted(kinds.get(label, []), key=lambda row: row["states"])
        lines, grids = ([row for row in rows if ("lines" in row["training"]["sampling"]) == of] for of in (True, False))
        for key, style in (("mor", "o:"), ("total", "o-")):
            right.loglog(*_curve(lines, key, "states"), style, color=colour, label=f"{NAMES[key]}, {label}, lines")
        if grids:
            right.loglog(*_curve(grids, "mor", "states"), "x", color=colour, label=f"e_MOR, {label}, grids")
        for row in found["meshes"]:
            if label.replace(", ", " ") == row["name"]:
                right.axhline(100 * row["fem"]["contact_force"]["p95"], color=colour, lw=0.8, ls="--")
    right.set(xlabel="training states", title="of the surrogate (dotted), of the mesh (dashed), of both")
    for ax in (left, right):
        ax.set_ylabel("error of contact force that 95 % keep [%]")
        ax.legend(fontsize=7)
        ax.grid(True, which="both", alpha=0.2)
    figure.savefig(file, dpi=110)


def mesh_of(row: dict) -> str:
    """A model's mesh, for people."""
    mesh = row["training"]["mesh"]
    return f"{mesh['cells'][0]} x {mesh['cells'][1]}, order {mesh['order']}"


def _curve(rows: list[dict], key: str, cost: str = "core_seconds") -> tuple[list[float], list[float]]:
    return [row[cost] for row in rows], [100 * row[key]["contact_force"]["p95"] for row in rows]


def main() -> None:
    """Write page, picture, front and README's presets."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "tradeoff")
    found = json.loads((folder / "tradeoff.json").read_text())
    (ROOT / "docs" / "tradeoff.json").write_text(json.dumps(found) + "\n")
    listed = choices(found)
    FRONT.write_text(json.dumps({"choices": listed}, indent=1) + "\n")
    text = INTRO.format(
        states=max(row["states"] for row in found["meshes"]),
        felt=max(row["fem"]["contact_force"]["count"] for row in found["meshes"]),
        reference=found["reference"]["mesh"],
        unknowns=found["reference"]["unknowns"],
    )
    text += PAGE.format(
        presets=presets(listed),
        meshes=meshes(found),
        models=models(found["models"], found["front"]),
        listing=listing(listed),
    )
    (ROOT / "docs" / "tradeoff.md").write_text(text)
    draw(found, ROOT / "docs" / "tradeoff.png")
    put(BEGIN, f"\n{presets(listed)}\n")


if __name__ == "__main__":
    main()

"""Write docs/tradeoff.md, its picture and fingerfem/front.json from what tradeoff.py measured.

python3 studies/tradeoff_page.py [OUT]    (out/tradeoff by default)
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from fingerfem.choice import FRONT  # noqa: E402
from studies.readme import table  # noqa: E402
from studies.surrogate_page import percent  # noqa: E402

PRESETS = ("draft", "standard", "fine")
USUAL = 3e-4  # tolerance of the separation
INTRO = """# Speed against accuracy

Written by `make tradeoff` from `studies/tradeoff.py`, on the draft scene's finger (one segment, two tendons, one plane). Every model and every
mesh answers the same {states} fresh states, {felt} of them with more than 0.1 N of contact force; the reference is a mesh finer than all
others, {reference} with {unknowns:,} unknowns. Errors of contact force are relative, where it is above 0.1 N; of displacement, the relative
2-norm of the field. Core-seconds count every Newton iteration of the training set on the machine that wrote this.

**e_FEM** is what the mesh errs against the reference, **e_MOR** what the surrogate errs against fresh states on its own mesh (figure 9 of the
paper); the **total** is measured, not added up.
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
    header = ["", "mesh", "sampling", "correcting", "functions", "tolerance", "states", "core-seconds", "kB", "terms"]
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
                f"{one['mesh']['cells'][0]} x {one['mesh']['cells'][1]}, order {one['mesh']['order']}",
                one["sampling"],
                coarse,
                one["functions"],
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
    """The front of models that a scene can choose: one mesh, lines of states, Hermite functions, the usual tolerance."""
    of_mesh = {row["name"]: row["fem"]["contact_force"]["p95"] for row in found["meshes"]}
    plain = []
    for row in found["models"]:
        one = row["training"]
        if (
            one["coarse"] is None
            and one["functions"] == "hermite"
            and one["tolerance"] == USUAL
            and "lines" in one["sampling"]
        ):
            plain.append(row)
    best, listed = np.inf, []
    for row in sorted(plain, key=lambda row: row["core_seconds"]):
        error = row["total"]["contact_force"]["p95"]
        if error < best:
            best = error
            one = row["training"]
            name = f"{one['mesh']['cells'][0]} x {one['mesh']['cells'][1]} order {one['mesh']['order']}"
            listed.append(
                {
                    "cells": one["mesh"]["cells"],
                    "order": one["mesh"]["order"],
                    "lines": int(one["sampling"].split()[0]) / 2,
                    "tolerance": one["tolerance"],
                    "contact_force": error,
                    "contact_force_of_mesh": of_mesh[name],
                    "contact_force_of_surrogate": row["mor"]["contact_force"]["p95"],
                    "displacement": row["total"]["displacement"]["p95"],
                    "held_force": row["total"]["held_force"]["p95"],
                    "core_seconds": row["core_seconds"],
                    "states": row["states"],
                    "bytes": row["bytes"],
                    "query_us": row["query_us"],
                }
            )
    costs = np.log([one["core_seconds"] for one in listed])
    middle = int(np.abs(costs - (costs[0] + costs[-1]) / 2).argmin())
    for place, preset in zip((0, min(max(middle, 1), len(listed) - 2), len(listed) - 1), PRESETS, strict=True):
        listed[place]["preset"] = preset
    return listed


def presets(listed: list[dict]) -> str:
    """The presets as a table, for the page and README."""
    header = ["preset", "cells, order", "lines a tension", "states", "core-minutes", "model [kB]", "query [us]"]
    header += ["displacement, 95 %", "contact force, 95 %", "held force, 95 %"]
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
            percent(one["contact_force"]),
            percent(one["held_force"]),
        ]
        for one in listed
        if "preset" in one
    ]
    return table(header, rows)


def draw(found: dict, file: Path) -> None:
    """Cost against error, and both parts of the error against states."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    kinds: dict[str, list[dict]] = {}
    for row in found["models"]:
        one = row["training"]
        if one["functions"] == "hermite" and one["tolerance"] == USUAL:
            label = (
                "two meshes"
                if one["coarse"]
                else f"{one['mesh']['cells'][0]} x {one['mesh']['cells'][1]}, order {one['mesh']['order']}"
            )
            kinds.setdefault(label, []).append(row)
    for label, rows in sorted(kinds.items()):
        costs, errors = (
            [row["core_seconds"] for row in rows],
            [100 * row["total"]["contact_force"]["p95"] for row in rows],
        )
        left.loglog(costs, errors, "o" if label != "two meshes" else "s", label=label)
    best = [next(row for row in found["models"] if row["name"] == name) for name in found["front"]]
    left.loglog(
        [row["core_seconds"] for row in best],
        [100 * row["total"]["contact_force"]["p95"] for row in best],
        "k-",
        lw=1,
        label="front",
    )  # fmt: skip
    left.set(
        xlabel="training [core-seconds]",
        ylabel="contact force against the reference, 95 % [%]",
        title="cost against error",
    )
    left.legend(fontsize=7)
    draft = [
        row
        for row in found["models"]
        if row["training"]["mesh"]["cells"] == [20, 5] and row["training"]["mesh"]["order"] == 1
    ]
    draft = [
        row
        for row in draft
        if not row["training"]["coarse"]
        and row["training"]["functions"] == "hermite"
        and row["training"]["tolerance"] == USUAL
    ]
    draft.sort(key=lambda row: row["states"])
    for key, label in (("mor", "e_MOR"), ("total", "total")):
        right.loglog(
            [row["states"] for row in draft],
            [100 * row[key]["contact_force"]["median"] for row in draft],
            "o-",
            label=f"{label}, 20 x 5, order 1",
        )
    for row, style in zip(found["meshes"], ("--", "-.", ":", "--", "-.", ":", "--", "-."), strict=False):
        if row["mesh"]["method"] == "penalty" and not row["mesh"]["stiffness"]:
            right.axhline(100 * row["fem"]["contact_force"]["median"], color="grey", lw=0.8, linestyle=style)
            right.annotate(
                f"e_FEM {row['name']}",
                (right.get_xlim()[0], 100 * row["fem"]["contact_force"]["median"]),
                fontsize=6,
                va="bottom",
            )
    right.set(xlabel="training states", ylabel="contact force, median [%]", title="mesh and surrogate")
    right.legend(fontsize=7)
    for ax in (left, right):
        ax.grid(True, which="both", alpha=0.2)
    figure.savefig(file, dpi=110)


def main() -> None:
    """Write page, picture and front."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "tradeoff")
    found = json.loads((folder / "tradeoff.json").read_text())
    listed = choices(found)
    FRONT.write_text(json.dumps({"choices": listed}, indent=1) + "\n")
    usual = found["models"]
    text = INTRO.format(
        states=found["meshes"][0]["states"],
        felt=found["meshes"][0]["fem"]["contact_force"]["count"],
        reference=found["reference"]["mesh"],
        unknowns=found["reference"]["unknowns"],
    )
    text += f'\n## Presets\n\nA scene names one by `preset`, or says `accuracy = "1 %"` or `budget = "20min"` of core time.\n\n{presets(listed)}\n'
    text += f"\n![cost against error; mesh and surrogate](tradeoff.png)\n\n## Meshes and contact methods: e_FEM\n\n{meshes(found)}\n"
    text += f"\n## Models\n\nNo other model is both cheaper to train and nearer to the reference (contact force, 95 %) than one of the front.\n\n{models(usual, found['front'])}\n"
    (ROOT / "docs" / "tradeoff.md").write_text(text)
    draw(found, ROOT / "docs" / "tradeoff.png")


if __name__ == "__main__":
    main()

"""The picture of docs/speed.md, and fingerfem/scene/front.json, from which scenes choose."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt

from fingerfem.scene.presets import FRONT
from studies.axes import large_letters, logarithmic
from studies.runner import DOCS
from studies.tradeoff.rods import RodTraining
from studies.tradeoff.tradeoff import DRAFT, FINE, SQUARE

PRESETS = {
    "draft": RodTraining(SQUARE, 8),
    "standard": RodTraining(FINE, 16),
    "fine": RodTraining(FINE, 32),
}


def prepare(found: dict, folder: Path) -> dict:
    """Write picture and front; the choices that a scene has."""
    draw(found["tradeoff"], found["rods"], DOCS / "tradeoff.png")
    listed = choices(found["rods"])
    FRONT.write_text(json.dumps({"rods": listed}, indent=1) + "\n")
    return {"choices": listed, "mesh_of": mesh_of}


def choices(found: dict) -> list[dict]:
    """What a scene can choose: fingers that none beats in cost and error, and the presets."""
    names = {training.name: preset for preset, training in PRESETS.items()}
    on_draft = {"cells": list(DRAFT.cells), "order": DRAFT.order}
    listed = []
    for row in found["rods"]:
        one, total = row["training"], row["total"]
        if row["name"] not in {*found["front"], *names}:
            continue
        choice = {"cells": one["mesh"]["cells"], "order": one["mesh"]["order"], "lines": one["lines"] / 2}
        begins = None if choice["cells"] == on_draft["cells"] and choice["order"] == on_draft["order"] else on_draft
        choice |= {"coarse": begins, "preset": names.get(row["name"])}
        choice |= {quantity: total[quantity]["p95"] for quantity in ("contact_force", "displacement", "held_force")}
        choice |= {"contact_force_median": total["contact_force"]["median"]}
        listed.append(choice | {key: row[key] for key in ("core_seconds", "states", "bytes", "terms", "query_us")})
    return sorted(listed, key=lambda one: one["core_seconds"])


def draw(found: dict, rods: dict, file: Path) -> None:
    """Cost against error of every finger, and the error of its mesh."""
    large_letters()
    figure, ax = plt.subplots(figsize=(8, 5.6), layout="constrained")
    of_mesh = {row["name"]: row["fem"]["contact_force"]["p95"] for row in found["meshes"]}
    for name, error in of_mesh.items():
        label = name.replace(" order", ", order")
        rows = [row for row in rods["rods"] if mesh_of(row) == label]
        (points,) = ax.loglog(*_curve(rows), "o", label=label)
        ax.axhline(100 * error, color=points.get_color(), lw=0.8, ls="--")
    best = [next(row for row in rods["rods"] if row["name"] == name) for name in rods["front"]]
    ax.loglog(*_curve(best), "k-", lw=1, label="front")
    ax.set(xlabel="training [core-seconds]", ylabel="error of contact force, 95th percentile [%]")
    ax.set_title("dashed: error of the mesh alone")
    logarithmic(ax)
    ax.legend()
    ax.grid(True, alpha=0.3)
    figure.savefig(file, dpi=110)
    plt.close(figure)


def mesh_of(row: dict) -> str:
    """A model's mesh, for people."""
    mesh = row["training"]["mesh"]
    return f"{mesh['cells'][0]} x {mesh['cells'][1]}, order {mesh['order']}"


def _curve(rows: list[dict]) -> tuple[list[float], list[float]]:
    return [row["core_seconds"] for row in rows], [100 * row["total"]["contact_force"]["p95"] for row in rows]

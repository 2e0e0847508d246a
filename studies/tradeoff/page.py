"""The picture of docs/speed.md, and fingerfem/scene/front.json, from which scenes choose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from fingerfem.scene.presets import FRONT
from studies.axes import large_letters, logarithmic
from studies.sections import DOCS
from studies.tradeoff.fingers import words

KEPT = "cells", "order", "coarse", "preset", "core_seconds", "states"  # of a row, in front.json
TENSIONS = 2  # of the draft finger; front.json has lines per tension


def prepare(found: dict, folder: Path) -> dict:
    """Write picture and front."""
    fingers = found["fingers"]
    rows = sorted(fingers["rows"], key=lambda row: row["core_seconds"])
    draw(rows, fingers, DOCS / "tradeoff.png")
    FRONT.write_text(
        json.dumps(
            {"rods": [choice(row) for row in rows if row["preset"] or row["name"] in fingers["front"]]}, indent=1
        )
        + "\n"
    )
    return {"sorted": rows, "mesh_of": mesh_of}


def choice(row: dict[str, Any]) -> dict[str, Any]:
    """A finger in front.json: lines per tension, and errors as 95th percentiles [-]."""
    errors = {quantity: row[quantity]["p95"] for quantity in ("contact_force", "displacement")}
    return {key: row[key] for key in KEPT} | errors | {"lines": row["lines"] / TENSIONS}


def draw(rows: list[dict], fingers: dict, file: Path) -> None:
    """Cost against error of every finger, and the error of its mesh."""
    large_letters()
    figure, ax = plt.subplots(figsize=(8, 5.6), layout="constrained")
    for mesh in fingers["meshes"]:
        (points,) = ax.loglog(*_curve([row for row in rows if mesh_of(row) == mesh["name"]]), "o", label=mesh["name"])
        ax.axhline(100 * mesh["contact_force"]["p95"], color=points.get_color(), lw=0.8, ls="--")
    ax.loglog(*_curve([row for row in rows if row["name"] in fingers["front"]]), "k-", lw=1, label="front")
    ax.set(xlabel="training [core-seconds]", ylabel="error of contact force, 95th percentile [%]")
    ax.set_title("dashed: error of the mesh alone")
    logarithmic(ax)
    ax.legend()
    ax.grid(True, alpha=0.3)
    figure.savefig(file, dpi=110)
    plt.close(figure)


def mesh_of(row: dict) -> str:
    """A finger's mesh, as in the table of meshes."""
    return words((*row["cells"], row["order"]))


def _curve(rows: list[dict]) -> tuple[list[float], list[float]]:
    return [row["core_seconds"] for row in rows], [100 * row["contact_force"]["p95"] for row in rows]

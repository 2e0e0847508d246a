"""The picture of docs/speed.md, and fingerfem/scene/front.json, from which scenes choose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from fingerfem.scene.presets import FRONT
from studies.axes import large_letters, logarithmic
from studies.sections import DOCS

KEPT = "cells", "order", "coarse", "preset", "core_seconds", "states"  # of a row, in front.json
TENSIONS = 2  # of the draft finger; front.json has lines per tension


def prepare(found: dict, folder: Path) -> dict:
    """Write picture and front."""
    draw(found["fingers"]["rows"], found["fingers"]["meshes"], DOCS / "tradeoff.png")
    chosen = [choice(row) for row in found["fingers"]["rows"] if row["preset"] or row["front"]]
    FRONT.write_text(json.dumps({"rods": chosen}, indent=1) + "\n")
    return {}


def choice(row: dict[str, Any]) -> dict[str, Any]:
    """A finger in front.json: lines per tension, and errors as 95th percentiles [-]."""
    errors = {quantity: row[quantity]["p95"] for quantity in ("contact_force", "displacement")}
    return {key: row[key] for key in KEPT} | errors | {"lines": row["lines"] / TENSIONS}


def draw(rows: list[dict], meshes: list[dict], file: Path) -> None:
    """Cost against error of every finger, and the error of its mesh."""
    large_letters()
    figure, axes = plt.subplots(figsize=(8, 5.6), layout="constrained")
    for name, own, style in (
        *((mesh["name"], [row for row in rows if row["name"] == mesh["name"]], "o") for mesh in meshes),
        ("front", [row for row in rows if row["front"]], "k-"),
    ):
        errors = [100 * row["contact_force"]["p95"] for row in own]
        axes.loglog([row["core_seconds"] for row in own], errors, style, label=name)
    for k, mesh in enumerate(meshes):
        axes.axhline(100 * mesh["contact_force"]["p95"], color=f"C{k}", lw=0.8, ls="--")
    axes.set(xlabel="training [core-seconds]", ylabel="error of contact force, 95th percentile [%]")
    axes.set_title("dashed: error of the mesh alone")
    logarithmic(axes)
    axes.legend()
    figure.savefig(file, dpi=110)
    plt.close(figure)

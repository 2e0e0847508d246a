"""The picture of docs/tradeoff.md, and fingerfem/scene/front.json, from which scenes choose."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt

from fingerfem.scene.presets import FRONT
from studies.axes import large_letters, logarithmic
from studies.runner import DOCS
from studies.tradeoff.rods import FINE, SQUARE, RodTraining
from studies.tradeoff.tradeoff import DRAFT, PRESETS, error_of, front

WORTH = "total", "contact_force", "p95"  # the error that models are compared by
USUAL = 3e-4  # tolerance of the separation
ROD_PRESETS = {
    "draft": RodTraining(SQUARE, 8),
    "standard": RodTraining(FINE, 12),
    "fine": RodTraining(FINE, 24),
}
NAMES = {"mor": "e_MOR", "total": "total"}


def prepare(found: dict, folder: Path) -> dict:
    """Write picture and front; the choices that a scene has."""
    draw(found["tradeoff"], found["rods"], DOCS / "tradeoff.png")
    listed = choices(found["tradeoff"])
    rods = rod_choices(found["rods"])
    FRONT.write_text(json.dumps({"choices": listed, "rods": rods}, indent=1) + "\n")
    return {"choices": listed, "rod_choices": rods, "mesh_of": mesh_of, "ahead": ahead(found)}


def ahead(found: dict) -> list[dict]:
    """Of every surrogate of the front, the cheapest rod whose error is as small, or None, and how much cheaper it is."""
    plain, rods, listed = found["tradeoff"], found["rods"]["rods"], []
    best = [row for row in plain["models"] if row["name"] in plain["front"]]
    for row in sorted(best, key=lambda row: row["core_seconds"]):
        as_good = [one for one in rods if error_of(one, WORTH) <= error_of(row, WORTH)]
        cheapest = min(as_good, key=lambda one: one["core_seconds"], default=None)
        listed.append(
            {
                "surrogate": row,
                "rod": cheapest,
                "cheaper": cheapest and row["core_seconds"] / cheapest["core_seconds"],
            }
        )
    return listed


def choices(found: dict) -> list[dict]:
    """What a scene can choose: models of one mesh by lines that none beats in cost and error, and the presets."""
    of_mesh = {row["name"]: row["fem"] for row in found["meshes"]}
    plain = [
        row for row in found["models"] if row["training"]["coarse"] is None and "lines" in row["training"]["sampling"]
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


def rod_choices(found: dict) -> list[dict]:
    """The same of scenes with a load, which are trained as rod elements."""
    names = {training.name: preset for preset, training in ROD_PRESETS.items()}
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
    """Cost against error of every surrogate and rod, and both parts of the error against the states of the draft mesh."""
    large_letters()
    usual = [row for row in found["models"] if row["training"]["tolerance"] == USUAL]
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 6.8), layout="constrained")
    kinds: dict[str, list[dict]] = {}
    for row in usual:
        kinds.setdefault("two meshes" if row["training"]["coarse"] else mesh_of(row), []).append(row)
    for label, rows in sorted(kinds.items()):
        left.loglog(*_curve(rows, "total"), "s" if label == "two meshes" else "o", label=label)
    best = [next(row for row in found["models"] if row["name"] == name) for name in found["front"]]
    left.loglog(*_curve(best, "total"), "k-", lw=1, label="front of surrogates of a plane")
    left.loglog(*_curve(rods["rods"], "total"), "^", color="tab:red", label="rods")
    best = [next(row for row in rods["rods"] if row["name"] == name) for name in rods["front"]]
    left.loglog(*_curve(best, "total"), "-", color="tab:red", lw=1, label="front of rods")
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
    right.set(xlabel="training states", title="dotted: surrogate, dashed: mesh, solid: total")
    for ax in (left, right):
        logarithmic(ax)
        ax.set_ylabel("error of contact force, 95th percentile [%]")
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
        ax.grid(True, alpha=0.3)
    figure.savefig(file, dpi=110)
    plt.close(figure)


def mesh_of(row: dict) -> str:
    """A model's mesh, for people."""
    mesh = row["training"]["mesh"]
    return f"{mesh['cells'][0]} x {mesh['cells'][1]}, order {mesh['order']}"


def _curve(rows: list[dict], key: str, cost: str = "core_seconds") -> tuple[list[float], list[float]]:
    return [row[cost] for row in rows], [100 * row[key]["contact_force"]["p95"] for row in rows]

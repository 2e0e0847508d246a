"""The pictures of docs/appendix.md, and what their captions say."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from fingerfem import load_scene
from fingerfem.output.sketch import write_sketch
from studies.parts import ROOT
from studies.sections import DOCS

SKETCHED = "one_segment"  # scene
MM = 1e3  # millimetres per metre
COLOURS = ("#1565c0", "#2e7d32", "#e07000")  # of forces
FONT, DOTS_PER_INCH = 13, 110
ENDS = 1e-4, 1e-1  # of the errors' colours [N]


def prepare(found: dict, folder: Path) -> dict:
    """Copy the renders, draw the others."""
    for name in found["figures"]:
        shutil.copy(folder / f"{name}.png", DOCS)
    write_sketch(load_scene(ROOT / "scenes" / f"{SKETCHED}.toml"), DOCS / "sketch.png")
    with plt.rc_context({"font.size": FONT}):
        draw_held(found["held"], DOCS / "held.png")
        draw_errors(found["errors"], DOCS / "errors.png")
    return {"sketched": SKETCHED, "held_words": held_words(found["held"]), "error_words": error_words(found["errors"])}


def held_words(held: dict) -> dict:
    """Of forces held: how far the full-order model's are off, and what has no answer."""
    off = [abs(one["full_order"] - one["force"]) for one in held["checked"]]
    statuses = [row["status"] for row in held["rows"]]
    return {
        "checked": len(off),
        "covered": sum(error <= one["estimate"] for error, one in zip(off, held["checked"], strict=True)),
        "largest": max(error / one["force"] for error, one in zip(off, held["checked"], strict=True)),
        "forces": [f"{force:g}" for force in sorted({row["force"] for row in held["rows"]})],
        "rows": len(statuses),
        "counts": {status: statuses.count(status) for status in ("converged", "unreachable", "out_of_domain")},
    }


def error_words(errors: dict) -> dict:
    """Of true errors: how many states, how many within the estimate, the largest where an answer is inside."""
    inside = [one for one in errors["checked"] if one["inside"]]
    return {
        "checked": len(errors["checked"]),
        "inside": len(inside),
        "covered": sum(one["error"] <= one["estimate"] for one in inside),
        "largest": max(one["error"] for one in inside),
    }


def draw_held(held: dict, picture: Path) -> None:
    """Tensions above, the held force's error below, over the plane's distance."""
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 8), sharex=True, layout="constrained")
    for force, colour in zip(sorted({row["force"] for row in held["rows"]}), COLOURS, strict=True):
        rows = [row for row in held["rows"] if row["force"] == force]
        _tensions(above, rows, held["names"], colour)
        good = [row for row in rows if row["status"] == "converged"]
        band = np.array([100 * row["estimate"] / force for row in good])
        away = [MM * row["distance"] for row in good]
        below.fill_between(away, -band, band, color=colour, alpha=0.22, lw=0)
        below.plot(away, band, color=colour, lw=1.2)
        below.plot(away, -band, color=colour, lw=1.2)
        checked = [one for one in held["checked"] if one["force"] == force]
        off = [100 * (one["full_order"] / force - 1) for one in checked]
        below.plot([MM * one["distance"] for one in checked], off, "o", color=colour, mec="black", ms=7)
    _explain_held(above, below)
    above.set(ylabel="tension [N]", ylim=(-3, 108))
    below.set(xlabel="distance d of the plane [mm]", ylabel="error of the held force [%]")
    below.axhline(0, color="0.4", lw=0.8)
    for axes in (above, below):
        axes.grid(color="0.9")
    figure.savefig(picture, dpi=DOTS_PER_INCH)
    plt.close(figure)


def _tensions(axes: Axes, rows: list[dict], names: list[str], colour: str) -> None:
    """Of one force: lines where it is held, crosses where it is out of reach, rings where the model gives no answer."""
    away = np.array([MM * row["distance"] for row in rows])
    pulled = np.array([row["tensions"] for row in rows])
    status = np.array([row["status"] for row in rows])
    held = np.where((status == "converged")[:, None], pulled, np.nan)
    for k, dashes in zip(range(len(names)), ("-", "--"), strict=True):
        label = f"{rows[0]['force']:g} N" if k == 0 else None
        axes.plot(away, held[:, k], ls=dashes, color=colour, lw=2, label=label)
    for kind, marker in (("unreachable", "x"), ("out_of_domain", "o")):
        chosen = status == kind
        axes.plot(away[chosen], pulled[chosen, 0], marker, color=colour, mfc="none", ms=6)


def _explain_held(above: Axes, below: Axes) -> None:
    """Legends: forces, then kinds of lines and marks."""
    forces = above.legend(title="force held", loc="upper left", frameon=False)
    above.add_artist(forces)
    kinds = [
        above.plot([], [], ls, color="0.2", mfc="none", label=label)[0]
        for ls, label in (("-", "F1"), ("--", "F2"), ("x", "F1, unreachable"), ("o", "F1, out of domain"))
    ]
    above.legend(handles=kinds, loc="upper center", bbox_to_anchor=(0.4, 1.0), frameon=False)
    marks = [
        below.fill_between([], [], [], color="0.5", alpha=0.3, label="estimated error"),
        below.plot([], [], "o", color="0.6", mec="black", label="full-order model")[0],
    ]
    below.legend(handles=marks, loc="upper left", frameon=False)


def draw_errors(errors: dict, picture: Path) -> None:
    """The estimate over F1 and d, hatched where it is no promise; true errors as discs on the same scale."""
    tensions, distances = np.array(errors["tensions"]), MM * np.array(errors["distances"])
    estimate = np.array(errors["estimate"], float)
    unpromised = ~np.array(errors["inside"]) & np.isfinite(estimate)
    figure, axes = plt.subplots(figsize=(9, 6.6), layout="constrained")
    scale = LogNorm(*ENDS)
    mesh = axes.pcolormesh(tensions, distances, estimate, norm=scale, cmap="viridis", shading="nearest")
    axes.contourf(tensions, distances, unpromised, levels=[0.5, 1.5], colors="none", hatches=["xx"])
    axes.plot(tensions, MM * np.array(errors["touch"]), color="#d50000", lw=2.5)
    for inside, marker in ((True, "o"), (False, "s")):
        chosen = [one for one in errors["checked"] if one["inside"] == inside]
        points = np.array([one["point"] for one in chosen]).reshape(-1, 3)
        values = [max(one["error"], ENDS[0]) for one in chosen]
        axes.scatter(
            points[:, 0],
            MM * points[:, 2],
            c=values,
            norm=scale,
            cmap="viridis",
            marker=marker,
            s=110,
            ec="white",
            lw=1.5,
            clip_on=False,
            zorder=3,
        )
    axes.text(30, 24, "no contact", ha="center", fontsize=FONT)
    axes.set(
        xlabel="tension F1 [N], F2 = 0", ylabel="distance d of the plane [mm]", ylim=distances[[0, -1]], xlim=(0, 101)
    )
    figure.colorbar(mesh, ax=axes, label="error of the contact force [N]", extend="min")
    _explain_errors(axes)
    figure.savefig(picture, dpi=DOTS_PER_INCH)
    plt.close(figure)


def _explain_errors(axes: Axes) -> None:
    """A legend below the axes."""
    handles: list[Any] = [
        axes.plot([], [], color="#d50000", lw=2.5, label="touch")[0],
        axes.fill_between([], [], [], fc="none", ec="0.2", hatch="xx", label="not inside"),
        axes.plot([], [], "o", ms=10, color="#31688e", mec="white", label="true error")[0],
    ]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False)

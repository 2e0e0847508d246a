"""The pictures of docs/appendix.md, and what their captions say."""

from __future__ import annotations

import shutil
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from fingerfem import load_scene
from fingerfem.output.sketch import write_sketch
from studies.parts import ROOT
from studies.sections import DOCS

SKETCHED = "one_segment"  # scene
MM = 1e3  # millimetres per metre
COLOURS = ("#1565c0", "#2e7d32", "#e07000")  # of forces
FONT, DOTS_PER_INCH = 13, 110


def prepare(found: dict, folder: Path) -> dict:
    """Copy the renders, draw the others."""
    for name in found["figures"]:
        shutil.copy(folder / f"{name}.png", DOCS)
    write_sketch(load_scene(ROOT / "scenes" / f"{SKETCHED}.toml"), DOCS / "sketch.png")
    with plt.rc_context({"font.size": FONT}):
        draw_held(found["held"], DOCS / "held.png")
    return {"sketched": SKETCHED, "held_words": held_words(found["held"])}


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

"""The picture of docs/surrogate.md."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from studies.axes import large_letters, logarithmic
from studies.runner import DOCS

COLOURS = {"both meshes": "tab:blue", "fine mesh alone": "tab:orange"}


def prepare(found: dict, folder: Path) -> dict:
    """Draw the picture; the page shows nothing besides what was measured."""
    draw(found["two_meshes"], DOCS / "two_meshes.png")
    return {
        "scenes": {
            "draft": "draft",
            "standard": "draft finger, 10 x 5 cells of order 2",
            "two segments": "two segments",
        }
    }


def draw(found: dict, file: Path) -> None:
    """Errors of contact force against states on the fine mesh."""
    large_letters()
    figure, ax = plt.subplots(figsize=(8, 5.2), layout="constrained")
    for kind, colour in COLOURS.items():
        rows = [row for row in found["rows"] if row["kind"] == kind]
        states = [row["states"] for row in rows]
        label = f"{kind} (draft mesh: {found['coarse_states']:,} states)" if kind == "both meshes" else kind
        medians = [100 * row["surrogate"]["median"] for row in rows]
        ax.loglog(states, medians, "o-", color=colour, label=f"{label}, median")
        tail = [100 * row["surrogate"]["p95"] for row in rows]
        ax.loglog(states, tail, "s:", color=colour, mfc="none", label="95th percentile")
    ax.set(xlabel="states on the fine mesh", ylabel="error of the contact force on its mesh [%]")
    logarithmic(ax)
    ax.grid(True, alpha=0.3)
    ax.legend()
    figure.savefig(file, dpi=110)
    plt.close(figure)

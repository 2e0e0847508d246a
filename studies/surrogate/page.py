"""The picture of docs/surrogate.md, after figure 9 of the paper."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

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
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    for ax, key, title in (
        (axes[0], "surrogate", "of the surrogate, against its mesh"),
        (axes[1], "total", f"of both, against a third mesh ({found['reference_states']} states)"),
    ):
        for kind, colour in COLOURS.items():
            rows = [row for row in found["rows"] if row["kind"] == kind]
            states = [row["states"] for row in rows]
            label = f"{kind} (draft mesh: {found['coarse_states']:,} states)" if kind == "both meshes" else kind
            ax.loglog(states, [100 * row[key]["median"] for row in rows], "o-", color=colour, label=f"{label}, median")
            tail = [100 * row[key]["p95"] for row in rows]
            ax.loglog(states, tail, "s:", color=colour, mfc="none", label="95th percentile")
        for name, style in (("draft", "--"), ("standard", "-.")):
            error = 100 * found["mesh"][name]["median"]
            ax.axhline(error, color="black", linestyle=style, label=f"error of the {name} mesh, median")
        ax.set(title=title, xlabel="states on the fine mesh")
        ax.grid(True, which="both", alpha=0.2)
    axes[0].set_ylabel("relative error of the contact force [%]")
    axes[1].legend(fontsize=7)
    figure.savefig(file, dpi=110)
    plt.close(figure)

"""The picture and the tables of docs/peers.md."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from studies.axes import large_letters, logarithmic
from studies.peers.question import CONTACT, FREE, finger
from studies.sections import DOCS

COLOURS = {"finite elements": "tab:blue", "beam": "tab:green", "reduced model": "tab:orange"}
PANELS = {"free_tips": "tip in free space", "contact_forces": "contact force on the plane"}
MARKERS = "os^vDPX*<>"
FREE_TIPS, PRESSED = "free_tips", ("contact_tips", "contact_forces")
LEAST = 1e-5  # smallest error that is drawn [-]


def prepare(found: dict, folder: Path) -> dict:
    """Draw the picture; every alternative with its errors, and the tables."""
    reference = found["reference"]
    every = [*reference["ours"], *found["ours"], *found["beams"]]
    rows = [row | {"errors": errors(row, reference["finest"])} for row in every]
    draw(rows, DOCS / "peers.png")
    rows.sort(key=lambda row: row["errors"]["contact_forces"]["median"])
    return {
        "kinds": {kind: [row for row in rows if row["kind"] == kind] for kind in COLOURS},
        "apart": errors(reference["finer"], reference["finest"]),
        "unanswered": unanswered,
        "free": [int(tension) for tension in FREE],
        "contact": CONTACT,
        "finger": finger(),
    }


def unanswered(row: dict[str, Any]) -> str:
    """The states without an answer, in words."""
    free = [f"{FREE[k]:g} N in free space" for k in row["errors"]["missing_free"]]
    pressed = [f"{CONTACT[k][0]:g} N at {1000 * CONTACT[k][1]:g} mm" for k in row["errors"]["missing_contact"]]
    return ", ".join([*free, *pressed])


def errors(answers: dict[str, Any], reference: dict[str, Any]) -> dict[str, Any]:
    """Median and largest relative errors of one alternative [-], and the numbers of states without an answer."""
    found: dict[str, Any] = {}
    missing: dict[str, set[int]] = {}
    for quantity in (FREE_TIPS, *PRESSED):
        pairs = list(zip(answers[quantity], reference[quantity], strict=True))
        off = [relative(one, true) for one, true in pairs if one is not None]
        found[quantity] = {"median": float(np.median(off)), "max": max(off)} if off else None
        missing[quantity] = {k for k, (one, _) in enumerate(pairs) if one is None} if off else set()
    pressed = set.union(*(missing[quantity] for quantity in PRESSED))
    return found | {"missing_free": sorted(missing[FREE_TIPS]), "missing_contact": sorted(pressed)}


def relative(answered: float | Sequence[float], truth: float | Sequence[float]) -> float:
    """Distance over the true one's length [-]."""
    return float(np.linalg.norm(np.subtract(answered, truth)) / np.linalg.norm(truth))


def draw(rows: list[dict[str, Any]], file: Path) -> None:
    """Error against time per answer; a marker for every alternative."""
    large_letters()
    figure, panels = plt.subplots(1, 2, figsize=(14, 6), layout="constrained", sharex=True)
    for axes, (quantity, title) in zip(panels, PANELS.items(), strict=True):
        for row, marker in zip(rows, MARKERS, strict=False):
            error = 100 * max(row["errors"][quantity]["median"], LEAST)
            axes.loglog(row["seconds"], error, marker, ms=10, color=COLOURS[row["kind"]], label=row["name"])
        axes.set(xlabel="core-seconds per answer", ylabel="relative error, median [%]", title=title)
        axes.margins(0.1)
        logarithmic(axes)
        axes.grid(True, alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    figure.savefig(file, dpi=110)
    plt.close(figure)

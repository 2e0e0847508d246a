"""The picture and the tables of docs/peers.md."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from studies.axes import large_letters, logarithmic
from studies.peers.errors import compared, errors
from studies.peers.ours import ASIDE, trained
from studies.peers.question import CONTACT, FREE, finger
from studies.sections import DOCS

COLOURS = {"finite elements": "tab:blue", "beam": "tab:green", "reduced model": "tab:orange"}
PANELS = {"free_tips": "tip in free space", "contact_forces": "contact force on the plane"}
MARKERS = "os^vDPX*<>"
LEAST = 1e-5  # smallest error that is drawn [-]


def prepare(found: dict, folder: Path) -> dict:
    """Draw the picture; every alternative with its errors, and the tables."""
    reference = found["reference"]
    every = [*reference["ours"], *found["ours"], *found["rods"]]
    rows = compared(every, reference["finest"])
    draw(rows, DOCS / "peers.png")
    return {
        "kinds": {kind: sorted((row for row in rows if row["kind"] == kind), key=_force_error) for kind in COLOURS},
        "apart": errors(reference["finer"], reference["finest"]),
        "unanswered": unanswered,
        "free": [int(tension) for tension in FREE],
        "contact": CONTACT,
        "finger": finger(),
        "within": within(reference["finest"]),
        "same": same(found["finite_elements"]),
    }


def unanswered(row: dict[str, Any]) -> str:
    """The states without an answer, in words."""
    free = [f"{FREE[k]:g} N in free space" for k in row["errors"]["missing_free"]]
    pressed = [f"{CONTACT[k][0]:g} N at {1000 * CONTACT[k][1]:g} mm" for k in row["errors"]["missing_contact"]]
    return ", ".join([*free, *pressed])


def within(reference: dict[str, Any]) -> list[dict[str, Any]]:
    """How many errors of contact states are within the two models' estimates, and how large these are."""
    truths = list(zip(reference["contact_tips"], reference["contact_forces"], strict=True))
    found = []
    for name, model in trained().items():
        estimates = [model.evaluate(np.array([tension, ASIDE, distance])) for tension, distance in CONTACT]
        pairs = list(zip(estimates, truths, strict=True))
        shares = [answer.error["contact_force"] / force for answer, (_, force) in pairs]
        found.append(
            {
                "name": name,
                "forces": sum(
                    abs(answer.contact_force - f) <= answer.error["contact_force"] for answer, (_, f) in pairs
                ),
                "tips": sum(np.linalg.norm(answer.tip - tip) <= answer.error["tip"] for answer, (tip, _) in pairs),
                "median": float(np.median(shares)),
                "max": float(max(shares)),
            }
        )
    return found


def same(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Largest differences from FElupe by scene, law, mesh and method."""
    found: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        found.setdefault(repr([row[key] for key in ("scene", "law", "mesh", "method")]), []).append(row)
    return [
        {key: of[0][key] for key in ("scene", "law", "method", "unknowns")}
        | {"cells": " x ".join(map(str, of[0]["mesh"]["cells"])), "order": of[0]["mesh"]["order"], "states": len(of)}
        | {"failed": sum(row["failed"] is not None for row in of)}
        | {"displacement": _largest(of, "displacement_difference")}
        | {"contact_force": _largest(of, "contact_force_difference")}
        for of in found.values()
    ]


def _largest(rows: list[dict[str, Any]], key: str) -> float | None:
    return max((row[key] for row in rows if row[key] is not None), default=None)


def _force_error(row: dict[str, Any]) -> tuple[float, float]:
    """What a table is sorted by: contact force, then tip; who has no contact force comes last."""
    force, tip = row["errors"]["contact_forces"], row["errors"]["free_tips"]
    return force["median"] if force else float("inf"), tip["median"] if tip else float("inf")


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

"""The picture of docs/accuracy.md."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from studies.axes import large_letters, logarithmic
from studies.sections import DOCS

ESTIMATES, ERRORS = (1e-3, 0.1), (1e-5, 0.1)  # ends of the axes [N]
FIRM = 0.1  # force from which relative errors are listed apart [N]


def prepare(found: dict, folder: Path) -> dict:
    """Draw true against estimated errors of the contact force."""
    large_letters()
    figure, axes = plt.subplots(figsize=(7, 5.5), layout="constrained")
    for (kind, row), marker in zip(found["coverage"].items(), "o^sD", strict=True):
        force = row["contact_force"]
        errors = [max(error, ERRORS[0]) for error in force["error"]]  # smaller ones at the edge
        axes.loglog(force["estimate"], errors, marker, clip_on=False, label=f"{kind}: {len(errors)} points")
    axes.loglog(ESTIMATES, ESTIMATES, color="0.5", lw=1, label="both equal")
    axes.set(xlim=ESTIMATES, ylim=ERRORS)
    logarithmic(axes)
    axes.set(xlabel="estimated error of the contact force [N]", ylabel="true error, against the finest mesh [N]")
    axes.legend(loc="upper left")
    figure.savefig(DOCS / "coverage.png", dpi=120)
    plt.close(figure)
    return {"largest": {kind: largest(row["contact_force"]) for kind, row in found["coverage"].items()}}


def largest(force: dict) -> float:
    """The largest relative error of contact forces above FIRM [-]."""
    return max(error / size for error, size in zip(force["error"], force["size"], strict=True) if size > FIRM)

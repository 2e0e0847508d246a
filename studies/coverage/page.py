"""The picture of docs/coverage.md."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from studies.runner import DOCS

ENDS = 1e-6, 0.3  # [N]
LEAST = 2e-6  # where smaller errors are drawn [N]


def prepare(found: dict, folder: Path) -> dict:
    """Draw true against estimated errors of the contact force."""
    figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
    for (kind, row), marker in zip(found["coverage"].items(), "o^s", strict=True):
        force = row["contact_force"]
        errors = [max(error, LEAST) for error in force["error"]]
        axes.loglog(force["estimate"], errors, marker, ms=4, label=f"{kind}: {len(errors)} points")
    axes.loglog(ENDS, ENDS, color="0.5", lw=1)
    axes.set(xlabel="estimated error of the contact force [N]", ylabel="true error, against the finest mesh [N]")
    axes.legend(frameon=False)
    figure.savefig(DOCS / "coverage.png", dpi=120)
    plt.close(figure)
    return {}

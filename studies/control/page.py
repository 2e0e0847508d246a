"""The pictures of docs/speed.md."""

from __future__ import annotations

import shutil
from pathlib import Path

import matplotlib.pyplot as plt

from studies.axes import large_letters, logarithmic
from studies.sections import DOCS

FORCES = 0.25, 4.0  # [N], ends of the picture


def prepare(found: dict, folder: Path) -> dict:
    """Draw and copy the pictures; the page shows nothing besides what was measured."""
    draw(found["verification"], DOCS / "control.png")
    shutil.copy(folder / "loop.png", DOCS / "loop.png")
    return {}


def draw(found: dict, picture: Path) -> None:
    """Held against wanted, and the errors by distance."""
    large_letters()
    solved = [case for case in found["each"] if case["force"] is not None]
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.6), layout="constrained")
    wanted = [case["target"] for case in solved]
    left.loglog(FORCES, FORCES, color="0.7", lw=1)
    left.loglog(wanted, [case["force"] for case in solved], "o", ms=4)
    left.set(
        xlabel="contact force wanted [N]", ylabel="held, by the full-order model [N]", title=f"{len(solved)} answers"
    )
    right.semilogy([1e3 * case["distance"] for case in solved], [100 * case["error"] for case in solved], "o", ms=4)
    right.axhline(100 * found["median"], color="0.4", lw=1, ls="--", label=f"median {found['median']:.2%}")
    right.axhline(100 * found["max"], color="0.4", lw=1, ls=":", label=f"largest {found['max']:.1%}")
    right.set(xlabel="distance of the plane [mm]", ylabel="error of the held force [%]")
    right.legend(frameon=False, loc=(0.42, 0.68))
    logarithmic(left)
    logarithmic(right, "y")
    figure.savefig(picture, dpi=120)
    plt.close(figure)

"""The finger of the study: elements of the draft mesh, on which full-order solves are cheap."""

from __future__ import annotations

from studies.parts import Run
from studies.rods import plans

FILE = "finger.h5"


def measure(run: Run) -> dict[str, int]:
    """Write it for the other parts; the number of its elements."""
    rod = plans.rod(run, plans.LARGE)
    rod.save(run.folder / FILE)
    return {"elements": sum(len(segment.elements) for segment in rod.segments)}

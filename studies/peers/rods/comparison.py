"""Part `rods`: two beams, asked the same; needs PyElastica."""

from __future__ import annotations

from studies.parts import Run
from studies.peers.rods import constant_curvature, cosserat_rod


def measure(run: Run) -> list[dict]:
    """Their answers."""
    return [constant_curvature.measure().as_json(), cosserat_rod.measure().as_json()]

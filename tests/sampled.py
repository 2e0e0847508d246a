"""Points at which tests ask models, and tables from few points."""

from dataclasses import replace

import numpy as np
import pytest

import rom
from rom.separated import rod_source


def tabled(nearest: float, nodes: int):
    """The table of the bundled finger before the plane y = side/2 + d, d from the nearest to 0.031 m; in seconds."""
    finger = rom.load()
    with pytest.MonkeyPatch.context() as patch:
        for name in ("CALIBRATING", "MEASURING"):
            patch.setattr(rod_source, name, 4000)
        return rom.specialise(replace(finger, obstacle=replace(finger.obstacle, distances=(nearest, 0.031))), nodes)


def some_points(model, count: int) -> np.ndarray:
    """In the trained box and beyond it, and what is no number."""
    random, (lower, upper) = np.random.default_rng(0), model.limits
    points = lower + (upper - lower) * (1.2 * random.random((count, len(lower))) - 0.1)
    for value in (np.nan, np.inf, -np.inf):
        for k in range(len(lower)):
            points[random.integers(count), k] = value
    return points

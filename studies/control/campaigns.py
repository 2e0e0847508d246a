"""Campaigns of holds: how many converge, how long they take, and whether what is called unreachable is."""

from __future__ import annotations

import numpy as np

from control import campaign
from control.least_squares import OUTSIDE, STATIONARY
from control.model import Model
from rom.answer import FORCE
from studies.control.models import PAPER_US, TARGET, finger
from studies.parts import Run

GRID = 2_500  # points of a dense search
CROSSINGS = 45  # bisections


def dense_search(model: Model, found: campaign.Campaign) -> dict:
    """Every answer that is called unreachable, sought on a grid of tensions, and along its edges that cross the target.

    A force may jump; an edge across a jump crosses the target without ever holding it.
    """
    lower, upper = found.lower, found.upper
    nodes = round(GRID ** (1 / len(lower)))
    axes = [np.linspace(low, high, nodes) for low, high in zip(lower, upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def force(tensions: np.ndarray, distance: float) -> np.ndarray:
        points = np.column_stack([tensions.reshape(-1, len(lower)), np.full(tensions[..., 0].size, distance)])
        return np.asarray(model.outputs(points)[:, FORCE]).reshape(tensions.shape[:-1])

    flagged = np.flatnonzero(found.status == STATIONARY)
    wrong, jumps, target = 0, 0, found.contact_force
    for i in flagged:
        distance = float(found.distances[i])
        here = force(grid, distance)
        if here.max() < target:
            continue
        missed = [np.inf]
        for axis in range(len(lower)):
            forces, points = np.moveaxis(here, axis, 0) - target, np.moveaxis(grid, axis, 0)
            crossing = forces[:-1] * forces[1:] < 0
            begin, end, sign = points[:-1][crossing], points[1:][crossing], np.sign(forces[:-1][crossing])
            for _ in range(CROSSINGS):
                middle = (begin + end) / 2
                same = (np.sign(force(middle, distance) - target) == sign)[:, None]
                begin, end = np.where(same, middle, begin), np.where(same, end, middle)
            missed += np.abs(force((begin + end) / 2, distance) - target).tolist()
        wrong += min(missed) <= 1e-6
        jumps += min(missed) > 1e-6
    return {"flagged": len(flagged), "wrong": int(wrong), "jumps": int(jumps), "grid": nodes ** len(lower)}


def solves(starts: int, sweep: bool) -> dict:
    """Random starts or the authors' sweep, every flag looked at."""
    model = finger()
    result = campaign.run(model, starts, TARGET, sweep)
    outside = int(np.sum(result.status == OUTSIDE))
    return result.as_json() | {"dense_search": dense_search(model, result), "out_of_domain": outside}


def measure(run: Run) -> dict:
    """Both, and the paper's mean time."""
    starts = 10_000
    kinds = {"random": False, "sweep": True}
    return {"paper_us": PAPER_US} | {kind: run.once(kind, solves, starts, sweep) for kind, sweep in kinds.items()}

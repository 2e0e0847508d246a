"""Campaigns of holds: how many converge, how long they take, and whether what is called unreachable is."""

from __future__ import annotations

import numpy as np

from control import campaign
from control.least_squares import OUTSIDE, STATIONARY
from control.model import Model
from rom.answer import FORCE
from studies.control.models import PAPER_US, TARGET, finger
from studies.parts import Run

STARTS, NODES = 10_000, 50  # holds of a campaign; tensions of each tendon in a dense search


def dense_search(model: Model, found: campaign.Campaign) -> dict:
    """Number of distances called unreachable that have tensions on a grid with at least the target's force.

    The force is continuous and zero at rest: these tensions would prove that the target can be held.
    """
    axes = [np.linspace(low, high, NODES) for low, high in zip(found.lower, found.upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    distances = found.distances[found.status == STATIONARY]
    largest = [model.outputs(np.column_stack([grid, np.full(len(grid), d)]))[:, FORCE].max() for d in distances]
    return {"grid": len(grid), "reachable": int(np.sum(np.array(largest) >= found.contact_force))}


def solves(sweep: bool) -> dict:
    """Random starts or the authors' sweep, every unreachable target sought."""
    model = finger()
    result = campaign.run(model, STARTS, TARGET, sweep)
    outside = int(np.sum(result.status == OUTSIDE))
    return result.as_json() | {"dense_search": dense_search(model, result), "out_of_domain": outside}


def measure(run: Run) -> dict:
    """Both, and the paper's mean time."""
    kinds = {"random": False, "authors' sweep": True}
    return {"paper_us": PAPER_US} | {kind: run.once(kind, solves, sweep) for kind, sweep in kinds.items()}

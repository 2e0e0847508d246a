"""A grid of contact states in contact-aligned coordinates: what a decomposition of whole tensors needs.

Scattered states, which all others learn from, are no tensor. Along the grid's axes lie the lead tension above its
onset, the other tension, and the plane's way from touch to its nearest, so that there is no kink within: the grid, and
the coordinates of the points where it is asked, are this project's gift.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from rom.build import train
from rom.held_out import FELT, split
from rom.separated.alternating_directions import EnrichmentOptions
from rom.snapshots.snapshot_set import SnapshotSet
from rom.surrogate import Surrogate
from studies import sets
from studies.runner import Run

GRID, SCATTERED = "draft grid", "draft"  # scenes of one finger on one mesh: the second has held-out states
OPTIONS = EnrichmentOptions()


def aligned(points: np.ndarray, grid: SnapshotSet, model: Surrogate) -> np.ndarray:
    """Coordinates on the grid of points, shape (n, p) [N, m]: the lead's share above onset, and the plane's way."""
    description, lead = grid.description, grid.description.lead
    (other,) = description.other_axes
    onset = CubicSpline(description.tension_nodes[other], grid.onset())(points[:, other])
    reach, (lower, upper) = model.evaluate(points).touch_distance, model.limits
    found = points.copy()
    found[:, lead] = (points[:, lead] - onset) / (upper[lead] - onset)
    found[:, -1] = (reach - points[:, -1]) / (reach - lower[-1])
    return np.clip(found, 0, np.append(upper[:-1], 1))


def write(file: Path, grid: SnapshotSet, tested: SnapshotSet) -> int:
    """The grid's tips and forces, its axes, and the felt test states in its coordinates (npz); how many states."""
    description, lead = grid.description, grid.description.lead
    axes = [np.array(nodes) for nodes in (*description.tension_nodes, description.contact_nodes)]
    axes[lead] = np.array(description.onset_nodes)
    named: dict[str, Any] = {f"axis_{k}": axis for k, axis in enumerate(axes)}
    force = tested.random("contact_force")
    felt = force > FELT
    np.savez(
        file,
        values=np.concatenate([grid.contact("tip"), grid.contact("contact_force")[..., None]], axis=-1),
        points=aligned(tested.random("parameters"), grid, train(grid, OPTIONS))[felt],
        tip=tested.random("tip")[felt],
        force=force[felt],
        **named,
    )
    return grid.states


def measure(run: Run) -> int:
    """Write the grid of the draft finger; how many states it has, free ones included."""
    grid = sets.training(sets.scene(run.sets, GRID, run.quick))
    grid.description = sets.without_store(grid.description)
    file = sets.scene(run.sets, SCATTERED, run.quick)
    sets.training(file)  # held-out states begin at the nearest of it
    held_out = sets.held_out(file, sets.QUICK_HELD_OUT if run.quick else sets.HELD_OUT)
    return write(run.folder / "grid.npz", grid, split(held_out)[1])

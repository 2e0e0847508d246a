"""Full-order states on the paper's grid -> a separated model (Chenevier et al. 2018), with its estimated errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rom.separated.alternating_directions import EnrichmentOptions
from rom.separated.grid_source import GridSource, check_grid
from rom.separated.model import SeparatedModel
from rom.separated.table_errors import Truth, with_errors
from rom.separated.tabulated import NODES, tabulated
from rom.snapshots.snapshot_set import SnapshotSet
from rom.terminal import Progress, quiet

FEWEST, FINER = 12, 3  # nodes of a table by default, at least, and over those of its grid
MODES, KEPT = 40, 1e-5  # of the displacement, at most; and the share of its size that they may leave [-]


def displacement_modes(snapshots: SnapshotSet) -> tuple[np.ndarray, np.ndarray] | None:
    """Nodes, shape (nodes, 3) [m], and POD modes of the displacement, shape (3 nodes, k); None if it is not stored."""
    if "displacement" not in snapshots.description.stored:
        return None
    fields = np.concatenate([snapshots.states_of(kind, "displacement") for kind in ("free", "contact")])
    _, sizes, modes = np.linalg.svd(fields.reshape(len(fields), -1), full_matrices=False)
    left = np.sqrt(np.cumsum(sizes[::-1] ** 2)[::-1] / np.sum(sizes**2))
    return snapshots.nodes, modes[: min(int(np.sum(left > KEPT)), MODES)].T


def truth_of(snapshots: SnapshotSet, has_pad: bool, has_field: bool) -> Truth:
    """All states of a set that have an answer."""
    points, names = snapshots.points(), ["contact_force", "touch_distance", *["pad_pressure"] * has_pad]
    out = np.column_stack([snapshots.answered("tip"), *(snapshots.answered(name) for name in names)])
    moved = snapshots.answered("displacement") if has_field else None
    return Truth(points, out, np.zeros((len(points), 3)), np.ones(len(points), bool), moved)


def separated_grid(
    snapshots: SnapshotSet,
    nodes: int | None = None,
    options: EnrichmentOptions | None = None,
    progress: Progress = quiet,
) -> SeparatedModel:
    """The table of full-order states on a grid, as the paper makes it.

    Its estimated errors are those of the table of every second node, at all states.

    Args:
        snapshots: a training set on a grid of one or two tensions.
        nodes: of every axis of the table, 4 at least; by default three times the grid's, from 12 to 32.
        options: of the separations.
        progress: called with the step, how much of it is done, and how much it is.

    Raises:
        SnapshotError: a set without such a grid.
        ValueError: fewer than 4 nodes.
    """
    check_grid(snapshots)
    axes = (*snapshots.description.tension_nodes, snapshots.description.contact_nodes)
    nodes = nodes or min(max(FEWEST, FINER * max(map(len, axes))), NODES)
    modes = displacement_modes(snapshots)
    whole, half = (GridSource(snapshots, every, options, modes) for every in (1, 2))
    table, fewer = (tabulated(one, nodes, options, progress) for one in (whole, half))
    judged = with_errors(fewer, truth_of(snapshots, whole.has_pad, modes is not None))
    return replace(table, errors=judged.errors, answered=judged.answered)

"""Full-order states on the paper's grid as a source (Chenevier et al. 2018): its nodes are the model's nodes."""

from __future__ import annotations

import numpy as np

from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.file_kinds import uses_of
from rom.parameter import Parameter
from rom.separated.tabulated import Source

MOST_TENSIONS, LEAST_NODES = 2, 3
DETERMINED = 1.4  # values for every number of the separated form [-]


def grid_source(snapshots: SnapshotSet, every: int = 1) -> Source:
    """A training set on a grid before the plane y = side/2 + d: states that failed are missing.

    Args:
        snapshots: the set.
        every: takes every so many-th node of every axis, and its last one.

    Raises:
        SnapshotError: a set without such a grid, of more than two tensions, or with fewer than 3 nodes of an axis.
    """
    description, path = snapshots.description, snapshots.path
    if description.random or description.has_load or not description.has_obstacle:
        raise SnapshotError(
            f"{path}: must be a training set before a plane, on a grid (sampling.tension_nodes and "
            f"contact_nodes){uses_of(path)}"
        )
    if description.tensions > MOST_TENSIONS:
        raise SnapshotError(f"{path}: must have {MOST_TENSIONS} tensions at most, got {description.tensions}")
    axes = [*description.tension_nodes, description.contact_nodes]
    if min(map(len, axes)) < LEAST_NODES:
        raise SnapshotError(f"{path}: must have {LEAST_NODES} nodes of every axis, got {min(map(len, axes))}")
    kept = [np.unique([*range(0, len(axis), every), len(axis) - 1]) for axis in axes]
    has_pad, p = "pad_pressure" in description.stored, len(axes)
    names = ["tip", "contact_force", "touch_distance", *["pad_pressure"] * has_pad]

    def sampled(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        free = bool(np.isinf(points[:, -1]).any())
        read, grid = (snapshots.free, np.ix_(*kept[:-1])) if free else (snapshots.contact, np.ix_(*kept))
        values = [read(name)[grid].reshape(len(points), -1) for name in names]
        slopes = [read(f"{name}_jacobian")[grid].reshape(len(points), -1, p) for name in names]
        if description.has_field:
            values.append(read("displacement")[grid].reshape(len(points), -1))
        return np.concatenate(values, axis=1), np.concatenate(slopes, axis=1)

    return Source(
        parameters=[Parameter(**one) for one in description.parameters],
        scene=description.scene,
        lead=description.lead,
        axes=[np.array(axis)[nodes] for axis, nodes in zip(axes, kept, strict=True)],
        sampled=sampled,
        determined=DETERMINED,
        has_pad=has_pad,
        nodes=snapshots.nodes if description.has_field else None,
    )

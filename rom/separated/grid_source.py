"""Full-order states on the paper's grid as samples (Chenevier et al. 2018): its nodes are the model's nodes."""

from collections.abc import Callable

import numpy as np

from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.files.file_kinds import uses_of
from rom.parameter import Parameter
from rom.separated.tabulated import Samples

MOST_TENSIONS = 2  # that are tested
DETERMINED = 1.4  # values for every number of the separated form [-]


def grid_samples(snapshots: SnapshotSet, every: int = 1) -> Samples:
    """The states of a training set on a grid before the plane y = side/2 + d; those that failed are missing.

    Args:
        snapshots: the set.
        every: takes every so many-th node of every axis, and its last one.

    Raises:
        SnapshotError: a set without such a grid.
    """
    description, path = snapshots.description, snapshots.path
    if description.random or description.has_load or not description.has_obstacle:
        rule = "must be a training set before a plane, on a grid (sampling.tension_nodes and contact_nodes)"
        raise SnapshotError(f"{path}: {rule}{uses_of(path)}")
    if description.actuators > MOST_TENSIONS:
        raise SnapshotError(f"{path}: must have {MOST_TENSIONS} tensions at most, got {description.actuators}")
    axes = [*description.tension_nodes, description.contact_nodes]
    kept = [np.unique([*range(0, len(axis), every), len(axis) - 1]) for axis in axes]
    names = ["tip", "contact_force", "touch_distance", *["pad_pressure"] * ("pad_pressure" in description.stored)]

    def read(of: Callable[[str], np.ndarray], nodes: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        shape, grid = [len(one) for one in nodes], np.ix_(*nodes)
        values = [of(name)[grid].reshape(*shape, -1) for name in [*names, *["displacement"] * description.has_field]]
        slopes = [of(f"{name}_jacobian")[grid].reshape(*shape, -1, len(axes)) for name in names]
        return np.concatenate(values, axis=-1), np.concatenate(slopes, axis=-2)

    return Samples(
        parameters=[Parameter(**one) for one in description.parameters],
        scene=description.scene,
        axes=[np.array(axis)[nodes] for axis, nodes in zip(axes, kept, strict=True)],
        free=read(snapshots.free, kept[:-1]),
        contact=read(snapshots.contact, kept),
        determined=DETERMINED,
        nodes=snapshots.nodes if description.has_field else None,
    )

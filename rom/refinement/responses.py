"""What a set's states say of the finger's response: functions on its grid, with derivatives where these are needed.

Free states are a function of the tensions. Contact states are one of the contact-aligned coordinates
(fit.contact_coordinates): what contact adds to the free state at the same tensions, zero where the plane is just
touched.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rom.refinement.completion import KnownGrid
from rom.snapshots.snapshot_set import SnapshotSet


def free_response(snapshots: SnapshotSet, values: np.ndarray, jacobian: np.ndarray | None) -> KnownGrid:
    """A quantity of the free states as a function of the tensions.

    Args:
        snapshots: the set.
        values: of the free states, shape (states, m).
        jacobian: by the parameters, shape (states, m, p); None where the set is not refined.
    """
    description = snapshots.description
    axes = [np.array(nodes) for nodes in description.tension_nodes]
    slopes = [] if jacobian is None else [jacobian[..., k] for k in range(description.tensions)]
    order = [description.lead, *description.other_axes]
    return _on_grid(axes, description.strides[: len(axes)], snapshots.positions("free"), values, slopes, order)


def contact_response(snapshots: SnapshotSet, values: np.ndarray, jacobian: np.ndarray | None) -> KnownGrid:
    """What contact adds to a quantity, as a function of the contact-aligned coordinates; arguments as above."""
    description, lead = snapshots.description, snapshots.description.lead
    positions = snapshots.positions("contact")
    axes = [np.array(nodes) for nodes in description.tension_nodes]
    axes[lead] = np.array(description.onset_nodes)
    axes.append(np.array(description.contact_nodes))
    at_touch = _touching(positions, [len(axis) for axis in axes[:-1]])
    slopes = [] if jacobian is None else _aligned(snapshots, positions, at_touch, jacobian)
    order = [lead, *description.other_axes, len(axes) - 1]
    whole = at_touch >= 0  # without the state at touch, nobody knows what contact adds
    added, slopes = (values - values[at_touch])[whole], [slope[whole] for slope in slopes]
    return _on_grid(axes, description.strides, positions[whole], added, slopes, order, (lead, len(axes) - 1))


def free_outputs(snapshots: SnapshotSet) -> tuple[np.ndarray, np.ndarray | None]:
    """Of the free states the tip and, where there is a plane, the heights of the nodes that lead the reach somewhere.

    Returns:
        values, shape (states, m) [m], and their jacobian, shape (states, m, p); None if the set is not refined.
    """
    names, refines = ["tip"], snapshots.description.refines
    values, jacobian = snapshots.values("free", "tip"), None
    if refines:
        jacobian = snapshots.values("free", "tip_jacobian")
    if snapshots.description.has_obstacle:
        names.append("edge_heights")
        heights = snapshots.values("free", "edge_heights")
        leading = np.unique(heights.argmax(axis=1))
        values = np.concatenate([values, heights[:, leading]], axis=1)
        if jacobian is not None:
            slopes = snapshots.values("free", "edge_heights_jacobian")[:, leading]
            jacobian = np.concatenate([jacobian, slopes], axis=1)
    return values, jacobian


def contact_outputs(snapshots: SnapshotSet) -> tuple[np.ndarray, np.ndarray | None]:
    """Of the contact states tip [m] and contact force [N], shape (states, 4), and their jacobian as above."""
    tip, force = snapshots.values("contact", "tip"), snapshots.values("contact", "contact_force")
    values = np.column_stack([tip, force])
    if not snapshots.description.refines:
        return values, None
    slopes = snapshots.values("contact", "contact_force_jacobian")
    return values, np.concatenate([snapshots.values("contact", "tip_jacobian"), slopes[:, None]], axis=1)


def _on_grid(
    axes: Sequence[np.ndarray],
    strides: Sequence[int],
    positions: np.ndarray,
    values: np.ndarray,
    slopes: Sequence[np.ndarray],
    order: Sequence[int],
    open_axes: Sequence[int] = (),
) -> KnownGrid:
    shape, where = tuple(len(axis) for axis in axes), tuple(positions.T)
    grids = [np.zeros((*shape, values.shape[1])) for _ in range(1 + len(slopes))]
    for grid, column in zip(grids, [values, *slopes], strict=True):
        grid[where] = column
    known = np.zeros(shape, bool)
    known[where] = True
    return KnownGrid(
        axes=axes, strides=strides, known=known, values=grids[0], slopes=grids[1:], order=order, open=open_axes
    )


def _touching(positions: np.ndarray, shape: list[int]) -> np.ndarray:
    """For every contact state the row of the state of its line at which the plane is just touched; -1 if none."""
    rows = np.full(shape, -1)
    first = np.flatnonzero(positions[:, -1] == 0)
    rows[tuple(positions[first, :-1].T)] = first
    return rows[tuple(positions[:, :-1].T)]


def _aligned(
    snapshots: SnapshotSet, positions: np.ndarray, at_touch: np.ndarray, jacobian: np.ndarray
) -> list[np.ndarray]:
    """Derivatives by the contact-aligned coordinates, each of shape (states, m), from those by the parameters.

    With d = D0(F) - s (D0(F) - d_min) and F_l = F_c(F') + xi (F_l,max - F_c(F')), by the chain rule.
    """
    description, lead = snapshots.description, snapshots.description.lead
    touch, slopes = (
        snapshots.values("contact", "touch_distance"),
        snapshots.values("contact", "touch_distance_jacobian"),
    )
    others = tuple(positions[:, description.other_axes].T)
    onset, onset_jacobian = snapshots.onset()[others], snapshots.onset("onset_jacobian")[others]
    onset_jacobian = np.broadcast_to(
        onset_jacobian, (len(positions), onset_jacobian.shape[-1])
    )  # of one tension there is one onset
    xi = np.array(description.onset_nodes)[positions[:, lead]]
    s = np.array(description.contact_nodes)[positions[:, -1]]
    by_distance = jacobian[..., -1]
    by_tension = [
        jacobian[..., k] - jacobian[at_touch][..., k] + by_distance * ((1 - s) * slopes[:, k])[:, None]
        for k in range(description.tensions)
    ]
    found = [
        by_tension[k] + by_tension[lead] * ((1 - xi) * onset_jacobian[:, k])[:, None]
        for k in range(description.tensions)
    ]
    found[lead] = by_tension[lead] * np.reshape(description.parameters[lead]["upper"] - onset, (-1, 1))
    nearest = description.parameters[-1]["lower"]
    return [*found, -by_distance * (touch - nearest)[:, None]]

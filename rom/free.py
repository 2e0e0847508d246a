"""The finger in free space: tip and heights of what may touch first, fitted as functions of the tensions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.polynomials import Fitted, Polynomial, Samples, fit
from rom.snapshots import SnapshotError, SnapshotSet


@dataclass(frozen=True, kw_only=True)
class Free:
    """Tip and heights of what may touch first, as functions of the tensions.

    Attributes:
        points: tensions of the free states, shape (n, tensions) [N].
        groups: of the states that are left out together, shape (n,).
        edges: nodes whose heights are among the values, after the tip's three components, shape (heights,).
        fitted: values [m].
    """

    points: np.ndarray
    groups: np.ndarray
    edges: np.ndarray
    fitted: Fitted

    @staticmethod
    def of(snapshots: SnapshotSet) -> Free:
        """Fit a set's free states."""
        description = snapshots.description
        count = description.tensions
        points = snapshots.states_of("free", "parameters")[:, :count]
        values, slopes = (snapshots.states_of("free", name) for name in ("tip", "tip_jacobian"))
        edges = np.zeros(0, int)
        if description.has_obstacle:
            heights = snapshots.states_of("free", "edge_heights")
            if np.abs(heights.max(axis=1) - snapshots.states_of("free", "touch_distance")).max() > 1e-6:
                raise SnapshotError(
                    f"{snapshots.path}: somewhere a face bulges farther towards the plane than its edges"
                )
            along = _long_edges(snapshots)
            kept = np.union1d(heights.argmax(axis=1), np.flatnonzero(_is_corner(snapshots, along)))
            edges, values = along[kept], np.concatenate([values, heights[:, kept]], axis=1)
            slopes = np.concatenate([slopes, snapshots.states_of("free", "edge_heights_jacobian")[:, kept]], axis=1)
        lower, upper = box(snapshots)
        samples = Samples(
            points=points,
            values=values,
            slopes=slopes[..., :count],
            weights=np.ones(len(points)),
            groups=np.arange(len(points)),
            lower=lower[:count],
            upper=upper[:count],
        )
        return Free(points=points, groups=samples.groups, edges=edges, fitted=fit(samples))

    @property
    def polynomial(self) -> Polynomial:
        """Tip, then heights."""
        return self.fitted.polynomial


def box(snapshots: SnapshotSet) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper end of a set's parameters, shapes (p,)."""
    parameters = snapshots.description.parameters
    return (
        np.array([parameter["lower"] for parameter in parameters], float),
        np.array([parameter["upper"] for parameter in parameters], float),
    )


def _long_edges(snapshots: SnapshotSet) -> np.ndarray:
    side = snapshots.description.scene["geometry"]["side"]
    return np.flatnonzero(np.isclose(np.abs(snapshots.nodes[:, 1:]), side / 2, atol=1e-6 * side).all(axis=1))


def _is_corner(snapshots: SnapshotSet, nodes: np.ndarray) -> np.ndarray:
    """Which nodes of the long edges are corners of a plate."""
    geometry = snapshots.description.scene["geometry"]
    ends = np.cumsum(geometry["segments"])
    places = np.concatenate([ends, ends - geometry["plate"]])
    x = snapshots.nodes[nodes, 0]
    return np.asarray(np.isclose(x[:, None], places, atol=1e-6 * geometry["side"]).any(axis=1))

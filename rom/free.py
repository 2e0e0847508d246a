"""The finger in free space: tip and heights of what may touch first, fitted as functions of the tensions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rom.polynomials import Fitted, Polynomial, Samples, fit
from rom.snapshots import SnapshotError, SnapshotSet

PLACES = 2000  # tensions at which to see what leads
CLOSE = 1e-7  # [m]: heights so close to the largest may stand for it


@dataclass(frozen=True, kw_only=True)
class Free:
    """Tip and heights of what may touch first, as functions of the tensions.

    Attributes:
        points: tensions of the free states, shape (n, tensions) [N].
        edges: nodes whose heights are among the values, after the tip's three components, shape (heights,).
        leads: which of them lead somewhere, shape (heights,).
        fitted: values [m].
    """

    points: np.ndarray
    edges: np.ndarray
    leads: np.ndarray
    fitted: Fitted

    @staticmethod
    def of(snapshots: SnapshotSet) -> Free:
        """Fit a set's free states."""
        description = snapshots.description
        count = description.tensions
        points = snapshots.states_of("free", "parameters")[:, :count]
        values, slopes = (snapshots.states_of("free", name) for name in ("tip", "tip_jacobian"))
        if description.has_obstacle:
            heights = snapshots.states_of("free", "edge_heights")
            if np.abs(heights.max(axis=1) - snapshots.states_of("free", "touch_distance")).max() > 1e-6:
                raise SnapshotError(
                    f"{snapshots.path}: somewhere a face bulges farther towards the plane than its edges"
                )
            values = np.concatenate([values, heights], axis=1)
            slopes = np.concatenate([slopes, snapshots.states_of("free", "edge_heights_jacobian")], axis=1)
        lower, upper = box(snapshots)
        samples = Samples(
            points=points,
            values=values,
            slopes=slopes[..., :count],
            weights=np.ones(len(points)),
            lower=lower[:count],
            upper=upper[:count],
        )
        fitted = fit(samples)
        if not description.has_obstacle:
            return Free(points=points, edges=np.zeros(0, int), leads=np.zeros(0, bool), fitted=fitted)
        everywhere = np.random.default_rng(0).random((PLACES, count)) * (upper - lower)[:count] + lower[:count]
        leading = _leading(fitted.polynomial.value(np.concatenate([points, everywhere]))[:, 3:])
        along = _long_edges(snapshots)
        kept = np.union1d(leading, np.flatnonzero(_is_corner(snapshots, along)))
        return Free(
            points=points,
            edges=along[kept],
            leads=np.isin(kept, leading),
            fitted=fitted.of(np.concatenate([np.arange(3), 3 + kept])),
        )

    def of_heights(self, wanted: np.ndarray) -> Free:
        """The same with only some of the heights."""
        columns = np.concatenate([np.arange(3), 3 + wanted])
        return replace(self, edges=self.edges[wanted], leads=self.leads[wanted], fitted=self.fitted.of(columns))

    @property
    def polynomial(self) -> Polynomial:
        """Tip, then heights."""
        return self.fitted.polynomial


def _leading(heights: np.ndarray) -> np.ndarray:
    """As few columns as give the largest height of every row, shape (n, heights), up to CLOSE."""
    highest, kept = heights.max(axis=1), [int(heights.max(axis=0).argmax())]
    while len(kept) < heights.shape[1]:
        short = highest - heights[:, kept].max(axis=1)
        worst = int(short.argmax())
        if short[worst] <= CLOSE:
            break
        kept.append(int(heights[worst].argmax()))
    return np.array(sorted(kept))


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

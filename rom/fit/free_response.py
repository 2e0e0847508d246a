"""The finger in free space: tip and heights of what may touch first, fitted as functions of the tensions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rom.brief import brief
from rom.fit.chebyshev import NOISE, Fitted, Polynomial, Samples, fit
from rom.fit.layout import HEIGHTS, TIP, height
from rom.snapshots.body import Body
from rom.snapshots.training_states import TrainingStates

PLACES = 2000  # tensions at which to see what leads
CLOSE = 1e-7  # [m]: heights so close to the largest may stand for it


@brief
@dataclass(frozen=True, kw_only=True)
class FreeResponse:
    """Tip and heights of what may touch first, as functions of the tensions.

    Attributes:
        points: tensions of the free states, shape (n, tensions) [N].
        known: tensions from which it is known, on all meshes, shape (n, tensions) [N].
        along: places of all nodes of the long edges, shape (nodes, 3) [m].
        kept: which of them matter: corners of plates, and what else leads somewhere, shape (heights,).
        leads: which of these lead somewhere, shape (heights,).
        whole: tip, then heights of all nodes of the long edges [m].
        noise: of these fits, and of all that build on them, see rom.fit.chebyshev.Samples.
    """

    points: np.ndarray
    known: np.ndarray
    along: np.ndarray
    kept: np.ndarray
    leads: np.ndarray
    whole: Fitted
    noise: float

    @staticmethod
    def of(states: TrainingStates, coarse: FreeResponse | None = None, noise: float = NOISE) -> FreeResponse:
        """Fit the free states, or correct by them what a coarser mesh says."""
        count, table = states.tensions, states.free
        points, values, slopes = table["parameters"][:, :count], table["tip"], table["tip_jacobian"]
        if states.has_obstacle:
            values = np.concatenate([values, table["edge_heights"]], axis=1)
            slopes = np.concatenate([slopes, table["edge_heights_jacobian"]], axis=1)
        lower, upper = states.lower, states.upper
        samples = Samples(
            points=points,
            values=values,
            slopes=slopes[..., :count],
            weights=np.ones(len(points)),
            lower=lower[:count],
            upper=upper[:count],
            noise=noise,
        )
        along = states.body.edge_nodes if states.has_obstacle else np.zeros(0, int)
        places, none, known, before = states.body.nodes[along], np.zeros(0, int), points, None
        if coarse is not None and len(coarse.points) > len(points):
            known = np.concatenate([points, coarse.points])
            before = coarse.whole.polynomial.mixed(_onto(coarse.along, places))
        whole = fit(samples, before)
        if not states.has_obstacle:
            return FreeResponse(
                points=points, known=known, along=places, kept=none, leads=none.astype(bool), whole=whole, noise=noise
            )
        everywhere = np.random.default_rng(0).random((PLACES, count)) * (upper - lower)[:count] + lower[:count]
        leading = _leading(whole.polynomial.value(np.concatenate([points, everywhere]))[:, HEIGHTS])
        kept = np.union1d(leading, np.flatnonzero(_is_corner(states.body, along)))
        return FreeResponse(
            points=points, known=known, along=places, kept=kept, leads=np.isin(kept, leading), whole=whole, noise=noise
        )

    def of_heights(self, wanted: np.ndarray) -> FreeResponse:
        """The same with only some of the heights."""
        return replace(self, kept=self.kept[wanted], leads=self.leads[wanted])

    @property
    def corners(self) -> np.ndarray:
        """Places of the nodes whose heights matter, shape (heights, 3) [m]."""
        return self.along[self.kept]

    @cached_property
    def fitted(self) -> Fitted:
        """Tip, then heights of the nodes that matter [m]."""
        return self.whole.of(np.concatenate([np.arange(3), height(self.kept)]))

    @property
    def polynomial(self) -> Polynomial:
        """Tip, then heights."""
        return self.fitted.polynomial


def _onto(coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Tip and heights of one mesh from those of another: weights, shape (3 + nodes, 3 + nodes), linear along edges."""
    weights = np.zeros((height(len(coarse)), height(len(fine))))
    weights[TIP, TIP] = np.eye(3)
    for column, place in enumerate(fine):
        edge = np.flatnonzero((np.sign(coarse[:, 1:]) == np.sign(place[1:])).all(axis=1))
        edge = edge[np.argsort(coarse[edge, 0])]
        for row, one in zip(edge, np.eye(len(edge)), strict=True):
            weights[height(row), height(column)] = np.interp(place[0], coarse[edge, 0], one)
    return weights


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


def _is_corner(body: Body, nodes: np.ndarray) -> np.ndarray:
    """Which nodes of the long edges are corners of a plate, shape (nodes,)."""
    x = body.nodes[nodes, 0]
    return np.asarray((np.abs(x[:, None] - body.plates.ravel()) < body.tolerance).any(axis=1))

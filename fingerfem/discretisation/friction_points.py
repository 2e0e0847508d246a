"""Friction at the nodes that press on an obstacle: springs for the tangent and the residual, and their anchors.

A force between nodes is shared by the nodes of its facet. The tangent neglects that the normals of a round obstacle
turn as the nodes move: springs are much shorter than its radius.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fingerfem.discretisation.closest_points import Springs
from fingerfem.mechanics import friction


class FrictionPoints:
    """The tangential springs of some nodes, at the bounds that were set last.

    Args:
        rest: places of all nodes of this rank at rest, shape (nodes, 3) [m].
        nodes: those that may touch and are this rank's own, shape (m,).
        normals: of the obstacle towards the finger at places, shapes (m, 3) [-] and (m, 3) [m].
    """

    def __init__(self, rest: np.ndarray, nodes: np.ndarray, normals: Callable[[np.ndarray], np.ndarray]):
        self.nodes, self._rest, self._normals = nodes, rest[nodes], normals
        self.anchors, self._bounds, self._k = self._rest.copy(), np.zeros(len(nodes)), np.ones(len(nodes))

    def places(self, displacement: np.ndarray) -> np.ndarray:
        """Of the nodes at displacements of all, shape (3 nodes,); shape (m, 3) [m]."""
        return np.asarray(self._rest + displacement.reshape(-1, 3)[self.nodes])

    def bound(self, bounds: np.ndarray, stiffness: np.ndarray) -> None:
        """Set the largest tangential forces, and stiffnesses, shapes (m,) [N, N/m]."""
        self._bounds, self._k = bounds, stiffness

    def at(self, displacement: np.ndarray) -> friction.Tangential:
        """What the springs do at displacements."""
        places = self.places(displacement)
        return friction.springs(places, self.anchors, self._normals(places), self._k, self._bounds)

    def springs(self, displacement: np.ndarray) -> Springs:
        """Those that press, as the tangent and the residual take them."""
        acts, found = self._bounds > 0, self.at(displacement)
        none = np.zeros(int(acts.sum()))
        return Springs(
            nodes=self.nodes[acts, None],
            forces=found.forces[acts, None],
            stiffness=found.stiffness[acts],
            gaps=none,
            energy=float(found.energy[acts].sum()),
            work=0.0,
        )

    def settle(self, displacement: np.ndarray) -> float:
        """End an increment: anchors follow what has slid, and nodes that do not touch; the work of friction [J]."""
        found, places = self.at(displacement), self.places(displacement)
        dissipated = float(np.sum(self._bounds * np.linalg.norm(found.slipped, axis=1)))
        self.anchors = np.where((self._bounds > 0)[:, None], self.anchors + found.slipped, places)
        return dissipated

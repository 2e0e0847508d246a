"""Contact with the plane y = side/2 + d: springs at nodes, an item of FElupe; imported in FElupe's own process alone.

The energy per area of the undeformed surface is gamma <-g>^2 / 2, g the gap and gamma a stiffness [N/m^3]. Its
integral by the Gauss-Lobatto rule whose points are the nodes is a spring at every node.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from felupe.mechanics import Assemble, Results
from scipy.sparse import csr_matrix

TOUCHING = 1e-9  # [m]: coordinates that differ by less are the same


def nodal_areas(points: np.ndarray, cells: np.ndarray, order: int, axis: int, value: float) -> np.ndarray:
    """Weights of the trapezoidal or Simpson's rule on the face where a coordinate has a value, shape (nodes,) [m^2]."""
    corners = points[cells]
    low, high = corners.min(axis=1, keepdims=True), corners.max(axis=1, keepdims=True)
    is_middle = np.abs(2 * corners - low - high) < TOUCHING
    shares = np.full(corners.shape, 0.5) if order == 1 else np.where(is_middle, 4 / 6, 1 / 6)
    areas = np.delete(shares * (high - low), axis, axis=2).prod(axis=2)
    on_face = np.abs(corners[:, :, axis] - value) < TOUCHING
    return np.bincount(cells[on_face], areas[on_face], len(points))


class NodalSprings:
    """Springs [N/m] between nodes and the plane y = height [m], an item for `felupe.newtonraphson`."""

    def __init__(self, field: Any, stiffness: np.ndarray):
        self.field, self._stiffness, self.height = field, stiffness, np.inf
        self._rest = field.region.mesh.points[:, 1]
        self._dofs = 3 * np.arange(len(stiffness)) + 1
        self.results = Results(stress=False, elasticity=False)
        self.assemble = Assemble(vector=self._vector, matrix=self._matrix)

    def _depths(self) -> np.ndarray:
        """Depth of each node behind the plane [m]."""
        return np.maximum(self._rest + self.field[0].values[:, 1] - self.height, 0.0)

    def force(self) -> float:
        """[N]."""
        return float(self._stiffness @ self._depths())

    def _vector(self, field: Any = None, **_: Any) -> Any:
        """Contact's part of the residual [N]."""
        self.field = self.field if field is None else field
        return csr_matrix((self._stiffness * self._depths(), (self._dofs, 0 * self._dofs)), (3 * len(self._dofs), 1))

    def _matrix(self, field: Any = None, **_: Any) -> Any:
        """Contact's part of the tangent [N/m]."""
        self.field = self.field if field is None else field
        pressed = self._depths() > 0
        dofs = self._dofs[pressed]
        return csr_matrix((self._stiffness[pressed], (dofs, dofs)), shape=2 * (3 * len(self._dofs),))

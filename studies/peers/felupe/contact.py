"""Contact with the plane y = side/2 + d: springs at nodes, an item of FElupe; imported in FElupe's own process alone.

The energy per area of the undeformed surface is gamma <-g>^2 / 2, g the gap and gamma a stiffness [N/m^3]. FElupe
integrates the area by the Gauss-Lobatto rule whose points are the nodes: a spring at every node.
"""

from __future__ import annotations

from typing import Any

import felupe
import numpy as np
from felupe.mechanics import Assemble, Results
from scipy.sparse import csr_matrix


def nodal_areas(mesh: Any, order: int, face: tuple[int, int], chosen: np.ndarray) -> np.ndarray:
    """Area that each node stands for of facets of boxes, shape (nodes,) [m^2].

    Args:
        mesh: of FElupe, its cells parallel to the axes.
        order: of its elements, 1 or 2.
        face: the axis that is normal to the facets, and on which side of the cells they are, -1 or 1.
        chosen: which nodes may belong to them, shape (nodes,).
    """
    axis, side = face
    element = felupe.Hexahedron() if order == 1 else felupe.TriQuadraticHexahedron()
    on_face = element.points[:, axis] == side
    those = chosen[mesh.cells[:, on_face]].all(axis=1)
    rule = felupe.GaussLobatto(order=order - 1, dim=2)
    scheme = felupe.quadrature.Scheme(np.insert(rule.points, axis, side, axis=1), rule.weights)
    region = felupe.Region(felupe.Mesh(mesh.points, mesh.cells[those], mesh.cell_type), element, scheme)
    along, across = (region.dXdr[:, k] for k in range(3) if k != axis)
    areas = np.linalg.norm(np.cross(along, across, axis=0), axis=0) * rule.weights[:, None]
    one = felupe.FieldContainer([felupe.Field(region, dim=1)])
    form = felupe.IntegralForm([np.ones((1, *areas.shape))], v=one, dV=areas, grad_v=[False])
    return form.assemble().toarray()[:, 0]


class NodalSprings:
    """Springs between nodes and the plane, an item for `felupe.newtonraphson`.

    Args:
        field: the displacement.
        stiffness: gamma times area, by node, shape (nodes,) [N/m].

    Attributes:
        height: of the plane, y [m].
    """

    def __init__(self, field: Any, stiffness: np.ndarray):
        self.field, self._stiffness, self.height = field, stiffness, np.inf
        self._rest = field.region.mesh.points[:, 1]
        self._dofs = 3 * np.arange(len(stiffness)) + 1
        self.results = Results(stress=False, elasticity=False)
        self.assemble = Assemble(vector=self._vector, matrix=self._matrix)

    def _presses(self) -> np.ndarray:
        """How far each node is behind the plane [m]."""
        return np.maximum(self._rest + self.field[0].values[:, 1] - self.height, 0.0)

    def force(self) -> float:
        """[N]."""
        return float(self._stiffness @ self._presses())

    def _vector(self, field: Any = None, **_: Any) -> Any:
        """Its part of the residual [N]."""
        self.field = self.field if field is None else field
        values = (self._stiffness * self._presses(), (self._dofs, 0 * self._dofs))
        return csr_matrix(values, shape=(3 * len(self._dofs), 1))

    def _matrix(self, field: Any = None, **_: Any) -> Any:
        """Its part of the tangent [N/m]."""
        self.field = self.field if field is None else field
        pressed = self._presses() > 0
        dofs = self._dofs[pressed]
        return csr_matrix((self._stiffness[pressed], (dofs, dofs)), shape=2 * (3 * len(self._dofs),))

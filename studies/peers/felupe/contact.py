"""Contact with the plane y = side/2 + d as items of FElupe; imported in FElupe's own process alone.

The energy per area of the undeformed surface is (p^2 - q^2) / (2 gamma), p = <q - gamma g>, g the gap, gamma a
stiffness [N/m^3] and q = n . P N the pressure of the rubber's own stress; the penalty has q = 0. FElupe integrates it
by the Gauss-Lobatto rule whose points are the nodes; of the penalty that leaves a spring at every node.
"""

from __future__ import annotations

from typing import Any

import felupe
import numpy as np
from felupe.mechanics import Assemble, Results
from scipy.sparse import csr_matrix

UP = np.array([0.0, 1.0, 0.0])  # towards the plane, whose normal points the other way [-]
STEP = 1e-5  # of a deformation gradient, between which elasticities are subtracted [-]


class Facets:
    """The facets of boxes on one face of the finger, integrated at their nodes.

    FElupe has boundary regions of its own, but those of 27 nodes have two nodes interchanged in three of six
    facets, which spoils the gradients that Nitsche's method needs. So these are FElupe's regions of whole
    cells, with the rule's points on one facet of the reference cell.

    Args:
        mesh: of FElupe, its cells parallel to the axes.
        order: of its elements, 1 or 2.
        face: the axis that is normal to the facets, and on which side of the cells they are, -1 or 1.
        chosen: which nodes may belong to them, shape (nodes,).

    Attributes:
        region: of FElupe.
        areas: of the points, shape (points, facets) [m^2].
        normal: shape (3,) [-].
    """

    def __init__(self, mesh: Any, order: int, face: tuple[int, int], chosen: np.ndarray):
        axis, side = face
        element = felupe.Hexahedron() if order == 1 else felupe.TriQuadraticHexahedron()
        on_face = element.points[:, axis] == side
        those = chosen[mesh.cells[:, on_face]].all(axis=1)
        rule = felupe.GaussLobatto(order=order - 1, dim=2)
        scheme = felupe.quadrature.Scheme(np.insert(rule.points, axis, side, axis=1), rule.weights)
        self.region = felupe.Region(felupe.Mesh(mesh.points, mesh.cells[those], mesh.cell_type), element, scheme)
        along, across = (self.region.dXdr[:, k] for k in range(3) if k != axis)
        self.areas = np.linalg.norm(np.cross(along, across, axis=0), axis=0) * rule.weights[:, None]
        self.normal = side * np.eye(3)[axis]

    def nodal_areas(self) -> np.ndarray:
        """Area that each node of the mesh stands for, shape (nodes,) [m^2]."""
        one = felupe.FieldContainer([felupe.Field(self.region, dim=1)])
        form = felupe.IntegralForm([np.ones((1, *self.areas.shape))], v=one, dV=self.areas, grad_v=[False])
        return form.assemble().toarray()[:, 0]


class NodalSprings:
    """The penalty: springs between nodes and the plane, an item for `felupe.newtonraphson`.

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


class Nitsche:
    """Nitsche's method on facets of rubber, an item for `felupe.newtonraphson`.

    Args:
        facets: of rubber.
        stiffness: gamma [N/m^3].
        material: the rubber's.

    Attributes:
        height: of the plane, y [m].
    """

    def __init__(self, facets: Facets, stiffness: float, material: Any):
        region = facets.region
        self.field = felupe.FieldContainer([felupe.Field(region, dim=3)])
        self._areas, self._stiffness, self._material = facets.areas, stiffness, material
        self._rest = felupe.Field(region, dim=3, values=region.mesh.points).interpolate()[1]
        # n_i N_J: what makes q of the stress; n points down.
        self._pair = np.multiply.outer(-UP, facets.normal)[:, :, None, None]
        self.height = np.inf
        self.results = Results(stress=False, elasticity=False)
        self.assemble = Assemble(vector=self._vector, matrix=self._matrix)

    def _own(self, evaluate: Any, shift: float = 0.0) -> np.ndarray:
        """The rubber's stress or elasticity [Pa] at F + shift n N^T."""
        F = self.field.extract()[0] + shift * self._pair
        return evaluate([F, np.zeros((0, *F.shape[2:]))])[0]

    def _pressures(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The rubber's own pressure q, that of contact p, and dq/dF, at the facets' points [Pa]."""
        q = (self._own(self._material.gradient) * self._pair).sum(axis=(0, 1))
        slope = np.einsum("iJkLqc,iJ->kLqc", self._own(self._material.hessian), self._pair[..., 0, 0])
        gap = self.height - self._rest - self.field[0].interpolate()[1]
        return q, np.maximum(q - self._stiffness * gap, 0.0), slope

    def force(self) -> float:
        """The integral of the pressure p [N]."""
        return float((self._pressures()[1] * self._areas).sum())

    def _linear(self, density: np.ndarray, by_gradient: bool) -> Any:
        form = felupe.IntegralForm([density], v=self.field, dV=self._areas, grad_v=[by_gradient])
        return form.assemble()

    def _bilinear(self, density: np.ndarray, *by_gradient: bool) -> Any:
        test, trial = ([each] for each in by_gradient)
        form = felupe.IntegralForm([density], v=self.field, dV=self._areas, u=self.field, grad_v=test, grad_u=trial)
        return form.assemble()

    def _vector(self, field: Any = None, **_: Any) -> Any:
        """Its part of the residual [N]."""
        self.field = self.field if field is None else field
        q, p, slope = self._pressures()
        return self._linear(UP[:, None, None] * p, False) + self._linear((p - q) / self._stiffness * slope, True)

    def _matrix(self, field: Any = None, **_: Any) -> Any:
        """Its part of the tangent [N/m]."""
        self.field = self.field if field is None else field
        q, p, slope = self._pressures()
        touches = (p > 0).astype(float)
        pressing = self._bilinear(self._stiffness * touches * np.multiply.outer(UP, UP)[..., None, None], False, False)
        mixed = self._bilinear(touches * np.einsum("i,kLqc->ikLqc", UP, slope), False, True)
        # The second derivative of q is that of the elasticity along n N^T: the one difference quotient here, and it
        # changes how Newton's method goes, not where it ends.
        curvature = self._own(self._material.hessian, STEP) - self._own(self._material.hessian, -STEP)
        both = (touches - 1) / self._stiffness * np.einsum("iJqc,kLqc->iJkLqc", slope, slope)
        both += (p - q) / self._stiffness * curvature / (2 * STEP)
        return pressing + mixed + mixed.T + self._bilinear(both, True, True)

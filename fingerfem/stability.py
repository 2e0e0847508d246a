"""Stability: whether the potential has a minimum at an equilibrium.

The tangent then has no negative eigenvalue. Half a finger moves symmetrically only, with u_z = 0 on the cut; what is
antisymmetric has u_x = u_y = 0 there, and is looked at apart: together they are all motions of the whole finger.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from petsc4py import PETSc

from fingerfem import geometry
from fingerfem.factorisation import Factorisation

if TYPE_CHECKING:
    from fingerfem.model import FingerModel


class Stability:
    """Says whether the equilibrium that Newton's method has brought a model to is stable (collective)."""

    def __init__(self, model: FingerModel):
        self._model = model

    def stable(self) -> bool:
        """Whether it is, against motions of the whole finger."""
        return self._model.stepper.newton.negative_pivots == 0 and not self._sways()

    def _sways(self) -> bool:
        """Whether half a finger gives way across its mirror plane."""
        if not self._model.scene.is_half:
            return False
        fields, matrix = self._model.fields, self._factorisation.matrix
        fields.previous.x.array[:] = fields.u.x.array
        fields.step.x.array[:] = 0.0
        matrix.zeroEntries()
        assemble_matrix(matrix, self._model.forms.tangent, bcs=self._supports)
        matrix.assemble()
        return self._factorisation.update() is not None or self._factorisation.negative_pivots > 0

    @cached_property
    def _factorisation(self) -> Factorisation:
        matrix = create_matrix(self._model.forms.tangent)
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return Factorisation(matrix)

    @cached_property
    def _supports(self) -> list[fem.DirichletBC]:
        """The clamp, and u_x = u_y = 0 on the cut."""
        model = self._model
        space, dim = model.space, model.mesh.mesh.topology.dim - 1
        cut, clamp = (model.mesh.facets.find(kind) for kind in (geometry.CUT, geometry.CLAMP))
        held = [(space.sub(i), fem.locate_dofs_topological(space.sub(i), dim, cut)) for i in range(2)]
        clamped = fem.locate_dofs_topological(space, dim, clamp)
        return [
            fem.dirichletbc(np.zeros(3), clamped, space),
            *(fem.dirichletbc(0.0, nodes, part) for part, nodes in held),
        ]

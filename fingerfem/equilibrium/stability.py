"""Stability: whether the potential has a minimum at an equilibrium.

The tangent then has no negative eigenvalue. Half a finger moves symmetrically only, with u_z = 0 on the cut; what is
antisymmetric has u_x = u_y = 0 there, and is looked at apart: together they are all motions of the whole finger.
"""

from functools import cached_property

import numpy as np
from dolfinx import fem

from fingerfem.discretisation import regions
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.tangent import Tangent
from fingerfem.equilibrium.factorisation import Factorisation


class AntisymmetricMotion:
    """Motions of the whole finger that half a finger, modelled as its own mirror image, cannot make."""

    def __init__(self, problem: Problem):
        self._problem = problem

    def gives_way(self) -> bool:
        """True if half a finger is unstable against such motions at the problem's displacement (collective)."""
        problem = self._problem
        if not problem.scene.is_half:
            return False
        problem.extrapolate_stress()
        self._tangent.assemble()
        return self._factorisation.update() is not None or self._factorisation.negative_pivots > 0

    @cached_property
    def _factorisation(self) -> Factorisation:
        return Factorisation(self._tangent.matrix)

    @cached_property
    def _tangent(self) -> Tangent:
        return self._problem.tangent_with(self._supports)

    @cached_property
    def _supports(self) -> list[fem.DirichletBC]:
        """The clamp, and u_x = u_y = 0 on the cut."""
        space, facets = self._problem.space, self._problem.mesh.facets
        dim = space.mesh.topology.dim - 1
        cut, clamp = (facets.find(kind) for kind in (regions.CUT, regions.CLAMP))
        held = [(space.sub(i), fem.locate_dofs_topological(space.sub(i), dim, cut)) for i in range(2)]
        clamped = fem.locate_dofs_topological(space, dim, clamp)
        return [
            fem.dirichletbc(np.zeros(3), clamped, space),
            *(fem.dirichletbc(0.0, nodes, part) for part, nodes in held),
        ]

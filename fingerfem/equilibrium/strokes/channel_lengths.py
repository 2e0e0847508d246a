"""Shortening of every tendon's channel between the clamp and each cross-section.

The length of a channel between two sections is the integral of |F e_x| over its cells there, divided by its area, as in
`mechanics.tendons`: integrated cell by cell with a test function that is constant on each.
"""

import numpy as np
import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import volume_measure
from fingerfem.mechanics import kinematics, tendons


class ChannelLengths:
    """The channels of a problem whose tendons all run in channels (collective over its ranks).

    Args:
        problem: the discrete problem.
    """

    def __init__(self, problem: Problem):
        self._problem, mesh, scene = problem, problem.mesh, problem.scene
        self._slabs = len(mesh.lines) - 1
        self._change = fem.Function(problem.space)
        u, by_cell = problem.fields.u, fem.functionspace(mesh.mesh, ("DG", 0))
        stretch = tendons.channelled(1.0, problem.fields.size)(kinematics.right_cauchy_green(u))
        dx = volume_measure(mesh, quadrature_degree(scene.mesh.order))
        lengths = ufl.TestFunction(by_cell) * stretch * dx(regions.channels(len(scene.laws)))
        wanted = [lengths, ufl.derivative(lengths, u, self._change)]
        self._lengths, self._length_changes = form_cache.forms(wanted)
        owned = by_cell.dofmap.index_map.size_local
        self._slab = np.searchsorted(mesh.lines, mesh.midpoints[0, :owned]) - 1
        channels = [mesh.pulled(scene, k) for k in range(len(scene.tendons))]
        self._cells = [np.flatnonzero(cells[:owned]) for cells, _ in channels]
        self._areas = np.array([area for _, area in channels]) / problem.copies
        state = problem.displacement.copy()
        problem.displacement[:] = 0.0
        self._rest = self._up_to_sections(self._lengths)
        problem.displacement[:] = state

    def quantities(self, changes: np.ndarray) -> dict[str, np.ndarray]:
        """The shortenings at the state the problem is in, and their derivatives, as `rom.dataset.schema` names them.

        Args:
            changes: of the displacement by p parameters, this rank's owned values, shape (p, owned values) [m].
        """
        jacobians = []
        for change in changes:
            self._change.x.array[: len(change)] = change
            self._change.x.scatter_forward()
            jacobians.append(-self._up_to_sections(self._length_changes))
        return {
            "section_shortening": self._rest - self._up_to_sections(self._lengths),
            "section_shortening_jacobian": np.stack(jacobians, axis=-1),
        }

    def _up_to_sections(self, form: fem.Form) -> np.ndarray:
        """Integrals over the channels from the clamp to the sections over their areas, shape (sections, tendons)."""
        by_cell = fem.assemble_vector(form).array
        parts = [np.bincount(self._slab[cells], by_cell[cells], self._slabs) for cells in self._cells]
        whole = self._problem.comm.allreduce(np.array(parts).T) / self._areas
        return np.concatenate([np.zeros((1, len(parts))), np.cumsum(whole, axis=0)])

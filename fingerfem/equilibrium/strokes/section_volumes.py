"""Growth of every chamber between the clamp and each cross-section.

The part before a section is closed there by the cone from the chamber's edge to the section's position c. No part of a
cone's area is seen from its tip, so that with N outward of the rubber and W the wall at rest before the section

    V = -1/3 integral over W of (x - c) . cof(F) N dA = M - c . A,

M and A integrated facet by facet with a test function that is constant on each cell. Behind the chamber W is closed,
A = 0, and V is the volume that the pressure does its work on.
"""

from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.problem import Problem
from fingerfem.mechanics.kinematics import cofactor, deformation_gradient


class WallIntegrals(NamedTuple):
    """M [m^3] and the three components of A [m^2] up to every section, and their derivatives by p parameters.

    Shapes (sections, chambers, 4) and (sections, chambers, 4, p).
    """

    values: np.ndarray
    changes: np.ndarray

    def volumes(self, places: np.ndarray, place_changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Volumes up to the sections, and their derivatives, shapes (sections, chambers) and (sections, chambers, p).

        Args:
            places: of the sections, shape (sections, 3) [m].
            place_changes: their derivatives, shape (sections, 3, p) [m].
        """
        tips = np.column_stack([np.ones(len(places)), -places])
        changes = np.einsum("skip,si->skp", self.changes, tips)
        changes -= np.einsum("ski,sip->skp", self.values[:, :, 1:], place_changes)
        return np.einsum("ski,si->sk", self.values, tips), changes


class SectionVolumes:
    """The chambers of a whole finger, none of which begins at the clamp (collective over the problem's ranks).

    Args:
        problem: the discrete problem.

    Attributes:
        at_rest: what `integrals` returns of the finger at rest, without derivatives.
    """

    def __init__(self, problem: Problem):
        self._problem, mesh, scene = problem, problem.mesh, problem.scene
        self._change = fem.Function(problem.space)
        u, by_cell = problem.fields.u, fem.functionspace(mesh.mesh, ("DG", 0, (4,)))
        rule = {"quadrature_degree": quadrature_degree(scene.mesh.order)}
        wall = ufl.Measure("ds", mesh.mesh, subdomain_data=mesh.facets, metadata=rule)(regions.WALL)
        area = cofactor(deformation_gradient(u)) * ufl.FacetNormal(mesh.mesh) * problem.fields.probe_pressure / -3
        moment = ufl.dot(ufl.SpatialCoordinate(mesh.mesh) + u, area)
        integrals = ufl.inner(ufl.as_vector([moment, *area]), ufl.TestFunction(by_cell)) * wall
        wanted = [integrals, ufl.derivative(integrals, u, self._change)]
        self._integrals, self._integral_changes = form_cache.forms(wanted)
        owned = by_cell.dofmap.index_map.size_local
        self._slab, self._slabs = np.searchsorted(mesh.lines, mesh.midpoints[0, :owned]) - 1, len(mesh.lines) - 1
        self._units = np.eye(len(scene.actuators))[len(scene.tendons) :]
        state = problem.displacement.copy()
        problem.displacement[:] = 0.0
        self.at_rest = self.integrals(np.zeros((0, len(state))))
        problem.displacement[:] = state

    def integrals(self, changes: np.ndarray) -> WallIntegrals:
        """Integrals in the problem's state, and their changes by those of `ChannelLengths.quantities` (collective)."""
        values = np.zeros((self._slabs + 1, len(self._units), 4))
        moved = np.zeros((*values.shape, len(changes)))
        for k, unit in enumerate(self._units):
            self._problem.actuators.probe(unit)
            values[:, k] = self._up_to_sections(self._integrals)
            for p, change in enumerate(changes):
                self._change.x.array[: len(change)] = change
                self._change.x.scatter_forward()
                moved[:, k, :, p] = self._up_to_sections(self._integral_changes)
        return WallIntegrals(values, moved)

    def _up_to_sections(self, form: fem.Form) -> np.ndarray:
        """Integrals over the wall from the clamp to every section, shape (sections, 4)."""
        by_cell = fem.assemble_vector(form).array.reshape(-1, 4)[: len(self._slab)]
        own = np.zeros((self._slabs, 4))
        np.add.at(own, self._slab, by_cell)
        whole = self._problem.comm.allreduce(own)
        return np.concatenate([np.zeros((1, 4)), np.cumsum(whole, axis=0)])

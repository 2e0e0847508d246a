"""The points of the surface at which contact is looked for: those of the rule that its forms are integrated by."""

from __future__ import annotations

from collections.abc import Iterable

import basix
import numpy as np
from dolfinx import fem
from scipy.sparse import csr_matrix

from fingerfem.mechanics import contact


class ContactPoints:
    """Points of this rank's surface, as combinations of its nodes, ghosts included.

    Args:
        space: of the displacement.
        weights: of the nodes, shape (points, nodes) [-].
    """

    def __init__(self, space: fem.FunctionSpace, weights: csr_matrix):
        self._weights = weights
        self.rest = self.field(space.tabulate_dof_coordinates().ravel())  # shape (points, 3) [m]

    def field(self, values: np.ndarray) -> np.ndarray:
        """A field at the points, shape (points, 3), from its values at the nodes, shape (3 nodes,)."""
        return np.asarray(self._weights @ values.reshape(-1, 3))


def at_nodes(space: fem.FunctionSpace, nodes: np.ndarray) -> ContactPoints:
    """The nodes themselves."""
    count = len(space.tabulate_dof_coordinates())
    ones = (np.ones(len(nodes)), (np.arange(len(nodes)), nodes))
    return ContactPoints(space, csr_matrix(ones, shape=(len(nodes), count)))


def on_facets(space: fem.FunctionSpace, rules: Iterable[tuple[np.ndarray, int]]) -> ContactPoints:
    """Lattices of points within facets: local indices, and how many along an edge."""
    mesh, count = space.mesh, len(space.tabulate_dof_coordinates())
    dim = mesh.topology.dim
    mesh.topology.create_connectivity(dim - 1, dim)
    mesh.topology.create_connectivity(dim, dim - 1)
    of_facet, of_cell = mesh.topology.connectivity(dim - 1, dim), mesh.topology.connectivity(dim, dim - 1)
    corners, faces = basix.geometry(basix.CellType.hexahedron), basix.topology(basix.CellType.hexahedron)[2]
    rows, columns, values, total = [], [], [], 0
    for facets, along in rules:
        local, tables = contact.lattice(along), []
        for face in faces:
            origin, one, other = (corners[face[k]] for k in (0, 1, 2))
            points = origin + local[:, :1] * (one - origin) + local[:, 1:] * (other - origin)
            tables.append(space.element.basix_element.tabulate(0, points)[0, :, :, 0])
        for facet in facets:
            cell = of_facet.links(facet)[0]
            table = tables[int(np.flatnonzero(of_cell.links(cell) == facet)[0])]
            nodes = space.dofmap.cell_dofs(cell)
            rows.append(np.repeat(np.arange(total, total + len(table)), len(nodes)))
            columns.append(np.tile(nodes, len(table)))
            values.append(table.ravel())
            total += len(table)
    listed = [np.concatenate(part) if part else np.zeros(0, int) for part in (values, rows, columns)]
    return ContactPoints(space, csr_matrix((listed[0], (listed[1], listed[2])), shape=(total, count)))

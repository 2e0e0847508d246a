"""The points of the surface at which contact is looked for: those of the rule that its forms are integrated by."""

from collections.abc import Iterable
from typing import NamedTuple

import basix
import numpy as np
from basix.finite_element import FiniteElement
from dolfinx import fem
from scipy.sparse import csr_matrix, vstack

from fingerfem.mechanics import contact
from fingerfem.mechanics.obstacles import NUMPY, Body


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


class SurfaceFacets:
    """This rank's part of some facets of hexahedra.

    Args:
        space: of the displacement.
        facets: local indices; those of other ranks' cells are left to these.

    Attributes:
        element: of the reference facet, with n nodes.
        nodes: local indices of the facets' nodes, shape (facets, n).
        rest: their places, shape (facets, n, 3) [m].
    """

    def __init__(self, space: fem.FunctionSpace, facets: np.ndarray):
        cell, corners = space.element.basix_element, basix.geometry(basix.CellType.hexahedron)
        self.element: FiniteElement = basix.create_element(
            basix.ElementFamily.P, basix.CellType.quadrilateral, cell.degree, cell.lagrange_variant
        )
        faces = []
        for face in basix.topology(basix.CellType.hexahedron)[2]:
            origin, one, other = (corners[face[k]] for k in (0, 1, 2))
            local = self.element.points
            places = origin + local[:, :1] * (one - origin) + local[:, 1:] * (other - origin)
            faces.append(np.linalg.norm(cell.points[None] - places[:, None], axis=2).argmin(axis=1))
        mesh = space.mesh
        dim = mesh.topology.dim
        mesh.topology.create_connectivity(dim - 1, dim)
        mesh.topology.create_connectivity(dim, dim - 1)
        of_facet, of_cell = mesh.topology.connectivity(dim - 1, dim), mesh.topology.connectivity(dim, dim - 1)
        nodes, cells = [], mesh.topology.index_map(dim).size_local
        for facet in facets:
            own = of_facet.links(facet)[0]
            if own < cells:
                side = int(np.flatnonzero(of_cell.links(own) == facet)[0])
                nodes.append(space.dofmap.cell_dofs(own)[faces[side]])
        self.nodes = np.array(nodes, int).reshape(-1, len(self.element.points))
        self.rest = space.tabulate_dof_coordinates()[self.nodes]

    def places(self, displacement: np.ndarray) -> np.ndarray:
        """Positions of the facets' nodes, shape (facets, n, 3) [m], at nodal displacements, shape (3 nodes,) [m]."""
        return np.asarray(self.rest + displacement.reshape(-1, 3)[self.nodes])

    def shapes(self, at: np.ndarray) -> np.ndarray:
        """The nodes' weights at places (s, t) of the reference facet, shapes (points, 2), (points, n) [-]."""
        return tables(self.element, 0, at)[0]

    def areas(self, at: np.ndarray) -> np.ndarray:
        """Area at rest over that of the reference facet at places (s, t), shape (facets, points) [m^2]."""
        one, other = np.einsum("dpn,mni->dmpi", tables(self.element, 1, at)[1:], self.rest)
        return np.asarray(np.linalg.norm(np.cross(one, other), axis=2))


def tables(element: FiniteElement, most: int, at: np.ndarray) -> np.ndarray:
    """Shape functions of a facet and their derivatives at places, shape (m, 2); shape (derivatives, m, n)."""
    if not len(at):
        return np.zeros(((most + 1) * (most + 2) // 2, 0, len(element.points)))
    return np.asarray(element.tabulate(most, at)[..., 0])


class PressingPoints(NamedTuple):
    """Points that press on a body, or may.

    Attributes:
        slots: their indices among all points of their facets, ascending, shape (m,).
        nodes: of their facets, shape (m, n).
        weights: of these nodes, shape (m, n) [-].
        stiffness: of the contact's springs there, shape (m,) [N/m].
        gaps: shape (m,) [m].
    """

    slots: np.ndarray
    nodes: np.ndarray
    weights: np.ndarray
    stiffness: np.ndarray
    gaps: np.ndarray


class FixedPoints:
    """The points of a quadrature rule on facets, each with its part of the penalty.

    Args:
        facets: that may touch.
        rule: places on the reference facet, shape (points, 2), and weights, shape (points,) [-].
        stiffness: of contact, by area [N/m^3].
        body: the obstacle.
    """

    def __init__(self, facets: SurfaceFacets, rule: tuple[np.ndarray, np.ndarray], stiffness: float, body: Body):
        at, weights = rule
        self._facets, self._body, self._shapes = facets, body, facets.shapes(at)
        self._stiffness = stiffness * facets.areas(at) * weights
        self.count = self._stiffness.size

    def pressing(self, displacement: np.ndarray, distance: float, tried: np.ndarray) -> PressingPoints:
        """Points inside the body at nodal displacements, shape (3 nodes,), and its distance [m]; and slots `tried`."""
        places = self._facets.places(displacement)
        middles = places.mean(axis=1)
        radii = np.linalg.norm(places - middles[:, None], axis=2).max(axis=1, initial=0.0)
        inside = self._body.signed_distance(middles.T, distance, NUMPY) < radii
        among = np.zeros(self._stiffness.shape, bool)
        among.ravel()[tried] = True
        near = np.flatnonzero(inside | among.any(axis=1))
        points = np.einsum("pn,mni->mpi", self._shapes, places[near]).reshape(-1, 3)
        gaps = self._body.signed_distance(points.T, distance, NUMPY).reshape(len(near), len(self._shapes))
        facet, point = np.nonzero((gaps < 0) | among[near])
        return PressingPoints(
            slots=near[facet] * len(self._shapes) + point,
            nodes=self._facets.nodes[near[facet]],
            weights=self._shapes[point],
            stiffness=self._stiffness[near[facet], point],
            gaps=gaps[facet, point],
        )


def at_nodes(space: fem.FunctionSpace, nodes: np.ndarray) -> ContactPoints:
    """The nodes themselves."""
    count = len(space.tabulate_dof_coordinates())
    ones = (np.ones(len(nodes)), (np.arange(len(nodes)), nodes))
    return ContactPoints(space, csr_matrix(ones, shape=(len(nodes), count)))


def on_facets(space: fem.FunctionSpace, rules: Iterable[tuple[np.ndarray, int]]) -> ContactPoints:
    """Lattices of points within this rank's facets: local indices, and how many along an edge."""
    parts = []
    for indices, along in rules:
        facets = SurfaceFacets(space, indices)
        shapes = facets.shapes(contact.lattice(along))
        m, n = facets.nodes.shape
        nodes = np.repeat(facets.nodes, len(shapes), axis=0)
        starts = np.arange(0, nodes.size + 1, n)
        values = np.tile(shapes.ravel(), m)
        parts.append(
            csr_matrix((values, nodes.ravel(), starts), shape=(len(nodes), len(space.tabulate_dof_coordinates())))
        )
    return ContactPoints(space, vstack(parts, format="csr"))

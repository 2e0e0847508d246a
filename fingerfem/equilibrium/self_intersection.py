"""Detection of a finger's surface that passes through itself, which the model does not prevent.

A triangulated surface passes through itself where an edge crosses a triangle it shares no corner with.
"""

import numpy as np
from dolfinx import mesh as dmesh
from scipy.spatial import cKDTree

from fingerfem.discretisation import regions
from fingerfem.discretisation.problem import Problem


class Surface:
    """The triangulated surface of a finger, whole on every rank; straight between the cells' corners at order 2 too."""

    def __init__(self, problem: Problem):
        self._comm, self._half, self._side = problem.comm, problem.scene.is_half, problem.scene.geometry.side
        mesh = problem.mesh.mesh
        dim = mesh.topology.dim
        facets = np.sort(np.concatenate([problem.mesh.facets.find(kind) for kind in (*regions.SURFACE, regions.WALL)]))
        mesh.topology.create_connectivity(dim - 1, dim)
        mesh.topology.create_connectivity(dim, dim - 1)
        corners = dmesh.entities_to_geometry(mesh, dim - 1, facets).reshape(len(facets), -1)[:, :4]
        vertices = mesh.geometry.x[corners]  # (facets, 4, 3), in tensor order
        points = problem.space.tabulate_dof_coordinates()
        self._nodes = cKDTree(points).query(vertices.reshape(-1, 3))[1] if len(corners) else np.empty(0, int)
        everywhere = problem.space.dofmap.index_map.local_to_global(self._nodes.astype(np.int32))
        own = np.concatenate(self._comm.allgather(everywhere))
        _, self._first, ids = np.unique(own, return_index=True, return_inverse=True)
        quads = ids.reshape(-1, 4)
        self._triangles = np.concatenate([quads[:, [0, 1, 3]], quads[:, [0, 3, 2]]])
        sides = np.concatenate([quads[:, pair] for pair in ([0, 1], [1, 3], [3, 2], [2, 0], [0, 3])])
        self._edges = np.unique(np.sort(sides, axis=1), axis=0)
        self._rest = points[self._nodes]

    def passes_through_itself(self, displacement: np.ndarray) -> bool:
        """True if the surface does, displaced by this rank's nodal displacements, shape (nodes, 3) [m] (collective)."""
        moved = self._rest + displacement[self._nodes]
        points = np.concatenate(self._comm.allgather(moved))[self._first]
        if self._half and points[:, 2].min() < -1e-6 * self._side:
            return True  # beyond its mirror plane it meets its mirror image
        ends, corners = points[self._edges], points[self._triangles]
        middles, centres = ends.mean(axis=1), corners.mean(axis=1)
        reach = np.linalg.norm(ends - middles[:, None], axis=2).max()
        reach += np.linalg.norm(corners - centres[:, None], axis=2).max()
        near = cKDTree(centres).query_ball_point(middles, reach, return_sorted=False)
        edge = np.repeat(np.arange(len(ends)), [len(found) for found in near])
        triangle = np.concatenate(near).astype(int)
        shared = (self._edges[edge][:, :, None] == self._triangles[triangle][:, None, :]).any(axis=(1, 2))
        return bool(_cross(ends[edge[~shared]], corners[triangle[~shared]]).any())


def _cross(ends: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """True for segments, shape (n, 2, 3), that pass through the inside of their triangle, shape (n, 3, 3).

    Moeller, Trumbore, J. Graphics Tools 2, 1997, doi:10.1080/10867651.1997.10487468.
    """
    along = ends[:, 1] - ends[:, 0]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    from_corner = ends[:, 0] - corners[:, 0]
    normal = np.cross(along, second)
    determinant = np.einsum("ij,ij->i", first, normal)
    flat = abs(determinant) < 1e-12 * np.linalg.norm(along, axis=1) * np.linalg.norm(np.cross(first, second), axis=1)
    scale = 1 / np.where(flat, 1.0, determinant)
    other = np.cross(from_corner, first)
    u = scale * np.einsum("ij,ij->i", from_corner, normal)
    v = scale * np.einsum("ij,ij->i", along, other)
    t = scale * np.einsum("ij,ij->i", second, other)
    margin = 1e-9  # inclusive: nodes of a symmetric finger may meet edge on edge
    return ~flat & (u > -margin) & (v > -margin) & (u + v < 1 + margin) & (t > -margin) & (t < 1 + margin)

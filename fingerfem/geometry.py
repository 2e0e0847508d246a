"""The finger's hexahedral mesh with named regions."""

from __future__ import annotations

from dataclasses import dataclass

import dolfinx
import numpy as np
from mpi4py import MPI

from fingerfem.grid import grid_lines, in_channel, plates
from fingerfem.scene import Scene

# Cells; a CHANNEL cell carries at least one tendon. A tendon ends before the plate it pulls on: the tip's carries none.
RUBBER, RUBBER_CHANNEL, PLATE, PLATE_CHANNEL, TIP_PLATE = 1, 2, 3, 4, 5
CLAMP, SURFACE, PAD = 11, 12, 13  # facets; PAD is the tip plate's face towards the plane, part of the surface


@dataclass(frozen=True)
class FingerMesh:
    """A mesh with its regions: cells RUBBER, ..., TIP_PLATE; facets CLAMP, SURFACE, PAD."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTags
    facets: dolfinx.mesh.MeshTags
    midpoints: np.ndarray  # (3, n) [m], of the cells
    smallest: float  # smallest cell edge across the section [m]


def build_mesh(scene: Scene, comm: MPI.Comm) -> FingerMesh:
    """The finger's mesh on the ranks of a communicator (collective)."""
    x, y = grid_lines(scene)
    counts = [len(x) - 1, len(y) - 1, len(y) - 1]
    mesh = dolfinx.mesh.create_box(
        comm,
        [np.zeros(3), np.ones(3)],
        counts,
        dolfinx.mesh.CellType.hexahedron,
        ghost_mode=dolfinx.mesh.GhostMode.none,
    )
    for axis, lines in enumerate((x, y, y)):
        index = np.rint(mesh.geometry.x[:, axis] * counts[axis]).astype(int)
        mesh.geometry.x[:, axis] = lines[index]

    dim = mesh.topology.dim
    cells = np.arange(mesh.topology.index_map(dim).size_local + mesh.topology.index_map(dim).num_ghosts, dtype=np.int32)
    midpoints = dolfinx.mesh.compute_midpoints(mesh, dim, cells).T
    in_plate = np.any([(midpoints[0] > a) & (midpoints[0] < b) for a, b in plates(scene)], axis=0)
    carries = np.any([in_channel(scene, k, midpoints) for k in range(len(scene.tendons))], axis=0)
    regions = np.where(in_plate, PLATE, RUBBER) + carries
    regions[midpoints[0] > plates(scene)[-1][0]] = TIP_PLATE
    cell_tags = dolfinx.mesh.meshtags(mesh, dim, cells, regions.astype(np.int32))

    mesh.topology.create_connectivity(dim - 1, dim)
    facets = np.sort(dolfinx.mesh.exterior_facet_indices(mesh.topology))
    centre = dolfinx.mesh.compute_midpoints(mesh, dim - 1, facets).T
    tolerance = 1e-9
    is_pad = (centre[1] > scene.geometry.side / 2 - tolerance) & (centre[0] > plates(scene)[-1][0])
    kinds = np.where(centre[0] < tolerance, CLAMP, np.where(is_pad, PAD, SURFACE))
    facet_tags = dolfinx.mesh.meshtags(mesh, dim - 1, facets, kinds.astype(np.int32))
    return FingerMesh(mesh, cell_tags, facet_tags, midpoints, float(np.diff(y).min()))

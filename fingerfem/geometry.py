"""The finger's hexahedral mesh with named regions."""

from __future__ import annotations

from dataclasses import dataclass

import dolfinx
import numpy as np
from mpi4py import MPI

from fingerfem.grid import grid_lines, in_channel, in_hole, plates
from fingerfem.scene import Scene

# Cells. A CHANNEL carries a tendon that slides through it, a HOLE holds the end of a straight one.
RUBBER, RUBBER_CHANNEL = 1, 2
PLATE, PLATE_CHANNEL, PLATE_HOLE, TIP_PLATE, TIP_HOLE = 3, 4, 5, 6, 7
CHANNELS = (RUBBER_CHANNEL, PLATE_CHANNEL)
RUBBERS, TIP = (RUBBER, RUBBER_CHANNEL), (TIP_PLATE, TIP_HOLE)
PLATES = (PLATE, PLATE_CHANNEL, PLATE_HOLE, *TIP)
# Facets: the clamp, the cut z = 0 of half a finger, and the surface, by what it is made of and whether it is the pad.
CLAMP, CUT, RUBBER_SURFACE, PLATE_SURFACE, RUBBER_PAD, PLATE_PAD = 11, 12, 13, 14, 15, 16
RUBBER_FACETS, PLATE_FACETS, PAD = (RUBBER_SURFACE, RUBBER_PAD), (PLATE_SURFACE, PLATE_PAD), (RUBBER_PAD, PLATE_PAD)
SURFACE = (*RUBBER_FACETS, *PLATE_FACETS)


@dataclass(frozen=True)
class FingerMesh:
    """A mesh with its regions: cells RUBBER, ..., TIP_HOLE; facets CLAMP, ..., PLATE_PAD."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTags
    facets: dolfinx.mesh.MeshTags
    midpoints: np.ndarray  # (3, n) [m], of the cells
    smallest: float  # smallest cell edge across the section [m]


def build_mesh(scene: Scene, comm: MPI.Comm) -> FingerMesh:
    """The finger's mesh on the ranks of a communicator (collective)."""
    lines = grid_lines(scene)
    counts = [len(along) - 1 for along in lines]
    mesh = dolfinx.mesh.create_box(
        comm,
        [np.zeros(3), np.ones(3)],
        counts,
        dolfinx.mesh.CellType.hexahedron,
        ghost_mode=dolfinx.mesh.GhostMode.none,
    )
    for axis, along in enumerate(lines):
        index = np.rint(mesh.geometry.x[:, axis] * counts[axis]).astype(int)
        mesh.geometry.x[:, axis] = along[index]

    dim = mesh.topology.dim
    cells = np.arange(mesh.topology.index_map(dim).size_local + mesh.topology.index_map(dim).num_ghosts, dtype=np.int32)
    midpoints = dolfinx.mesh.compute_midpoints(mesh, dim, cells).T
    cell_tags = dolfinx.mesh.meshtags(mesh, dim, cells, _regions(scene, midpoints))
    mesh.topology.create_connectivity(dim - 1, dim)
    facets = np.sort(dolfinx.mesh.exterior_facet_indices(mesh.topology))
    centres = dolfinx.mesh.compute_midpoints(mesh, dim - 1, facets).T
    facet_tags = dolfinx.mesh.meshtags(mesh, dim - 1, facets, _faces(scene, centres))
    smallest = min(float(np.diff(along).min()) for along in lines[1:])
    return FingerMesh(mesh, cell_tags, facet_tags, midpoints, smallest)


def _regions(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Region of the cells with midpoints x, shape (3, n) [m]."""

    def anywhere(inside, path: str) -> np.ndarray:
        chosen = [inside(scene, k, x) for k, tendon in enumerate(scene.tendons) if tendon.path == path]
        return np.any([np.zeros(x.shape[1], bool), *chosen], axis=0)

    channel, hole = anywhere(in_channel, "channel"), anywhere(in_hole, "straight")
    in_plate = np.any([(x[0] > a) & (x[0] < b) for a, b in plates(scene)], axis=0)
    in_tip = x[0] > plates(scene)[-1][0]
    regions = np.where(channel, RUBBER_CHANNEL, RUBBER)
    regions[in_plate] = np.where(channel, PLATE_CHANNEL, np.where(hole, PLATE_HOLE, PLATE))[in_plate]
    regions[in_tip] = np.where(hole, TIP_HOLE, TIP_PLATE)[in_tip]
    return regions.astype(np.int32)


def _faces(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Kind of the exterior facets with midpoints x, shape (3, n) [m]."""
    tolerance = 1e-9
    pad = np.zeros(x.shape[1], bool)
    if scene.obstacle is not None and scene.obstacle.pad is not None:
        patch = scene.obstacle.pad
        width = scene.geometry.side if patch.width is None else patch.width
        pad = (x[1] > scene.geometry.side / 2 - tolerance) & (abs(x[2]) < width / 2)
        pad &= (x[0] > patch.x[0]) & (x[0] < patch.x[1])
    in_plate = np.any([(x[0] > a) & (x[0] < b + tolerance) for a, b in plates(scene)], axis=0)
    kinds = np.where(in_plate, np.where(pad, PLATE_PAD, PLATE_SURFACE), np.where(pad, RUBBER_PAD, RUBBER_SURFACE))
    if scene.is_half:
        kinds[abs(x[2]) < tolerance] = CUT
    kinds[x[0] < tolerance] = CLAMP
    return kinds.astype(np.int32)

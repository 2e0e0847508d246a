"""The finger's hexahedral mesh with named regions."""

from __future__ import annotations

from dataclasses import dataclass

import dolfinx
import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fingerfem.discretisation import regions
from fingerfem.scene.grid_lines import grid_lines, in_channel, in_hole
from fingerfem.scene.scene import Scene
from fingerfem.scene.tables import Geometry


@dataclass(frozen=True)
class FingerMesh:
    """A mesh with its regions: cells and facets carry the tags of `regions`."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTags
    facets: dolfinx.mesh.MeshTags
    midpoints: np.ndarray  # (3, n) [m], of the cells, before sections are scaled
    smallest: float  # smallest cell edge across the section [m]
    is_tapered: bool  # whether cells are not all boxes


def build_mesh(scene: Scene, comm: MPI.Comm) -> FingerMesh:
    """The finger's mesh on the ranks of a communicator (collective)."""
    lines = grid_lines(scene.outline, scene.mesh, scene.is_half)
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
    smallest = scene.geometry.thinnest * min(float(np.diff(along).min()) for along in lines[1:])
    mesh.geometry.x[:, 1:] *= scene.geometry.size_at(mesh.geometry.x[:, 0])[:, None]
    return FingerMesh(mesh, cell_tags, facet_tags, midpoints, smallest, scene.geometry.is_tapered)


def _regions(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Region of the cells with midpoints x, shape (3, n) [m]."""

    def anywhere(inside, path: str) -> np.ndarray:
        chosen = [inside(scene.outline, tendon, x) for tendon in scene.tendons if tendon.path == path]
        return np.any([np.zeros(x.shape[1], bool), *chosen], axis=0)

    channel, hole = anywhere(in_channel, "channel"), anywhere(in_hole, "straight")
    in_plate = np.any([(x[0] > a) & (x[0] < b) for a, b in scene.outline.plates], axis=0)
    in_tip = x[0] > scene.outline.plates[-1][0]
    found = np.where(channel, regions.RUBBER_CHANNEL, regions.RUBBER)
    plate = np.where(channel, regions.PLATE_CHANNEL, np.where(hole, regions.PLATE_HOLE, regions.PLATE))
    found[in_plate] = plate[in_plate]
    found[in_tip] = np.where(hole, regions.TIP_HOLE, regions.TIP_PLATE)[in_tip]
    return found.astype(np.int32)


def _faces(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Kind of the exterior facets with midpoints x, shape (3, n) [m]."""
    tolerance = scene.outline.tolerance
    pad = np.zeros(x.shape[1], bool)
    if scene.obstacle is not None and scene.obstacle.pad is not None:
        patch = scene.obstacle.pad
        width = scene.geometry.side if patch.width is None else patch.width
        pad = (x[1] > scene.geometry.side / 2 - tolerance) & (abs(x[2]) < width / 2)
        pad &= (x[0] > patch.x[0]) & (x[0] < patch.x[1])
    in_plate = np.any([(x[0] > a) & (x[0] < b + tolerance) for a, b in scene.outline.plates], axis=0)
    on_plate = np.where(pad, regions.PLATE_PAD, regions.PLATE_SURFACE)
    kinds = np.where(in_plate, on_plate, np.where(pad, regions.RUBBER_PAD, regions.RUBBER_SURFACE))
    if scene.is_half:
        kinds[abs(x[2]) < tolerance] = regions.CUT
    kinds[x[0] < tolerance] = regions.CLAMP
    return kinds.astype(np.int32)


def section_sizes(mesh: FingerMesh, geometry: Geometry) -> fem.Function | None:
    """Size of the sections over that at the clamp [-]; None without taper."""
    if not geometry.is_tapered:
        return None
    size = fem.Function(fem.functionspace(mesh.mesh, ("Lagrange", 1)))
    size.interpolate(lambda x: geometry.size_at(x[0]))
    return size

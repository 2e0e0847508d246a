"""The finger's hexahedral mesh with named regions.

The grid lines fit plates and channels at every resolution, so refining the mesh refines the same finger.
"""

from __future__ import annotations

from dataclasses import dataclass

import dolfinx
import numpy as np
from mpi4py import MPI

from fingerfem.scene import Scene

# Cells; a CHANNEL cell carries at least one tendon. A tendon ends before the plate it pulls on: the tip's carries none.
RUBBER, RUBBER_CHANNEL, PLATE, PLATE_CHANNEL, TIP_PLATE = 1, 2, 3, 4, 5
CLAMP, SURFACE, PAD = 11, 12, 13  # facets; PAD is the tip plate's face towards the plane, part of the surface


def subdivide(breakpoints, cells):
    """Grid lines that contain every breakpoint, with the given number of cells, as even as possible.

    A grid symmetric about its middle stays symmetric.

    Args:
        breakpoints: ascending positions [m], shape (n,).
        cells: number of cells between the first and the last.

    Raises:
        ValueError: the number of cells cannot fit the breakpoints, or not symmetrically.
    """
    breakpoints = np.asarray(breakpoints, float)
    lengths = np.diff(breakpoints)
    n = len(lengths)
    symmetric = np.allclose(lengths, lengths[::-1], rtol=1e-6)
    count = np.ones(n, int)
    while count.sum() < cells:
        # Split the widest cells first; a mirrored pair together, the outermost of equals first.
        for i in np.lexsort((np.arange(n), np.round(-lengths / count, 12))):
            pair = {int(i), n - 1 - int(i)} if symmetric else {int(i)}
            if count.sum() + len(pair) <= cells:
                count[list(pair)] += 1
                break
        else:
            break
    if count.sum() != cells:
        parity = ", and even to stay symmetric" if symmetric and n % 2 == 0 else ""
        raise ValueError(
            f"must fit {n} intervals between channels and plates (at least {n} cells{parity}), got {cells}"
        )
    pieces = [
        np.linspace(a, b, k, endpoint=False) for a, b, k in zip(breakpoints, breakpoints[1:], count, strict=False)
    ]
    return np.append(np.concatenate(pieces), breakpoints[-1])


def plates(scene: Scene) -> list[tuple[float, float]]:
    """Where every segment's plate begins and ends along x [m]."""
    ends = np.cumsum(scene.geometry.segments)
    return [(float(end - scene.geometry.plate), float(end)) for end in ends]


def grid_lines(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Grid lines along x and across the section (the same for y and z) [m].

    Raises:
        ValueError: mesh.cells cannot hold the plates or the channels.
    """
    geometry, (along, across) = scene.geometry, scene.mesh.cells
    half = geometry.channel_width / 2
    edges = {geometry.side / 2}
    for tendon in scene.tendons:
        for offset in tendon.offset:
            edges |= {abs(abs(offset) - half), abs(offset) + half}
    positive = np.unique(np.round(sorted(edges), 9))
    section = np.unique(np.concatenate([-positive, positive]))
    try:
        lines = [subdivide([start, inner, outer], along) for start, (inner, outer) in _segments(scene)]
    except ValueError as error:
        raise ValueError(f"mesh.cells[0] {error}") from None
    try:
        y = subdivide(section, across)
    except ValueError as error:
        raise ValueError(f"mesh.cells[1] {error}") from None
    return np.unique(np.round(np.concatenate(lines), 12)), y


def _segments(scene: Scene):
    ends = plates(scene)
    return list(zip([0.0, *[outer for _, outer in ends[:-1]]], ends, strict=True))


def in_channel(scene: Scene, k: int, x: np.ndarray) -> np.ndarray:
    """Which of the points x, shape (3, n) [m], lie in the channel of tendon k."""
    tendon, half = scene.tendons[k], scene.geometry.channel_width / 2
    end = plates(scene)[tendon.segment - 1][0]
    return (abs(x[1] - tendon.offset[0]) < half) & (abs(x[2] - tendon.offset[1]) < half) & (x[0] < end)


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

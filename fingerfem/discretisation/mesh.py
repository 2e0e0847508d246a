"""The finger's hexahedral mesh with named regions: the section's quadrilaterals swept along the axis."""

from dataclasses import dataclass

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fingerfem.discretisation import chambers, regions
from fingerfem.scene.grid_lines import lines_along, materials_of_cells, section_mesh
from fingerfem.scene.scene import Scene
from fingerfem.scene.sections import PlaneMesh
from fingerfem.scene.tables import Geometry


@dataclass(frozen=True)
class FingerMesh:
    """A mesh with its regions: cells and facets carry the tags of `regions`."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTags
    facets: dolfinx.mesh.MeshTags
    midpoints: np.ndarray  # (3, n) [m], of the cells, before sections are scaled
    columns: np.ndarray  # (n,), of the cells: RUBBER or the tag of the section's channel or hole they are swept from
    lines: np.ndarray  # along x, between the cells [m]
    section: PlaneMesh  # at the clamp
    smallest: float  # smallest cell edge across the section [m]
    has_boxes: bool  # true if all cells are boxes along the axes
    walls: list[np.ndarray]  # of every chamber, its exterior facets on this rank

    def pulled(self, scene: Scene, k: int) -> tuple[np.ndarray, float]:
        """Cells over which the tension of tendon k is spread, shape (n,), and their whole measure.

        The measure of a channel is its area at the clamp [m^2], that of a hole its volume [m^3].
        """
        cells = _of_tendon(scene, k, self.midpoints[0], self.columns)
        area, tendon = self.section.column_area(scene.outline.columns[k].tag), scene.tendons[k]
        if tendon.path == "channel":
            return cells, area
        return cells, area * scene.geometry.plate * float(scene.geometry.sizes[tendon.segment - 1]) ** 3


def build_mesh(scene: Scene, comm: MPI.Comm) -> FingerMesh:
    """The finger's mesh on the ranks of a communicator (collective)."""
    lines = lines_along(scene.outline, scene.mesh)
    section = section_mesh(scene.outline, scene.mesh.cells[1], scene.is_half, scene.mesh.order)
    solid = chambers.solid_cells(scene, section, lines)
    mesh = _swept(section, lines, solid, comm)
    dim = mesh.topology.dim
    cells = np.arange(mesh.topology.index_map(dim).size_local + mesh.topology.index_map(dim).num_ghosts, dtype=np.int32)
    midpoints = dolfinx.mesh.compute_midpoints(mesh, dim, cells).T
    swept_from = solid[mesh.topology.original_cell_index]
    columns = section.tags[swept_from // (len(lines) - 1)]
    materials = materials_of_cells(scene.outline, section, lines).ravel()[swept_from]
    cell_tags = dolfinx.mesh.meshtags(mesh, dim, cells, _regions(scene, midpoints[0], columns, materials))
    mesh.topology.create_connectivity(dim - 1, dim)
    facets = np.sort(dolfinx.mesh.exterior_facet_indices(mesh.topology))
    centres = dolfinx.mesh.compute_midpoints(mesh, dim - 1, facets).T
    kinds, walls = _faces(scene, centres), chambers.walls(scene, section, lines, centres.T)
    for wall in walls:
        kinds[wall] = regions.WALL
    facet_tags = dolfinx.mesh.meshtags(mesh, dim - 1, facets, kinds)
    mesh.geometry.x[:, 1:] *= scene.geometry.size_at(mesh.geometry.x[:, 0])[:, None]
    return FingerMesh(
        mesh,
        cell_tags,
        facet_tags,
        midpoints,
        columns,
        lines,
        section,
        smallest=scene.geometry.thinnest * float(section.edges.min()),
        has_boxes=section.has_rectangles and not scene.geometry.is_tapered,
        walls=[facets[wall] for wall in walls],
    )


def _swept(section: PlaneMesh, lines: np.ndarray, solid: np.ndarray, comm: MPI.Comm) -> dolfinx.mesh.Mesh:
    """Hexahedra between the lines along x: those of the cells q (lines - 1) + i of quadrilateral q that are solid.

    Every rank gives its part.
    """
    slabs = len(lines) - 1
    own = np.array_split(solid, comm.size)[comm.rank]
    quad, slab = np.divmod(own, slabs)
    # Cells with straight sides have their corners; those with curved ones, the nodes of order 2.
    order = 2 if section.curved else 1
    across, quads = section.of_order_2() if section.curved else (section.points, section.quads)
    planes = np.interp(np.arange(order * slabs + 1) / order, np.arange(len(lines)), lines)
    element = basix.ufl.element("Lagrange", "hexahedron", order, shape=(3,))
    x, s, t = np.rint(order * element.basix_element.points).astype(int).T
    cells = quads[quad][:, s + (order + 1) * t] * len(planes) + order * slab[:, None] + x
    mine = np.array_split(np.arange(len(across) * len(planes)), comm.size)[comm.rank]
    point, plane = np.divmod(mine, len(planes))
    points = np.column_stack([planes[plane], across[point]])
    # By keywords: DOLFINx 0.10 takes x and e the other way round. No cell is a ghost by default.
    return dolfinx.mesh.create_mesh(comm, cells=cells.astype(np.int64), x=points, e=ufl.Mesh(element))


def _of_tendon(scene: Scene, k: int, x: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """True for cells, with midpoints at x [m], of tendon k: its channel before its plate, or its hole in it."""
    begin, end = scene.outline.plates[scene.tendons[k].segment - 1]
    inside = x < begin if scene.tendons[k].path == "channel" else (x > begin) & (x < end)
    return np.asarray((columns == scene.outline.columns[k].tag) & inside)


def _regions(scene: Scene, x: np.ndarray, columns: np.ndarray, materials: np.ndarray) -> np.ndarray:
    """Region of the cells whose midpoints are at x [m], shape (n,); materials are numbers, 0 of the rubber."""

    def anywhere(path: str) -> np.ndarray:
        own = [k for k, tendon in enumerate(scene.tendons) if tendon.path == path]
        return np.any([np.zeros(len(x), bool), *(_of_tendon(scene, k, x, columns) for k in own)], axis=0)

    channel, hole = anywhere("channel"), anywhere("straight")
    in_plate = np.any([(x > a) & (x < b) for a, b in scene.outline.plates], axis=0)
    in_tip = x > scene.outline.plates[-1][0]
    region = np.where(channel, regions.RUBBER_CHANNEL, regions.RUBBER) + regions.OF_MATERIAL * materials
    plate = np.where(channel, regions.PLATE_CHANNEL, np.where(hole, regions.PLATE_HOLE, regions.PLATE))
    region[in_plate] = plate[in_plate]
    region[in_tip] = np.where(hole, regions.TIP_HOLE, regions.TIP_PLATE)[in_tip]
    return region.astype(np.int32)


def _faces(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Kind of the exterior facets with midpoints x, shape (3, n) [m]."""
    tolerance = scene.outline.tolerance
    pad = np.zeros(x.shape[1], bool)
    if scene.obstacle is not None and scene.obstacle.pad is not None:
        patch = scene.obstacle.pad
        height, width = scene.geometry.shape.extents
        width = width if patch.width is None else patch.width
        pad = (x[1] > height / 2 - tolerance) & (abs(x[2]) < width / 2)
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

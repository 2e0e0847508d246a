"""The tangent, its volume part by one matrix product for all cells.

With the moduli A = dP/dF at the quadrature points, P the first Piola-Kirchhoff stress, and the cell's map j = dX/dxi, a
cell's tangent is

    K[a i, b k] = sum over q, M, N of  w_q a[i M, k N](q)  dN_a/dxi_M(q)  dN_b/dxi_N(q)
    a[i M, k N] = |j| j^-1[M J] A[i J, k L] j^-1[N L]

and so a row (cell; i, k) of a times a table (q, M, N; a, b). Cells are boxes where the finger is not tapered and its
section is a grid: j is then diagonal, the same at all their points. A comes from the energies by UFL and FFCx, point by
point; nine pairs (i, k) are six by symmetry. FFCx's kernel of the same form makes the whole sum in every cell anew and
takes longer, up to three times as long with order 2.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import basix
import numpy as np
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from fingerfem.discretisation.contact.closest_points import Springs
from fingerfem.discretisation.mesh import FingerMesh

PAIRS = [(i, k) for i in range(3) for k in range(i, 3)]  # of displacement components


class Moduli(NamedTuple):
    """Moduli of one energy.

    Attributes:
        expression: A[i J, k L] at the points of a cell [Pa], by the pairs (i, k), then J, then L.
        regions: tags of the cells that have this energy.
        degree: of the Gauss rule whose points these are.
    """

    expression: fem.Expression
    regions: tuple[int, ...]
    degree: int


def gauss(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Points, shape (q, 3), and weights, shape (q,), of the rule that FFCx takes on hexahedra."""
    points, weights = basix.make_quadrature(basix.CellType.hexahedron, degree)
    return points, weights


class VolumeTangent:
    """Blocks of the tangent by pairs of nodes that share a cell, of this rank's cells.

    Args:
        moduli: of all energies; several may share a cell.
        mesh: of hexahedra, with its regions.
        space: of the displacement.
    """

    def __init__(self, moduli: Sequence[Moduli], mesh: FingerMesh, space: fem.FunctionSpace):
        self._mesh, nodes = mesh.mesh, space.dofmap.list
        owned = mesh.mesh.topology.index_map(3).size_local
        places = mesh.mesh.geometry.x[mesh.mesh.geometry.dofmap[:owned]]
        of_places = mesh.mesh.ufl_domain().ufl_coordinate_element().sub_elements[0]
        self._cells, self._rules = owned, []
        element, count = space.ufl_element().sub_elements[0], nodes.shape[1]
        for degree in sorted({one.degree for one in moduli}):
            points, weights = gauss(degree)
            slopes = element.tabulate(1, points)[1:]  # (J, q, a)
            table = np.einsum("q,Jqa,Lqb->qJLab", weights, slopes, slopes).reshape(9 * len(points), count**2)
            parts = []
            for one in (one for one in moduli if one.degree == degree):
                cells = np.unique(np.concatenate([mesh.cells.find(region) for region in one.regions]))
                parts.append((one.expression, cells[cells < owned].astype(np.int32)))
            pull_back = _of_boxes(places) if mesh.has_boxes else _pull_back(places, of_places.tabulate(1, points)[1:])
            self._rules.append((table, parts, pull_back))
        self._pairs = count**2  # of nodes of a cell
        rows, columns = np.repeat(nodes[:owned], count, axis=1), np.tile(nodes[:owned], (1, count))
        all_nodes = space.dofmap.index_map.size_local + space.dofmap.index_map.num_ghosts
        keys, where = np.unique(rows.astype(np.int64) * all_nodes + columns, return_inverse=True)
        self.rows, self.columns = keys // all_nodes, keys % all_nodes  # nodes of the blocks, sorted
        self._where = where.ravel()
        self._transposed = np.searchsorted(keys, self.columns * all_nodes + self.rows)

    def blocks(self) -> np.ndarray:
        """The blocks at the fields of now, shape (3, 3, blocks) [N/m]."""
        cells = self._cells
        whole, summed = np.zeros((cells * len(PAIRS), self._pairs)), np.empty((3, 3, len(self.rows)))
        for table, parts, pulled_back in self._rules:
            points = len(table) // 9
            moduli = np.zeros((cells, points, len(PAIRS), 3, 3))
            for expression, own in parts:
                moduli[own] += expression.eval(self._mesh, own).reshape(-1, points, len(PAIRS), 3, 3)
            moduli = pulled_back(moduli)
            whole += moduli.transpose(0, 2, 1, 3, 4).reshape(cells * len(PAIRS), -1) @ table
        by_pair = whole.reshape(cells, len(PAIRS), -1)
        for pair, (i, k) in enumerate(PAIRS):
            summed[i, k] = np.bincount(self._where, by_pair[:, pair].ravel(), len(self.rows))
            if i < k:
                summed[k, i] = summed[i, k][self._transposed]
        return summed


def _of_boxes(corners: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Map of moduli A, shape (cells, points, pairs, 3, 3), to those in reference boxes; corners (cells, 8, 3) [m]."""
    sizes = corners[:, 7] - corners[:, 0]  # [m], shape (cells, 3)
    scale = np.prod(sizes, axis=1)[:, None, None] / (sizes[:, :, None] * sizes[:, None, :])
    return lambda moduli: moduli * scale[:, None, None]


def _pull_back(places: np.ndarray, slopes: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Map of moduli A to those in reference cells that are no boxes.

    Args:
        places: positions of the nodes of their geometry, shape (cells, n, 3) [m].
        slopes: derivatives of these nodes' shape functions at the points, shape (3, points, n).
    """
    maps = np.einsum("Mqv,cvi->cqiM", slopes, places)
    inverse = (np.sqrt(np.linalg.det(maps))[..., None, None] * np.linalg.inv(maps))[:, :, None]
    return lambda moduli: inverse @ moduli @ np.swapaxes(inverse, -1, -2)


class Tangent:
    """The tangent with some supports, in one matrix.

    Args:
        volume: its volume part.
        others: the form of what else there is, if anything.
        space: of the displacement.
        supports: what is held.
        springs: says which springs press on this rank's facets, if any may.
    """

    def __init__(
        self,
        volume: VolumeTangent,
        others: fem.Form | None,
        space: fem.FunctionSpace,
        supports: list[fem.DirichletBC],
        springs: Callable[[], Springs] | None = None,
    ):
        self._volume, self._others, self._supports, self._springs = volume, others, supports, springs
        index_map = space.dofmap.index_map
        owned, count = index_map.size_local, index_map.size_local + index_map.num_ghosts
        held = np.zeros(3 * count, bool)
        for support in supports:
            held[support.dof_indices()[0]] = True
        # CSR of this rank's rows, those of ghosts included: what is of three rows of a node is of its row of blocks.
        rows, columns = volume.rows, volume.columns
        wide = np.bincount(rows, minlength=count)  # blocks in a row
        first = np.cumsum(wide) - wide
        self._starts = np.concatenate([[0], np.cumsum(np.repeat(3 * wide, 3))]).astype(np.int32)
        i, k = np.indices((3, 3))[:, :, :, None]
        self._places = 9 * first[rows] + 3 * (i * wide[rows] + np.arange(len(rows)) - first[rows]) + k
        self._columns = np.empty(self._places.size, np.int32)
        self._columns[self._places] = 3 * columns + k
        self._held = held
        self._dropped = self._places[held[3 * rows + i] | held[3 * columns + k]]
        diagonal = (rows == columns) & (rows < owned) & (i == k)
        self._ones = self._places[diagonal & held[3 * rows + i]]
        self.matrix = PETSc.Mat().create(space.mesh.comm)
        self.matrix.setSizes(((3 * owned, None), (3 * owned, None)), bsize=3)
        self.matrix.setType(PETSc.Mat.Type.AIJ)
        numbers = index_map.local_to_global(np.arange(count, dtype=np.int32)).astype(PETSc.IntType)
        numbering = PETSc.LGMap().create(numbers, bsize=3, comm=space.mesh.comm)
        self.matrix.setLGMap(numbering, numbering)
        self.matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        if self.matrix.comm.size == 1:
            self.matrix.setPreallocationCSR((self._starts, self._columns))
        self.matrix.setUp()  # over several ranks the first assembly finds the pattern

    def assemble(self) -> PETSc.Mat:
        """The matrix at the fields of now; the same object every time (collective)."""
        values = np.empty(self._places.size)
        values[self._places] = self._volume.blocks()
        values[self._dropped] = 0.0
        values[self._ones] = 1.0
        self.matrix.zeroEntries()
        add = PETSc.InsertMode.ADD_VALUES
        self.matrix.setValuesLocalCSR(self._starts, self._columns, values, add)
        if self._springs is not None:
            springs = self._springs()
            for nodes, block in zip(springs.nodes.astype(np.int32), springs.stiffness, strict=True):
                kept = ~self._held[(3 * nodes[:, None] + np.arange(3)).ravel()]
                self.matrix.setValuesBlockedLocal(nodes, nodes, block * np.outer(kept, kept), add)
        if self._others is not None:
            assemble_matrix(self.matrix, self._others, bcs=self._supports)
        self.matrix.assemble()
        return self.matrix

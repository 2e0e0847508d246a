"""The finger's nodes in an order that depends on neither the mesh's numbering nor the ranks that share it."""

from functools import cached_property

import numpy as np

from fingerfem.discretisation.problem import Problem
from rom.dataset.grid import levels


class NodeOrder:
    """Nodes sorted by x, then y, then z (collective over the problem's ranks).

    Attributes:
        nodes: at rest, shape (nodes, 3) [m], on every rank.
    """

    def __init__(self, problem: Problem):
        index_map = problem.space.dofmap.index_map
        self._comm, self._owned = problem.comm, index_map.size_local
        points = problem.space.tabulate_dof_coordinates()
        # Ranks own consecutive global indices, so what they own in turn is in global order.
        everywhere = np.concatenate(self._comm.allgather(points[: self._owned]))
        lines, index = zip(*(levels(along) for along in everywhere.T), strict=True)
        self._order = np.lexsort(index[::-1])
        self.nodes = np.column_stack([line[own] for line, own in zip(lines, index, strict=True)])[self._order]
        local = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
        self._indices = index_map.local_to_global(local)

    @cached_property
    def _places(self) -> np.ndarray:
        """Positions of this rank's nodes in the order."""
        places = np.empty_like(self._order)
        places[self._order] = np.arange(len(self._order))
        return places[self._indices]

    def gather(self, field: np.ndarray) -> np.ndarray:
        """Vectors at this rank's nodes, shape (3 nodes or more,), as one field (nodes, 3) on the first rank.

        Other ranks get an empty one.
        """
        parts = self._comm.gather(field[: 3 * self._owned].reshape(-1, 3))
        return np.empty((0, 3)) if parts is None else np.concatenate(parts)[self._order]

    def scatter(self, field: np.ndarray) -> np.ndarray:
        """A field (nodes, 3), known to every rank, at this rank's nodes, ghosts included, shape (3 nodes,)."""
        return field[self._places].ravel()

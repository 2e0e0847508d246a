"""Rigid motion of the plates, which steel makes all but exact.

A tangent turns a plate along a straight line and so stretches it by 1/cos of the angle: against steel that is a huge
force, which Newton then spends iterations on removing. A predicted step is better with its plates turned rigidly.
"""

import numpy as np
from mpi4py import MPI

from fingerfem.discretisation.problem import Problem
from fingerfem.scene.grid_lines import in_plate


class RigidPlates:
    """The plates of a finger."""

    def __init__(self, problem: Problem):
        self._problem, self._plates = problem, []
        points = problem.space.tabulate_dof_coordinates()
        owned = problem.space.dofmap.index_map.size_local
        for k in range(len(problem.scene.geometry.segments)):
            nodes = np.flatnonzero(in_plate(problem.scene.outline, k, points.T))
            mirrored, towards = problem.scene.is_half, np.array(problem.bodies[0].direction)
            self._plates.append(Plate(problem.comm, nodes, nodes < owned, points[nodes], towards, mirrored=mirrored))

    def move(self, before: np.ndarray) -> None:
        """Replace what they have moved since the displacement `before`, shape (3 nodes,) [m], by rigid motions."""
        for plate in self._plates:
            plate.move_rigidly(before.reshape(-1, 3), self._problem.displacement.reshape(-1, 3))


class Plate:
    """The nodes of one plate, on the ranks that share it.

    Args:
        comm: those ranks.
        nodes: local indices of this rank's nodes, ghosts included, shape (n,).
        owned: which of them this rank owns, shape (n,).
        points: where they are at rest, shape (n, 3) [m].
        towards: direction of the obstacle, shape (3,) [-].
        mirrored: the nodes are half a plate, whose mirror image in z = 0 moves alike.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        nodes: np.ndarray,
        owned: np.ndarray,
        points: np.ndarray,
        towards: np.ndarray,
        mirrored: bool,
    ):
        self._comm, self._nodes, self._owned, self._points = comm, nodes, owned, points
        self._towards, self._mirrored = towards, mirrored
        self._count = comm.allreduce(int(owned.sum()))

    def move_rigidly(self, before: np.ndarray, displacement: np.ndarray) -> None:
        """Replace what the plate's nodes have moved since `before` by the rigid motion nearest to it (collective).

        The rotation is that of Kabsch, Acta Cryst. A32, 922 (1976), doi:10.1107/S0567739476001873. The plate reaches
        as far towards the obstacle as it did in `displacement`, so that one that touches it stays there.

        Args:
            before: displacements of all nodes of this rank, shape (nodes, 3) [m].
            displacement: the same after the motion; its plate's rows are replaced.
        """
        old, new = self._points + before[self._nodes], self._points + displacement[self._nodes]
        old_centre, new_centre = self._mean(old), self._mean(new)
        arms = old - old_centre
        correlation = self._comm.allreduce(arms[self._owned].T @ (new - new_centre)[self._owned])
        if not np.isfinite(correlation).all():
            return  # Newton's to refuse
        if self._mirrored:
            correlation[2, :2] = correlation[:2, 2] = 0.0
        left, _, right = np.linalg.svd(correlation)
        turned = arms @ left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right + new_centre
        turned += (self._farthest(new) - self._farthest(turned)) * self._towards
        displacement[self._nodes] = turned - self._points

    def _mean(self, values: np.ndarray) -> np.ndarray:
        mean = self._comm.allreduce(values[self._owned].sum(axis=0)) / self._count
        if self._mirrored:
            mean[2] = 0.0
        return mean

    def _farthest(self, positions: np.ndarray) -> float:
        return self._comm.allreduce(float((positions @ self._towards).max(initial=-np.inf)), op=MPI.MAX)

"""Wrenches on the plates, in the plates' own frames: nodal forces, and the low-rank stiffness of their following."""

from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.mesh import FingerMesh
from fingerfem.mechanics import rigid_plate
from fingerfem.mechanics.rigid_plate import Pose
from fingerfem.scene.scene import Scene


class LowRank(NamedTuple):
    """sum_k left_k right_k^T, both of this rank's owned values, shape (rank, values)."""

    left: np.ndarray
    right: np.ndarray


class PlateLoads:
    """The plates of a finger as bodies that wrenches press on (collective).

    Args:
        scene: the scene; the whole finger is modelled.
        mesh: its mesh.
        space: of the displacement.
    """

    def __init__(self, scene: Scene, mesh: FingerMesh, space: fem.FunctionSpace):
        self._comm: MPI.Comm = space.mesh.comm
        self._owned = space.dofmap.index_map.size_local
        points = space.tabulate_dof_coordinates()[: self._owned]
        where = fem.Function(fem.functionspace(mesh.mesh, ("DG", 0)))
        v, x = ufl.TestFunction(space), ufl.SpatialCoordinate(mesh.mesh)
        dx = ufl.Measure(
            "dx", mesh.mesh, subdomain_data=mesh.cells, metadata={"quadrature_degree": 2 * scene.mesh.order}
        )
        plates = dx(regions.PLATES)
        mean = form_cache.form(where * sum(v[i] for i in range(3)) * plates)
        first = form_cache.form(where * ufl.inner(v, x) * plates)
        self._plates: list[_Plate] = []
        for start, end in scene.outline.plates:
            where.x.array[:] = (mesh.midpoints[0] > start) & (mesh.midpoints[0] < end)
            weights, moments = (self._assembled(form) for form in (mean, first))
            volume = self._sum(weights[:, 0].sum())
            centre = self._sum(weights[:, :1].T @ points)[0] / volume
            arms = moments - weights * centre
            self._plates.append(_Plate(points, weights[:, 0] / volume, arms))

    def _assembled(self, form: fem.Form) -> np.ndarray:
        b = assemble_vector(form)
        b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        values = b.array_r.reshape(-1, 3).copy()
        b.destroy()
        return values

    def _sum(self, values: np.ndarray) -> np.ndarray:
        return np.asarray(self._comm.allreduce(values))

    def poses(self, displacement: np.ndarray) -> list[Pose]:
        """The plates' poses at a displacement of this rank's nodes, shape (3 nodes,) [m], from clamp to tip."""
        moved = displacement.reshape(-1, 3)[: self._owned]
        moments = [plate.moments(moved) for plate in self._plates]
        return [rigid_plate.pose(self._sum(centre), self._sum(moment)) for centre, moment in moments]

    def forces(self, poses: list[Pose], wrenches: np.ndarray) -> np.ndarray:
        """Nodal forces, shape (owned values,) [N], of wrenches in the plates' frames, shape (plates, 6) [N, N m]."""
        nodal = np.zeros(3 * self._owned)
        for plate, at, wrench in zip(self._plates, poses, wrenches, strict=True):
            nodal += plate.nodal(*rigid_plate.generalised_forces(at, wrench))
        return nodal

    def following(self, poses: list[Pose], wrenches: np.ndarray) -> LowRank:
        """Change of the nodal forces with the displacement [N/m]: forces that turn with their plates, rank 3 each.

        The effect of a plate's own stretching, a millionth of that, is left out.
        """
        left, right = [], []
        for plate, at, wrench in zip(self._plates, poses, wrenches, strict=True):
            if wrench.any():
                left += [plate.nodal(*change) for change in rigid_plate.changes_with_rotation(at, wrench)]
                right += [plate.nodal(np.zeros(3), gradient) for gradient in rigid_plate.rotation_gradients(at)]
        empty = np.zeros((0, 3 * self._owned))
        return LowRank(np.array(left), np.array(right)) if left else LowRank(empty, empty)

    def motion(self, poses: list[Pose], change: np.ndarray) -> np.ndarray:
        """Motions of the plates by owned displacements, shape (3 nodes,): R^T dc and R^T dtheta, shape (plates, 6)."""
        motions = []
        for plate, at in zip(self._plates, poses, strict=True):
            centre, moment = (self._sum(part) for part in plate.change(change.reshape(-1, 3)))
            turned = [np.sum(gradient * moment) for gradient in rigid_plate.rotation_gradients(at)]
            motions.append(np.concatenate([at.rotation.T @ centre, turned]))
        return np.array(motions)


class _Plate:
    """One plate on this rank: nodes at rest, shape (nodes, 3) [m], weights of their mean [-] and of M [m^4]."""

    def __init__(self, points: np.ndarray, mean: np.ndarray, arms: np.ndarray):
        own = np.flatnonzero(np.any(arms != 0, axis=1) | (mean != 0))
        self._count, self._own = len(points), own
        self._points, self._mean, self._arms = points[own], mean[own], arms[own]

    def moments(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """This rank's parts of c and M."""
        places = self._points + displacement[self._own]
        return self._mean @ places, places.T @ self._arms

    def change(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """This rank's parts of the changes of c and M."""
        moved = displacement[self._own]
        return self._mean @ moved, moved.T @ self._arms

    def nodal(self, force: np.ndarray, on_moment: np.ndarray) -> np.ndarray:
        """Nodal forces of what does work on c and on M, shape (values,)."""
        forces = np.zeros((self._count, 3))
        forces[self._own] = np.outer(self._mean, force) + self._arms @ on_moment.T
        return forces.ravel()

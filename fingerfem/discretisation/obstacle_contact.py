"""What the obstacle and the finger do to each other: by the compiled forms, and by springs at closest points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation import regions
from fingerfem.discretisation.closest_points import NONE, ClosestPoints, Springs
from fingerfem.discretisation.forms import ContactForms
from fingerfem.mechanics import contact

if TYPE_CHECKING:
    from fingerfem.discretisation.problem import Problem


class ObstacleContact:
    """Contact of a problem in the state that it is in (all methods are collective).

    Args:
        problem: of a scene with an obstacle.
        forms: its contact's.
    """

    def __init__(self, problem: Problem, forms: ContactForms):
        self._problem, self._forms, self._held = problem, forms, False
        self._known: tuple[np.ndarray, float, bool] = np.zeros(0), 0.0, False  # what `_found` is of
        self._found = NONE
        self._points: ClosestPoints | None = None
        if not problem.obstacle.is_flat:
            facets = np.concatenate([problem.mesh.facets.find(kind) for kind in regions.PLATE_FACETS])
            stiffness = float(problem.fields.stiffness.value)
            if problem.scene.obstacle is not None and problem.scene.obstacle.method == "nitsche":
                stiffness *= contact.PLATES
            self._points = ClosestPoints(problem.space, np.sort(facets), stiffness, problem.obstacle)

    def springs(self) -> Springs:
        """Those of this rank that press."""
        problem = self._problem
        if self._points is None or problem.distance is None:
            return NONE
        displacement, *others = self._known
        same = others == [problem.distance, self._held] and np.array_equal(displacement, problem.displacement)
        if not problem.comm.allreduce(same, op=MPI.LAND):
            self._known = problem.displacement.copy(), problem.distance, self._held
            self._found = self._points.springs(*self._known)
        return self._found

    def hold(self, held: bool) -> None:
        """Whether plates that press on a round obstacle now do not lose it while Newton's method is on its way.

        One that has left it by less than the next step makes good would be off to where no obstacle were.
        """
        self._held = False
        pressed = held and len(self.springs().gaps) > 0
        self._held = self._problem.comm.allreduce(pressed, op=MPI.LOR)

    def lets_go(self) -> bool:
        """Let go of what is held, if the obstacle would have to pull; whether it was so."""
        pulls = self._held and bool((self.springs().gaps > 0).any())
        pulls = self._problem.comm.allreduce(pulls, op=MPI.LOR)
        self._held = self._held and not pulls
        return pulls

    def _sum(self, own: float) -> float:
        return self._problem.copies * float(self._problem.comm.allreduce(own))

    def energy(self) -> float:
        """[J]."""
        return self._problem.scalar(self._forms.energy) + self._sum(self.springs().energy)

    def force(self) -> float:
        """N = -dP/dd [N]; of a plane the integral of the pressure."""
        along = self.springs().forces.sum(axis=(0, 1)) @ self._problem.obstacle.direction
        return self._problem.scalar(self._forms.force) + self._sum(float(along))

    def stiffness(self) -> float:
        """-dN/dd at a fixed displacement [N/m]."""
        moved = self._moved() @ self._problem.obstacle.direction
        return self._problem.scalar(self._forms.stiffness) + self._sum(float(moved.sum()))

    def force_gradient(self) -> PETSc.Vec:
        """dN/du [N/m], zero where held. The caller destroys the vector."""
        return self._problem.gradient(self._forms.force_gradient, self._nodal(self._moved()))

    def _moved(self) -> np.ndarray:
        """How the force along the obstacle's direction changes with the nodes of facets that press, (m, n, 3) [N/m]."""
        found, direction = self.springs(), np.array(self._problem.obstacle.direction)
        m, n = found.nodes.shape
        return np.einsum("i,maibj->mbj", direction, found.stiffness.reshape(m, n, 3, n, 3))

    def penetration(self) -> float:
        """How far plates are inside a round obstacle at most [m]."""
        return -float(self._problem.comm.allreduce(float(self.springs().gaps.min(initial=0.0)), op=MPI.MIN))

    def gap_work(self) -> float:
        """Integral of pressure times |gap| [J], zero of an exact solution."""
        return self._problem.scalar(self._forms.gap_work) + self._sum(self.springs().work)

    def nodal_force(self) -> np.ndarray:
        """What this rank's nodes, ghosts included, press on the obstacle with, shape (nodes, 3) [N]."""
        return self._problem.nodal(self._forms.nodal_force, self.spring_forces())

    def spring_forces(self) -> np.ndarray:
        """This rank's springs' part of it, before it is summed over ranks, shape (nodes, 3) [N]."""
        return self._nodal(self.springs().forces)

    def _nodal(self, values: np.ndarray) -> np.ndarray:
        found, nodes = np.zeros((len(self._problem.displacement) // 3, 3)), self.springs().nodes
        if nodes.size:
            np.add.at(found, nodes, values)
        return found

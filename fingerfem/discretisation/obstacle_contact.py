"""What the obstacle and the finger do to each other: by the compiled forms, and by springs at closest points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.closest_points import NONE, ClosestPoints, Springs
from fingerfem.discretisation.forms import ContactForms, Fields
from fingerfem.discretisation.friction_points import FrictionPoints
from fingerfem.mechanics.obstacles import Body


class StiffFacets(NamedTuple):
    """Facets with springs at their closest points: local indices, and the springs' stiffness per area [N/m^3]."""

    facets: np.ndarray
    stiffness: float


class ObstacleContact:
    """Contact of a finger in the state that its fields are in (all methods are collective).

    Args:
        assembly: of its space.
        forms: its contact's.
        fields: displacement and distance.
        obstacle: what it touches.
        stiff: of its facets, those that are not in the forms.
    """

    def __init__(
        self, assembly: Assembly, forms: ContactForms, fields: Fields, obstacle: Body, stiff: StiffFacets | None
    ):
        self._assembly, self._forms, self._fields, self._held = assembly, forms, fields, False
        self._direction = np.array(obstacle.direction)
        self._points = None if stiff is None else ClosestPoints(assembly.space, *stiff, obstacle)
        self._known: tuple[np.ndarray, float, bool] = np.zeros(0), 0.0, False  # what `_found` is of
        self._found = NONE
        self.friction: FrictionPoints | None = None  # of a history with friction

    def springs(self) -> Springs:
        """Those of this rank that press."""
        if self.friction is not None:
            return self.friction.springs(self._fields.u.x.array)
        if self._points is None:
            return NONE
        now = self._fields.u.x.array, float(self._fields.distance.value), self._held
        same = self._known[1:] == now[1:] and np.array_equal(self._known[0], now[0])
        if not self._assembly.comm.allreduce(same, op=MPI.LAND):
            self._known = now[0].copy(), *now[1:]
            self._found = self._points.springs(*now)
        return self._found

    def hold(self, held: bool) -> None:
        """Whether plates that press on a round obstacle now keep contact during Newton's iterations.

        Otherwise an iterate that leaves it by a nanometre would lose all contact, and the next one would be the free
        finger's.
        """
        self._held = False
        pressed = held and len(self.springs().gaps) > 0
        self._held = self._assembly.comm.allreduce(pressed, op=MPI.LOR)

    def lets_go(self) -> bool:
        """Let go of what is held, if the obstacle would have to pull; whether it was so."""
        pulls = self._held and bool((self.springs().gaps > 0).any())
        pulls = self._assembly.comm.allreduce(pulls, op=MPI.LOR)
        self._held = self._held and not pulls
        return pulls

    def energy(self) -> float:
        """[J]."""
        return self._assembly.scalar(self._forms.energy) + self._assembly.summed(self.springs().energy)

    def force(self) -> float:
        """N = -dP/dd [N]; of a plane the integral of the pressure."""
        along = self.springs().forces.sum(axis=(0, 1)) @ self._direction
        return self._assembly.scalar(self._forms.force) + self._assembly.summed(float(along))

    def stiffness(self) -> float:
        """-dN/dd at a fixed displacement [N/m]."""
        moved = self._moved() @ self._direction
        return self._assembly.scalar(self._forms.stiffness) + self._assembly.summed(float(moved.sum()))

    def force_gradient(self) -> PETSc.Vec:
        """dN/du [N/m], zero where held. The caller destroys the vector."""
        return self._assembly.gradient(self._forms.force_gradient, self._nodal(self._moved()))

    def _moved(self) -> np.ndarray:
        """How the force along the obstacle's direction changes with the nodes of facets that press, (m, n, 3) [N/m]."""
        found = self.springs()
        m, n = found.nodes.shape
        return np.einsum("i,maibj->mbj", self._direction, found.stiffness.reshape(m, n, 3, n, 3))

    def penetration(self) -> float:
        """How far plates are inside a round obstacle at most [m]."""
        return -float(self._assembly.comm.allreduce(float(self.springs().gaps.min(initial=0.0)), op=MPI.MIN))

    def gap_work(self) -> float:
        """Integral of pressure times |gap| [J], zero of an exact solution."""
        return self._assembly.scalar(self._forms.gap_work) + self._assembly.summed(self.springs().work)

    def nodal_force(self) -> np.ndarray:
        """What this rank's nodes, ghosts included, press on the obstacle with, shape (nodes, 3) [N]."""
        return self._assembly.nodal(self._forms.nodal_force, self.spring_forces())

    def normal_force(self) -> np.ndarray:
        """What this rank's nodes press on a plane with along its normal, ghosts included, shape (nodes, 3) [N]."""
        return self._assembly.nodal(self._forms.nodal_force)

    def spring_forces(self) -> np.ndarray:
        """This rank's springs' part of it, before it is summed over ranks, shape (nodes, 3) [N]."""
        return self._nodal(self.springs().forces)

    def _nodal(self, values: np.ndarray) -> np.ndarray:
        found, nodes = np.zeros((len(self._fields.u.x.array) // 3, 3)), self.springs().nodes
        if nodes.size:
            np.add.at(found, nodes, values)
        return found

"""Contact of obstacle and finger: by the compiled forms, and by springs at closest points."""

from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fingerfem.discretisation.assembly import Assembly
from fingerfem.discretisation.contact.closest_points import NONE, ClosestPoints, Springs, together
from fingerfem.discretisation.contact.friction_points import FrictionPoints
from fingerfem.discretisation.forms import ContactForms, Fields
from fingerfem.mechanics.obstacles import Body


class StiffFacets(NamedTuple):
    """Facets with springs at their closest points: local indices, and the springs' stiffness per area [N/m^3]."""

    facets: np.ndarray
    stiffness: float


class BodyContact:
    """Contact with one body (all methods are collective).

    Args:
        assembly: of the finger's space.
        forms: of this contact.
        fields: displacement and distance.
        body: what the finger touches.
        stiff: of its facets, those that are not in the forms.
    """

    def __init__(self, assembly: Assembly, forms: ContactForms, fields: Fields, body: Body, stiff: StiffFacets | None):
        self.forms, self.direction = forms, np.array(body.direction)
        self._assembly, self._fields, self._held = assembly, fields, False
        self.closest = None if stiff is None else ClosestPoints(assembly.space, *stiff, body)
        self._known: tuple[np.ndarray, float, bool] = np.zeros(0), 0.0, False  # state that `_found` belongs to
        self._found = NONE

    def weigh(self, factor: float) -> None:
        """See ObstacleContact."""
        if self.closest is not None:
            self.closest.factor = factor
            self._known = np.zeros(0), 0.0, False

    def springs(self) -> Springs:
        """Springs of this rank that press."""
        if self.closest is None:
            return NONE
        now = self._fields.u.x.array, float(self._fields.distance.value), self._held
        same = self._known[1:] == now[1:] and np.array_equal(self._known[0], now[0])
        if not self._assembly.comm.allreduce(same, op=MPI.LAND):
            self._known = now[0].copy(), *now[1:]
            self._found = self.closest.springs(*now)
        return self._found

    def hold(self, held: bool) -> None:
        """See ObstacleContact."""
        self._held = False
        pressed = held and len(self.springs().gaps) > 0
        self._held = self._assembly.comm.allreduce(pressed, op=MPI.LOR)

    def lets_go(self) -> bool:
        """See ObstacleContact."""
        pulls = self._held and bool((self.springs().gaps > 0).any())
        pulls = self._assembly.comm.allreduce(pulls, op=MPI.LOR)
        self._held = self._held and not pulls
        return pulls

    def force(self) -> float:
        """N = -dP/dd [N]; of a plane the integral of the pressure."""
        along = self.springs().forces.sum(axis=(0, 1)) @ self.direction
        return self._assembly.scalar(self.forms.force) + self._assembly.summed(float(along))

    def moved(self) -> np.ndarray:
        """Derivative of the springs' force along the body's direction by their nodes, shape (m, n, 3) [N/m]."""
        springs = self.springs()
        m, n = springs.nodes.shape
        return np.einsum("i,maibj->mbj", self.direction, springs.stiffness.reshape(m, n, 3, n, 3))


class ObstacleContact:
    """Contact of a finger in the state that its fields are in, with all bodies (all methods are collective).

    Args:
        assembly: of its space.
        bodies: its contact with each.
        fields: displacement and distance.
    """

    def __init__(self, assembly: Assembly, bodies: list[BodyContact], fields: Fields):
        self._assembly, self.bodies, self._fields = assembly, bodies, fields
        self.friction: FrictionPoints | None = None  # of a history with friction
        self._stiffness = float(fields.stiffness.value)

    def springs(self) -> Springs:
        """Springs of this rank that press."""
        parts = [one.springs() for one in self.bodies]
        if self.friction is not None:
            parts.append(self.friction.springs())
        return together(parts)

    def weigh(self, factor: float) -> None:
        """Make the penalty's stiffness this many times the scene's [-]; 0 takes contact away."""
        self._fields.stiffness.value = factor * self._stiffness
        for one in self.bodies:
            one.weigh(factor)

    def hold(self, held: bool) -> None:
        """Sets whether plates that press on a round body now keep contact during Newton's iterations.

        Otherwise an iterate that leaves it by a nanometre would lose all contact, and the next one would be the free
        finger's.
        """
        for one in self.bodies:
            one.hold(held)

    def lets_go(self) -> bool:
        """Let go of what is held, where a body would have to pull; whether it was so."""
        pulled = [one.lets_go() for one in self.bodies]  # of all of them: each is collective
        return any(pulled)

    def energy(self) -> float:
        """[J]."""
        return self._scalar("energy") + self._assembly.summed(self.springs().energy)

    def forces(self) -> np.ndarray:
        """Contact forces of all bodies, each along its motion by d, N = -dP/dd, shape (bodies,) [N]."""
        return np.array([one.force() for one in self.bodies])

    def force(self) -> float:
        """Their sum [N]; of a plane the integral of the pressure."""
        return float(self.forces().sum())

    def stiffness(self) -> float:
        """-dN/dd at a fixed displacement [N/m]."""
        moved = sum(float((one.moved() @ one.direction).sum()) for one in self.bodies)
        return self._scalar("stiffness") + self._assembly.summed(moved)

    def force_gradient(self) -> PETSc.Vec:
        """dN/du [N/m], zero where held. The caller destroys the vector."""
        gradient: PETSc.Vec | None = None
        for one in self.bodies:
            own = self._assembly.gradient(one.forms.force_gradient, self._nodal(one.springs().nodes, one.moved()))
            if gradient is None:
                gradient = own
                continue
            gradient.axpy(1.0, own)
            own.destroy()
        return gradient

    def penetration(self) -> float:
        """Largest penetration of plates into a round body [m]."""
        return -float(self._assembly.comm.allreduce(float(self.springs().gaps.min(initial=0.0)), op=MPI.MIN))

    def gap_work(self) -> float:
        """Integral of pressure times |gap| [J], zero of an exact solution."""
        return self._scalar("gap_work") + self._assembly.summed(self.springs().work)

    def nodal_force(self) -> np.ndarray:
        """Forces of this rank's nodes, ghosts included, on the obstacle, shape (nodes, 3) [N]."""
        first, *others = (one.forms.nodal_force for one in self.bodies)
        pressed = self._assembly.nodal(first, self.spring_forces())
        return np.asarray(pressed + sum(map(self._assembly.nodal, others)))

    def spring_forces(self) -> np.ndarray:
        """Nodal forces of this rank's springs, before they are summed over ranks, shape (nodes, 3) [N]."""
        springs = self.springs()
        return self._nodal(springs.nodes, springs.forces)

    def _scalar(self, name: str) -> float:
        return sum(self._assembly.scalar(getattr(one.forms, name)) for one in self.bodies)

    def _nodal(self, nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
        sums = np.zeros((len(self._fields.u.x.array) // 3, 3))
        if nodes.size:
            np.add.at(sums, nodes, values)
        return sums

"""Velocity of contact: points that press on an obstacle move with its velocity.

Contact forces are those of the penalty at the end of a step, so that a point that leaves is not pushed any more. Their
work over a step is at most the fall of the penalty's energy, which is convex. An impact leaves the velocity that the
step's difference quotients give a point that was stopped. It is removed by an implicit step of damping with
the penalty's own stiffness K of all points that press, and the stiffness P of plates, which stop as a whole,

    (M + c h^2 (K + P)) v+ = M v + c h^2 K v_obstacle,

which, where the obstacle rests, only takes energy. The obstacle takes the momentum c h^2 K (v+ - v_obstacle); P takes
none. A mass far below h^2 K then has the obstacle's velocity along the normal: p dg/dt = 0. As h falls below the time
of the penalty itself, the damping vanishes.
"""

from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from fingerfem.discretisation import form_cache, regions
from fingerfem.discretisation.contact.closest_points import Springs
from fingerfem.discretisation.forms import contact_groups, quadrature_degree, surface_measure
from fingerfem.discretisation.volume_energies import volume_measure
from fingerfem.dynamics.moving_problem import MovingProblem, product, solution
from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.mechanics import contact, kinematics
from fingerfem.scene.laws import plate_law

DAMPING = 10.0  # c [-]


class Kept(NamedTuple):
    """Persistent values, and the momentum and force that obstacles took, each along its own direction.

    Attributes:
        velocity, acceleration: shape (values,) [m/s], [m/s^2].
        momentum: the difference of velocity, times the mass [N s].
        force: the difference of acceleration, times the mass [N].
    """

    velocity: np.ndarray
    acceleration: np.ndarray
    momentum: float
    force: float


class Persistency:
    """The velocity of what presses (all of one rank).

    Args:
        problem: a finger before an obstacle.
    """

    def __init__(self, problem: MovingProblem):
        scene, fields, space = problem.scene, problem.fields, problem.space
        assert problem.contact is not None
        self._problem, self._contact = problem, problem.contact
        v, w, ds = ufl.TestFunction(space), ufl.TrialFunction(space), surface_measure(scene, problem.mesh)
        flat = fem.Constant(problem.mesh.mesh, np.zeros((3, 3)))  # no curvature: M + c h^2 K is to be definite
        self._stiffness = [
            form_cache.form(
                sum(
                    contact.penalty_tangent(one.gap, one.normal, flat, one.stiffness, v, w) * one.measure
                    for one in contact_groups(scene, body, ds, fields, fields.distance)
                )
            )
            for body in problem.bodies
        ]
        of_plates = fem.Constant(problem.mesh.mesh, plate_law(scene.law).young_modulus)
        strains = (kinematics.strain_variation(fields.u, one) for one in (v, w))
        plates = volume_measure(problem.mesh, quadrature_degree(scene.mesh.order))(regions.PLATES)
        self._plates = form_cache.form(of_plates * ufl.inner(*strains) * plates)
        self._matrix = problem.matrix.duplicate()
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._factorisation = Factorisation(self._matrix)

    def keep(self, velocity: np.ndarray, acceleration: np.ndarray, step: float, speed: float) -> Kept:
        """Make a velocity and an acceleration persistent at the current displacement.

        Args:
            velocity: shape (values,) [m/s].
            acceleration: shape (values,) [m/s^2].
            step: h [s].
            speed: of the obstacle along its direction [m/s].

        Raises:
            NotConverged: the matrix has no factors.
        """
        problem, matrix, factor = self._problem, self._matrix, DAMPING * step**2
        if not np.abs(self._contact.nodal_force()).max(initial=0.0) > 0:
            return Kept(velocity, acceleration, 0.0, 0.0)
        matrix.zeroEntries()
        pulled, dampings = np.zeros_like(velocity), []
        for form, body in zip(self._stiffness, self._contact.bodies, strict=True):
            own, along = self._stiffness_of(form, body.springs()), np.tile(body.direction, len(velocity) // 3)
            own.scale(factor)
            pulled += product(own, speed * along)
            matrix.axpy(1.0, own, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
            dampings.append((own, along))
        plates = self._assembled(self._plates)
        matrix.axpy(factor, plates, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        plates.destroy()
        matrix.axpy(1.0, problem.mass, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        for row in problem.held:
            matrix.setValue(row, row, 1.0)
        matrix.assemble()
        reason = self._factorisation.update()
        if reason is not None:
            raise NotConverged(f"the velocity of contact cannot be found: {reason}")
        velocity, acceleration = (
            solution(self._factorisation, one, problem.held)
            for one in (problem.times_mass(velocity) + pulled, problem.times_mass(acceleration))
        )
        momentum, force = (
            problem.summed(sum(float(along @ product(own, one - of * along)) for own, along in dampings))
            for one, of in ((velocity, speed), (acceleration, 0.0))
        )
        for own, _ in dampings:
            own.destroy()
        return Kept(velocity, acceleration, momentum, force)

    def _stiffness_of(self, form: fem.Form, springs: Springs) -> PETSc.Mat:
        """K of one body: by the form, and of springs along their normals, k dg dg^T = f f^T / (k g^2)."""
        problem = self._problem
        assembled, matrix = self._assembled(form), problem.mass.duplicate()
        matrix.axpy(1.0, assembled, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        assembled.destroy()
        free = np.where(np.isin(springs.nodes, problem.held[::3] // 3)[:, :, None], 0.0, springs.forces)
        forces = np.linalg.norm(springs.forces.sum(axis=1), axis=1)  # k |g|: shape functions have the sum 1
        for nodes, own, work in zip(springs.nodes.astype(np.int32), free, forces * np.abs(springs.gaps), strict=True):
            if work > 0:
                matrix.setValuesBlockedLocal(nodes, nodes, np.outer(own, own) / work, PETSc.InsertMode.ADD_VALUES)
        matrix.assemble()
        return matrix

    def _assembled(self, form: fem.Form) -> PETSc.Mat:
        """A form, without rows and columns that supports hold."""
        matrix = assemble_matrix(form, bcs=self._problem.supports, diagonal=0.0)
        matrix.assemble()
        return matrix

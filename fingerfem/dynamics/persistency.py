"""Velocity of contact: points that press on an obstacle move with its velocity.

Contact forces are those of the penalty at the end of a step, so that a point that leaves is not pushed any more. Their
work over a step is at most the fall of the penalty's energy, which is convex. An impact leaves the velocity that the
step's difference quotients give a point that was stopped. It is removed by an implicit step of damping with
the penalty's own stiffness K of all points that press,

    (M + c h^2 K) v+ = M v + c h^2 K v_obstacle,

which, where the obstacle rests, only takes energy. A point with a mass far below h^2 K then has the obstacle's velocity
along the normal: p dg/dt = 0. As h falls below the time of the penalty itself, the damping vanishes.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from fingerfem.discretisation import form_cache
from fingerfem.discretisation.contact.closest_points import Springs
from fingerfem.discretisation.forms import contact_groups, surface_measure
from fingerfem.dynamics.moving_problem import MovingProblem, product, solution
from fingerfem.equilibrium.factorisation import Factorisation
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.mechanics import contact

DAMPING = 10.0  # c [-]


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
        self._matrix = problem.matrix.duplicate()
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._factorisation = Factorisation(self._matrix)

    def keep(self, values: list[np.ndarray], step: float, speed: float) -> list[np.ndarray]:
        """Velocities or accelerations, shape (values,), made persistent at the displacement of now.

        Args:
            values: the first one is a velocity [m/s].
            step: h [s].
            speed: of the obstacle along its direction [m/s].

        Raises:
            NotConverged: the matrix has no factors.
        """
        problem, matrix, factor = self._problem, self._matrix, DAMPING * step**2
        if not np.abs(self._contact.nodal_force()).max(initial=0.0) > 0:
            return values
        matrix.zeroEntries()
        pulled = np.zeros_like(values[0])
        for form, body in zip(self._stiffness, self._contact.bodies, strict=True):
            own = self._stiffness_of(form, body.springs())
            own.scale(factor)
            pulled += product(own, np.tile(speed * body.direction, len(pulled) // 3))
            matrix.axpy(1.0, own, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
            own.destroy()
        matrix.axpy(1.0, problem.mass, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        for row in problem.held:
            matrix.setValue(row, row, 1.0)
        matrix.assemble()
        reason = self._factorisation.update()
        if reason is not None:
            raise NotConverged(f"the velocity of contact cannot be found: {reason}")
        first, *others = (problem.times_mass(one) for one in values)
        return [solution(self._factorisation, one, problem.held) for one in (first + pulled, *others)]

    def _stiffness_of(self, form: fem.Form, springs: Springs) -> PETSc.Mat:
        """K of one body: by the form, and of springs along their normals, k dg dg^T = f f^T / (k g^2)."""
        problem = self._problem
        assembled, matrix = assemble_matrix(form, bcs=problem.supports, diagonal=0.0), problem.mass.duplicate()
        assembled.assemble()
        matrix.axpy(1.0, assembled, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        assembled.destroy()
        free = np.where(np.isin(springs.nodes, problem.held[::3] // 3)[:, :, None], 0.0, springs.forces)
        forces = np.linalg.norm(springs.forces.sum(axis=1), axis=1)  # k |g|: shape functions have the sum 1
        for nodes, own, work in zip(springs.nodes.astype(np.int32), free, forces * np.abs(springs.gaps), strict=True):
            if work > 0:
                matrix.setValuesBlockedLocal(nodes, nodes, np.outer(own, own) / work, PETSc.InsertMode.ADD_VALUES)
        matrix.assemble()
        return matrix

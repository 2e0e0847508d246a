"""The finger solved as a user of DOLFINx would at first: its residual in UFL, a solver with its default settings.

The residual is that of the project's own forms, and FFCx compiles it and its derivative; DOLFINx assembles and solves.
What is set is only the accuracy, to the project's own, and the linear solver where a setting says so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import dolfinx.fem.petsc
import dolfinx.nls.petsc
import numpy as np
import ufl
from numpy.linalg import norm
from petsc4py import PETSc
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from fingerfem.discretisation import regions
from fingerfem.discretisation.forms import contact_groups, quadrature_degree, surface_measure
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import Term, constants, residual_of, rubber_terms, volume_measure
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.mechanics import contact, strain_energy, tendons
from fingerfem.scene.laws import plate_law


def residual(problem: Problem) -> Any:
    """Rubber, plates, tendons in channels, penalty contact; in UFL."""
    scene, fields, number = problem.scene, problem.fields, constants(problem.mesh.mesh)
    degree = quadrature_degree(scene.mesh.order)
    bodies = rubber_terms(scene.law, number, degree)
    bodies.append(Term(strain_energy.energy(plate_law(scene.law), number), regions.PLATES, degree))
    bodies.append(Term(tendons.channelled(fields.tension_density), regions.CHANNELS, degree))
    integrals = [(one.energy, volume_measure(problem.mesh, one.degree)(one.regions)) for one in bodies]
    v = ufl.TestFunction(problem.space)
    groups = contact_groups(scene, problem.bodies[0], surface_measure(scene, problem.mesh), fields, fields.distance)
    pushing = [contact.penalty_residual(one.gap, one.normal, one.stiffness, v) * one.measure for one in groups]
    return residual_of(integrals, fields.u) + sum(pushing)


class Equations(dolfinx.fem.petsc.NonlinearProblem):
    """DOLFINx's own problem, which counts its tangents.

    Attributes:
        tangents: how many were assembled, each of which is factorised.
    """

    def __init__(self, problem: Problem):
        super().__init__(residual(problem), problem.fields.u, problem.supports)
        self.u, self.tolerance = problem.fields.u, NewtonOptions().tolerance * problem.force_scale  # of residuals [N]
        self.tangents = 0

    def J(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """See NonlinearProblem."""
        self.tangents += 1
        super().J(x, A)


CLOSE = 1e-9  # [m]: coordinates that differ by less are the same
Make = Callable[[Equations], Callable[[], None]]


def newton_solver(equations: Equations) -> Callable[[], None]:
    """DOLFINx's NewtonSolver: full steps, PETSc's own LU."""
    solver = dolfinx.nls.petsc.NewtonSolver(equations.u.function_space.mesh.comm, equations)
    solver.rtol, solver.atol = 0.0, equations.tolerance

    def solve() -> None:
        solver.solve(equations.u)

    return solve


def with_mumps(equations: Equations) -> Callable[[], None]:
    """The same with MUMPS, as DOLFINx's demos set it."""
    options, key = PETSc.Options(), "nls_solve_pc_factor_mat_solver_type"
    options[key] = "mumps"
    solve = newton_solver(equations)
    solve()  # takes the options, at equilibrium
    options.delValue(key)
    return solve


def snes(equations: Equations) -> Callable[[], None]:
    """PETSc's SNES with its default line search, `bt`; MUMPS in place of GMRES, which no soft finger suits."""
    found = PETSc.SNES().create(equations.u.function_space.mesh.comm)
    matrix = dolfinx.fem.petsc.create_matrix(equations.a)
    vector = dolfinx.fem.petsc.create_vector(equations.L)

    def function(_: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        _into(x, equations)
        equations.F(x, f)

    def tangent(_: PETSc.SNES, x: PETSc.Vec, A: PETSc.Mat, __: PETSc.Mat) -> None:
        _into(x, equations)
        equations.J(x, A)

    found.setFunction(function, vector)
    found.setJacobian(tangent, matrix)
    found.getKSP().setType("preonly")
    found.getKSP().getPC().setType("lu")
    found.getKSP().getPC().setFactorSolverType("mumps")
    # With its default, 1e-8, a step that no longer moves anything counts as converged, wherever it is.
    found.setTolerances(rtol=0.0, atol=equations.tolerance, stol=0.0)
    found.setFromOptions()
    x = equations.u.x.petsc_vec.duplicate()
    reasons = {value: name for name, value in vars(PETSc.SNES.ConvergedReason).items() if isinstance(value, int)}

    def solve() -> None:
        equations.u.x.petsc_vec.copy(x)
        found.solve(None, x)
        if found.getConvergedReason() <= 0:
            raise RuntimeError(f"SNES: {reasons[found.getConvergedReason()]}")
        _into(x, equations)

    return solve


def _into(x: PETSc.Vec, equations: Equations) -> None:
    equations.u.x.array[: x.local_size] = x.array_r


SOLVERS: dict[str, tuple[Make, str]] = {  # by name, with the settings of each
    "DOLFINx, NewtonSolver": (newton_solver, "defaults: full steps, PETSc's LU"),
    "DOLFINx, NewtonSolver, MUMPS": (with_mumps, "full steps, MUMPS' LU, as in DOLFINx's demos"),
    "DOLFINx, SNES": (snes, "defaults: line search `bt`; MUMPS' LU"),
}


def left_by_a_full_step(problem: Problem, tension: float) -> dict[str, float]:
    """What Newton's first step from rest makes of the residual, which a line search does not let grow.

    The step turns the steel plate by the tangent of its rotation. What that leaves grows with steel's modulus and the
    square of the turn; the next steps remove it.

    Returns:
        the tension of F1 [N]; the residual's 2-norm after the step over that before it; the plates' share of it [-].
    """
    problem.displacement[:] = 0.0
    problem.extrapolate_stress()
    problem.set_loads([tension, *[0.0] * (len(problem.tensions) - 1)], None)
    before = problem.residual()[0].array_r.copy()
    starts, columns, values = problem.tangent().getValuesCSR()
    problem.displacement[:] -= spsolve(csr_matrix((values, columns, starts)).tocsc(), before)
    after = problem.residual()[0].array_r.copy()
    outline, x = problem.scene.outline, np.repeat(problem.space.tabulate_dof_coordinates()[:, 0], 3)
    in_plates = np.any([(x > start - CLOSE) & (x < end + CLOSE) for start, end in outline.plates], axis=0)
    grown, share = norm(after) / norm(before), norm(after[in_plates]) / norm(after)
    return {"tension": tension, "residual_grows": float(grown), "share_of_plates": float(share)}

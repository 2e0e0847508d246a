"""Part `speed`: from rest to 100 N and along a contact line, by this project and by DOLFINx's NewtonSolver.

Both have one scene, one mesh, one accuracy and one core. The residual is that of the project's forms; FFCx compiles it
and its derivative, and DOLFINx assembles and solves with MUMPS, as in its demos. Compilation and symbolic factorisation
are not counted. DOLFINx gets, from one load to the next, the 1, 2, 4 ... equal steps with the fewest factorisations;
the search for them is not counted.
"""

from __future__ import annotations

import contextlib
import time
from typing import Any

import dolfinx.fem.petsc
import dolfinx.nls.petsc
import numpy as np
import ufl
from petsc4py import PETSc

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import regions
from fingerfem.discretisation.forms import contact_groups, quadrature_degree, surface_measure
from fingerfem.discretisation.problem import Problem
from fingerfem.discretisation.volume_energies import Term, constants, residual_of, rubber_terms, volume_measure
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.mechanics import contact, strain_energy, tendons
from fingerfem.scene.laws import plate_law
from studies.kinds import SCENES
from studies.parts import Run

PULL, LINE = "100 N", "contact line"
TASKS = {PULL: [100.0, 0.0], LINE: [50.0, 20.0]}  # tensions [N]
STATES, COUNTED = 9, 5  # of a contact line, and the first of them, which are solved
SMALL = 1e-2  # tension [N] of the first solve, which is not counted
MOST_STEPS = 64  # from one load to another
LEAST = 3  # factorisations of a step: one that approaches the solution, two that reach round-off
FAILURES = RuntimeError, PETSc.Error
OURS, THEIRS = "fingerfem", "DOLFINx, NewtonSolver, MUMPS"

Load = tuple[np.ndarray, float | None]  # tensions [N], distance [m]


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
    """DOLFINx's problem, which counts its tangents.

    Attributes:
        tangents: number of assembled tangents; each is factorised.
    """

    def __init__(self, problem: Problem):
        super().__init__(residual(problem), problem.fields.u, problem.supports)
        self.u, self.tolerance = problem.fields.u, NewtonOptions().tolerance * problem.force_scale  # of residuals [N]
        self.tangents = 0

    def J(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """See NonlinearProblem."""
        self.tangents += 1
        super().J(x, A)


class User:
    """A user of DOLFINx's NewtonSolver, who goes from load to load in equal steps.

    Attributes:
        cost: steps, factorisations and core-seconds since the last `rest`.
    """

    def __init__(self, problem: Problem):
        self.problem, self.equations = problem, Equations(problem)
        self.rest()

    def rest(self) -> None:
        """The finger is undeformed; the solver is new."""
        self.cost = np.zeros(3)
        self.problem.displacement[:] = 0.0
        self._renew()

    def _renew(self) -> None:
        """A new solver with its symbolic factorisation, at rest: a solver that has failed refuses later matrices."""
        before = self.problem.displacement.copy()
        self.problem.displacement[:] = 0.0
        self.problem.set_loads(SMALL * np.ones(len(self.problem.tensions)), None)
        mesh, options = self.equations.u.function_space.mesh, PETSc.Options()
        self._solver = dolfinx.nls.petsc.NewtonSolver(mesh.comm, self.equations)
        self._solver.rtol, self._solver.atol = 0.0, self.equations.tolerance
        options["nls_solve_pc_factor_mat_solver_type"] = "mumps"
        with contextlib.suppress(*FAILURES):
            self._solver.solve(self.equations.u)
        options.delValue("nls_solve_pc_factor_mat_solver_type")
        self.problem.displacement[:] = before

    def go(self, origin: Load, target: Load) -> None:
        """From load to load in 1, 2, 4 ... steps; the cheapest counts.

        Raises:
            RuntimeError: it does not converge in any.
        """
        start, best, end, reason, steps = self.problem.displacement.copy(), None, None, "", 1
        while steps <= MOST_STEPS and (best is None or LEAST * steps < best[1]):
            self.problem.displacement[:] = start
            before, begun = self.equations.tangents, time.process_time()
            try:
                self._ramp(origin, target, steps)
            except FAILURES as failure:
                reason = " ".join(str(failure).split())
                self._renew()
            else:
                cost = np.array([steps, self.equations.tangents - before, time.process_time() - begun])
                if best is not None and cost[1] >= best[1]:
                    break
                best, end = cost, self.problem.displacement.copy()
            steps *= 2
        if best is None:
            raise RuntimeError(f"not in {MOST_STEPS} steps: {reason}")
        self.problem.displacement[:] = end
        self.problem.set_loads(*target)
        self.cost += best

    def _ramp(self, origin: Load, target: Load, steps: int) -> None:
        for share in np.arange(1, steps + 1) / steps:
            distance = target[1]
            if distance is not None and origin[1] is not None:
                distance = origin[1] + share * (distance - origin[1])
            self.problem.set_loads(origin[0] + share * (target[0] - origin[0]), distance)
            self._solver.solve(self.equations.u)
        if self.problem.smallest_volume_ratio() <= 0:
            raise RuntimeError("a cell is inverted")


def distances_of(model: FingerModel) -> list[float]:
    """Distances of the contact line [m], dense where contact begins; the tensions are those of the line already."""
    reach, nearest = model.problem.reach(), model.scene.parameters[-1]["lower"]
    fractions = 1 - np.cos(np.pi / 2 * np.arange(1, STATES + 1) / STATES)
    return (reach - fractions[:COUNTED] * (reach - nearest)).tolist()


def contact_force(model: FingerModel) -> float:
    """Contact force [N] of the model's present state."""
    return model.problem.scalar(model.problem.forms.contact[0].force)


def ours(model: FingerModel, task: str) -> dict[str, Any]:
    """A task by this project."""
    continuation, forces = model.continuation, []
    before, begun = continuation.newton.factorisations, time.process_time()
    continuation.rest()
    continuation.advance(TASKS[task], None)
    for distance in distances_of(model) if task == LINE else []:
        continuation.advance(TASKS[task], distance)
        forces.append(contact_force(model))
    cost = continuation.steps, continuation.newton.factorisations - before, time.process_time() - begun
    return row(OURS, task, cost, model, forces)


def theirs(model: FingerModel, task: str) -> dict[str, Any]:
    """A task by DOLFINx; the plane comes from touch, as for ours."""
    user, tensions, forces = User(model.problem), np.array(TASKS[task]), []
    user.rest()
    user.go((0 * tensions, None), (tensions, None))
    last = model.problem.reach()
    for distance in distances_of(model) if task == LINE else []:
        user.go((tensions, last), (tensions, distance))
        forces.append(contact_force(model))
        last = distance
    return row(THEIRS, task, (user.cost[0], user.cost[1], user.cost[2]), model, forces)


def row(solver: str, task: str, cost: tuple[float, float, float], model: FingerModel, forces: list[float]) -> dict:
    """Of the table; `end` is the tip [m], or the contact forces [N]."""
    words = {"solver": solver, "task": task, "steps": int(cost[0]), "factorisations": int(cost[1]), "seconds": cost[2]}
    return words | {"end": forces or model.problem.tip().tolist()}


def side_by_side(name: str, task: str) -> list[dict[str, Any]]:
    """A scene's task by both: time over ours, and the largest relative difference of `end` [-]."""
    model = FingerModel(load_scene(SCENES / f"{name}.toml"))
    model.continuation.rest()
    model.continuation.advance([1.0, 0.0], None)  # compiles
    rows = [ours(model, task), theirs(model, task)]
    for one in rows:
        one["unknowns"], one["times"] = model.problem.unknowns, one["seconds"] / rows[0]["seconds"]
        difference = np.abs(np.subtract(one["end"], rows[0]["end"])).max()
        one["differs"] = float(difference / np.abs(rows[0]["end"]).max())
    return rows


def measure(run: Run) -> list[dict[str, Any]]:
    """Both tasks on the coarse mesh and on the paper's."""
    pairs = [(name, task) for name in ("draft", "one_segment") for task in TASKS]
    return [row for name, task in pairs for row in run.once(f"{name}, {task}", side_by_side, name, task)]

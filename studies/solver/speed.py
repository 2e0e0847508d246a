"""The full-order solver, measured: factorisations, wall time against plain Newton's, growth with the unknowns.

One core; the paper's mesh, or the draft mesh in the short form.
"""

from __future__ import annotations

import time

import numpy as np
from petsc4py import PETSc

from fingerfem import FingerModel, load_scene
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.scene.scene import Scene
from studies.kinds import SCENES
from studies.runner import Run

LINES = [[50.0, 20.0], [100.0, 60.0]]  # tensions of contact lines [N]
STATES = 9  # of a line
PLAIN = (2, 8)  # of them are also solved by plain Newton
SIZES = [[12, 5], [25, 6], [50, 8], [100, 10]]  # cells, 1,400 to 37,000 unknowns


def line_distances(reach: float, nearest: float) -> np.ndarray:
    """Distances of a training line's contact states [m]: dense where contact begins."""
    fractions = 1 - np.cos(np.pi / 2 * np.arange(1, STATES + 1) / STATES)
    return reach - fractions * (reach - nearest)


def from_rest(model: FingerModel) -> dict:
    """From rest to 100 N on one tendon."""
    newton = model.continuation.newton
    before, begun = newton.factorisations, time.perf_counter()
    model.continuation.rest()
    model.continuation.advance([100.0] + [0.0] * (len(model.scene.tendons) - 1), None)
    return {
        "unknowns": model.problem.unknowns,
        "factorisations": newton.factorisations - before,
        "steps": model.continuation.steps,
        "seconds": time.perf_counter() - begun,
    }


def contact_force(model: FingerModel) -> float:
    """Of the state that the model is in [N]."""
    return model.problem.scalar(model.problem.forms.contact[0].force)


def contact_line(model: FingerModel, tensions: list[float]) -> dict:
    """A training line: the plane comes nearer, state by state, each starting from the last."""
    continuation, newton = model.continuation, model.continuation.newton
    begun = time.perf_counter()
    continuation.rest()
    continuation.advance(tensions, None)
    before = newton.factorisations
    distances = line_distances(model.problem.reach(), model.scene.parameters[-1]["lower"])
    forces = []
    for distance in distances:
        continuation.advance(tensions, float(distance))
        forces.append(contact_force(model))
    return {
        "tensions": tensions,
        "distances": distances.tolist(),
        "contact_forces": forces,
        "factorisations": newton.factorisations - before,
        "seconds": time.perf_counter() - begun,
    }


class PlainNewton:
    """The usual set-up: SNES with full Newton steps and MUMPS LU, the plane in place, increments of 25 N."""

    def __init__(self, model: FingerModel):
        self.model, self.factorisations = model, 0
        snes = PETSc.SNES().create(model.problem.comm)
        snes.setType("newtonls")
        prefix = "plain_newton_"
        snes.setOptionsPrefix(prefix)
        settings = PETSc.Options()
        chosen = {"snes_linesearch_type": "basic", "snes_divergence_tolerance": 1e50}  # never gives up for growth
        for name, value in chosen.items():
            settings[prefix + name] = value
        snes.setFromOptions()
        for name in chosen:
            settings.delValue(prefix + name)
        snes.getKSP().setType("preonly")
        snes.getKSP().getPC().setType("lu")
        snes.getKSP().getPC().setFactorSolverType("mumps")
        # The same accuracy as the project's own solver asks for.
        snes.setTolerances(rtol=0, atol=1e-10 * model.problem.force_scale, stol=0, max_it=50)
        self._residual = model.problem.matrix.createVecRight()
        snes.setFunction(self._function, self._residual)
        snes.setJacobian(self._jacobian, model.problem.matrix)
        self._snes, self._x = snes, model.problem.matrix.createVecRight()

    def _set(self, x: PETSc.Vec) -> None:
        self.model.problem.displacement[: x.local_size] = x.array_r
        self.model.problem.extrapolate_stress()

    def _function(self, _, x: PETSc.Vec, f: PETSc.Vec) -> None:
        self._set(x)
        b, _ = self.model.problem.residual()
        b.copy(f)
        b.destroy()

    def _jacobian(self, _, x: PETSc.Vec, matrix: PETSc.Mat, __) -> None:
        self._set(x)
        self.model.problem.tangent()
        self.factorisations += 1

    def solve(self, tensions: list[float], distance: float) -> float | None:
        """Contact force [N] of a state solved from rest, None where it does not converge."""
        self._x.set(0.0)
        for fraction in np.arange(1, int(np.ceil(max(tensions) / 25)) + 1) * 25 / max(tensions):
            self.model.problem.set_loads(min(fraction, 1.0) * np.array(tensions), distance)
            try:
                self._snes.solve(None, self._x)
            except PETSc.Error:  # a NaN in the tangent
                return None
            if self._snes.getConvergedReason() <= 0:
                return None
        self._set(self._x)
        return contact_force(self.model)


def against_plain_newton(model: FingerModel, line: dict) -> dict:
    """States of a contact line, each solved from rest by plain Newton, in the same run."""
    plain, forces, seconds = PlainNewton(model), [], []
    for state in PLAIN:
        begun = time.perf_counter()
        forces.append(plain.solve(line["tensions"], line["distances"][state]))
        seconds.append(time.perf_counter() - begun)
    ours = line["seconds"] / STATES  # the path from rest is counted
    both = [(line["contact_forces"][k], force) for k, force in zip(PLAIN, forces, strict=True) if force is not None]
    converged = [each for each, force in zip(seconds, forces, strict=True) if force is not None]
    return {
        "tensions": line["tensions"],
        "states": len(PLAIN),
        "plain_factorisations": plain.factorisations,
        "plain_not_converged": forces.count(None),
        "times_faster": float(np.mean(seconds)) / ours,
        "times_faster_where_plain_converged": float(np.mean(converged)) / ours if converged else None,
        "largest_difference": max((abs(a - b) / a for a, b in both), default=None),
    }


def on_mesh(scene: Scene, cells: list[int]) -> dict:
    """From rest to 100 N on one tendon, without a plane."""
    table = scene.model_dump()
    table["mesh"]["cells"] = cells
    del table["obstacle"]
    model = FingerModel(Scene.model_validate(table))
    try:
        return {"cells": cells, **from_rest(model)}
    except LoadNotReached as failure:
        return {"cells": cells, "unknowns": model.problem.unknowns, "failed": str(failure)}


def measure(run: Run) -> dict:
    """All of it."""
    scene = load_scene(SCENES / ("draft.toml" if run.quick else "one_segment.toml"))
    model = FingerModel(scene)
    model.continuation.rest()
    model.continuation.advance([1.0, 0.0], None)  # what is done once: compiled forms, symbolic factorisation
    found: dict = {"scene": scene.name, "from_rest": run.once("from rest to 100 N", from_rest, model)}
    found["lines"] = [run.once(f"contact line at {line} N", contact_line, model, line) for line in LINES]
    total = sum(line["factorisations"] for line in found["lines"])
    found["factorisations_per_contact_state"] = total / (STATES * len(LINES))
    line = found["lines"][0]
    found["against_plain_newton"] = run.once("plain Newton", against_plain_newton, model, line)
    sizes = SIZES[: 3 if run.quick else None]
    found["sizes"] = [run.once(f"cells {cells}", on_mesh, scene, cells) for cells in sizes]
    return found

"""The tangent by one matrix product for all cells, beside the same form assembled by FFCx's own kernel; one core."""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import regions
from fingerfem.discretisation.forms import quadrature_degree
from fingerfem.discretisation.volume_energies import constants, residual_of, volume_measure
from fingerfem.mechanics import strain_energy
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene
from studies.kinds import SCENES
from studies.measures import shortest
from studies.runner import Run, say

MESHES = [([20, 5], 1), ([100, 10], 1), ([10, 5], 2), ([32, 7], 2)]


def row(cells: list[int], order: int) -> dict:
    """Seconds of both on a mesh, and how far apart they are."""
    table = load_scene(SCENES / "draft.toml").model_dump()
    table["mesh"] |= {"cells": cells, "order": order}
    model = FingerModel(Scene.model_validate(table))
    problem, scene = model.problem, model.scene
    x = problem.space.tabulate_dof_coordinates() / scene.geometry.side
    problem.displacement[:] = (2e-4 * np.sin(x[:, [1, 2, 0]])).ravel()
    problem.extrapolate_stress()
    number, degree = constants(problem.mesh.mesh), quadrature_degree(order)
    residual = residual_of(
        [
            (strain_energy.energy(law, number), volume_measure(problem.mesh, degree)(where))
            for law, where in ((scene.law, regions.RUBBERS), (plate_law(scene.law), regions.PLATES))
        ],
        problem.fields.u,
    )
    form = fem.form(ufl.derivative(residual, problem.fields.u, ufl.TrialFunction(problem.space)))
    matrix = create_matrix(form)

    def cell_by_cell() -> None:
        matrix.zeroEntries()
        assemble_matrix(matrix, form, bcs=problem.supports)
        matrix.assemble()

    tangent = problem.tangent_with(problem.supports, volume_alone=True)
    found = {
        "cells": cells,
        "order": order,
        "unknowns": problem.unknowns,
        "product_seconds": shortest(tangent.assemble),
        "ffcx_seconds": shortest(cell_by_cell),
    }
    difference = tangent.matrix.copy()
    difference.axpy(-1.0, matrix)
    found["differs"] = difference.norm() / matrix.norm()
    say(found)
    return found


def measure(run: Run) -> dict:
    """Both, mesh by mesh."""
    meshes = MESHES[::2] if run.quick else MESHES
    return {"rows": [run.once(f"{cells} order {order}", row, cells, order) for cells, order in meshes]}

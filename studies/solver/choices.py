"""The choices of the solver, measured: factorisation, quadrature, element order.

One core; the paper's mesh, or the draft mesh in the short form.
"""

from __future__ import annotations

import time
from functools import partial

import numpy as np
from petsc4py import PETSc

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import forms
from fingerfem.equilibrium.continuation import StepOptions
from fingerfem.scene.scene import Scene
from studies.kinds import SCENES
from studies.measures import shortest
from studies.parts import Run, say

FACTORISATIONS = {  # the first is the chosen one
    "Cholesky, CHOLMOD": ("cholesky", "cholmod"),
    "LDL^T, MUMPS": ("cholesky", "mumps"),
    "LU, MUMPS": ("lu", "mumps"),
}
LOADS = [60.0, 0.0], 0.005  # of the states compared: tensions [N], d [m]
MESHES = {1: [[20, 5], [50, 8], [100, 10]], 2: [[10, 5], [20, 5], [25, 8]]}
REFERENCE = [50, 8], 2  # cells and order that errors are counted from


def factorisations(scene: Scene) -> list[dict]:
    """The tangent of a bent finger, factorised by CHOLMOD and by MUMPS."""
    model = FingerModel(scene)
    model.solve(*LOADS, sensitivities=False)
    matrix = model.problem.tangent()
    right, update, found = model.problem.residual()[0], matrix.createVecRight(), []
    for name, (kind, package) in FACTORISATIONS.items():
        ksp = PETSc.KSP().create(matrix.comm)
        ksp.setType("preonly")
        ksp.getPC().setType(kind)
        ksp.getPC().setFactorSolverType(package)
        ksp.setOperators(matrix)
        begun = time.perf_counter()
        ksp.setUp()
        first = time.perf_counter() - begun

        def again(ksp=ksp) -> None:
            matrix.stateIncrease()
            ksp.setOperators(matrix)
            ksp.setUp()

        row = {"factorisation": name, "first_seconds": first, "seconds": shortest(again)}
        found.append(row | {"solve_seconds": shortest(partial(ksp.solve, right, update))})
        say(found[-1])
        ksp.destroy()
    return found


def variant(scene: Scene, cells: list[int], order: int) -> Scene:
    """The scene on another mesh, with the one tendon that bends it towards the plane: half the finger is enough."""
    table = scene.model_dump()
    table["mesh"] |= {"cells": cells, "order": order}
    table["tendons"] = table["tendons"][:1]
    return Scene.model_validate(table)


def state(model: FingerModel) -> dict:
    """Tip [m] and contact force [N] of the state compared, and what they cost."""
    tensions, distance = LOADS[0][: len(model.problem.tensions)], LOADS[1]
    newton = model.continuation.newton
    before, begun = newton.factorisations, time.perf_counter()
    solved = model.solve(tensions, distance, sensitivities=False)
    return {
        "unknowns": model.problem.unknowns,
        "factorisations": newton.factorisations - before,
        "seconds": time.perf_counter() - begun,
        "tip": solved.tip.tolist(),
        "contact_force": solved.contact_force,
    }


def fixed(degree: int, order: int) -> int:
    """One quadrature degree, whatever the element's order."""
    return degree


def quadrature(scene: Scene, cells: dict[int, list[int]]) -> list[dict]:
    """Degrees of the volume's quadrature, order 1 and 2; differences from the highest."""
    found = []
    chosen = forms.quadrature_degree
    for order, degrees in ((1, (1, 2, 4)), (2, (2, 4, 6))):  # 1 to 3 points a direction, 2 to 4
        rows = []
        for degree in degrees:
            forms.quadrature_degree = partial(fixed, degree)
            try:
                model = FingerModel(variant(scene, cells[order], order))
                model.continuation.options = StepOptions(halvings=1)  # what does not converge shall say so soon
                row = {"order": order, "degree": degree, "chosen": degree == chosen(order), **state(model)}
                row["tangent_seconds"] = shortest(model.problem.tangent)
            except Exception as failure:  # under-integrated elements have modes without energy
                row = {"order": order, "degree": degree, "failed": f"{type(failure).__name__}: {failure}"}
            finally:
                forms.quadrature_degree = chosen
            rows.append(row)
        compare(rows, rows[-1])
        found += rows
    return found


def compare(rows: list[dict], reference: dict) -> None:
    """Add errors of tip [m] and of contact force [-] against the reference, and print."""
    for row in rows:
        if "failed" not in row:
            row["tip_error"] = float(np.linalg.norm(np.subtract(row["tip"], reference["tip"])))
            row["contact_force_error"] = abs(row["contact_force"] / reference["contact_force"] - 1)
        say({name: value for name, value in row.items() if name != "tip"})


def orders(scene: Scene) -> list[dict]:
    """Order 1 and order 2 on finer and finer meshes."""
    reference = state(FingerModel(variant(scene, *REFERENCE)))
    rows = [
        {"order": order, "cells": cells, **state(FingerModel(variant(scene, cells, order)))}
        for order, meshes in MESHES.items()
        for cells in meshes
    ]
    compare(rows, reference)
    return rows


def measure(run: Run) -> dict:
    """All of it."""
    scene = load_scene(SCENES / ("one_segment.toml"))
    cells = {1: [20, 5], 2: [10, 5]}
    return {
        "scene": scene.name,
        "factorisations": run.once("factorisation of the tangent", factorisations, scene),
        "quadrature": run.once("quadrature degree", quadrature, scene, cells),
        "orders": run.once("element order", orders, scene),
    }

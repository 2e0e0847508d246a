"""What the solver was chosen from, measured: orderings, factorisations, compiler flags, quadrature, element order.

One core; the paper's mesh, or the draft mesh in the short form.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np
from petsc4py import PETSc

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import forms
from fingerfem.equilibrium.continuation import StepOptions
from fingerfem.scene.scene import Scene
from studies.kinds import SCENES
from studies.measures import shortest
from studies.runner import ROOT, Run, say

ORDERINGS = {"AMD": 0, "AMF": 2, "Scotch": 3, "PORD": 4, "METIS": 5, "QAMD": 6, "automatic": 7}  # MUMPS' ICNTL(7)
FLAGS = ["-O2 -g0", "-O3 -march=native -g0", "-Ofast -march=native -g0"]
LOADS = [60.0, 0.0], 0.005  # of the states compared: tensions [N], d [m]
MESHES = {1: [[20, 5], [50, 8], [100, 10]], 2: [[10, 5], [20, 5], [25, 8]]}
REFERENCE = [50, 8], 2  # cells and order that errors are counted from


def factorisations(scene: Scene) -> list[dict]:
    """The tangent of a bent finger, factorised by MUMPS in every way."""
    model = FingerModel(scene)
    model.solve(*LOADS, sensitivities=False)
    matrix = model.problem.tangent()
    right, update, found = model.problem.residual()[0], matrix.createVecRight(), []
    factorised(matrix, "cholesky", "automatic").destroy()  # the first of all also wakes MUMPS
    kinds = [("cholmod", "automatic"), *(("cholesky", name) for name in ORDERINGS), ("lu", "automatic")]
    for kind, ordering in kinds:
        begun = time.perf_counter()
        ksp = factorised(matrix, kind, ordering)
        first = time.perf_counter() - begun

        def again(ksp=ksp) -> None:
            matrix.stateIncrease()
            ksp.setOperators(matrix)
            ksp.setUp()

        factor = ksp.getPC().getFactorMatrix()
        if kind != "cholmod" and ordering != "automatic" and factor.getMumpsInfog(7) != ORDERINGS[ordering]:
            say({"ordering": ordering, "not": "in this MUMPS, which took another"})
        else:
            row = {
                "factorisation": {"cholmod": "Cholesky", "cholesky": "LDL^T", "lu": "LU"}[kind],
                "ordering": ordering,
                "first_seconds": first,  # the analysis included, once a model
                "seconds": shortest(again),
                "solve_seconds": shortest(partial(ksp.solve, right, update)),
                "entries": None if kind == "cholmod" else _entries(factor.getMumpsInfog(9)),
            }
            found.append(row)
            say(row)
        ksp.destroy()
    return found


def factorised(matrix: PETSc.Mat, kind: str, ordering: str) -> PETSc.KSP:
    """A solver by MUMPS' factors of a matrix, or CHOLMOD's."""
    ksp = PETSc.KSP().create(matrix.comm)
    ksp.setType("preonly")
    ksp.getPC().setType("lu" if kind == "lu" else "cholesky")
    ksp.getPC().setFactorSolverType("cholmod" if kind == "cholmod" else "mumps")
    ksp.setOperators(matrix)
    if kind == "cholmod":
        ksp.setUp()
        return ksp
    ksp.getPC().setFactorSetUpSolverType()
    factor = ksp.getPC().getFactorMatrix()
    factor.setMumpsIcntl(7, ORDERINGS[ordering])
    factor.setMumpsIcntl(14, 80)
    ksp.setUp()
    return ksp


def _entries(value: int) -> int:
    """MUMPS counts in millions, negatively, where the number is large."""
    return value if value >= 0 else -value * 1_000_000


def assembly(scene_file: Path) -> dict:
    """Seconds of one tangent and one residual, with whatever flags this process compiles with; some of its numbers."""
    begun = time.perf_counter()
    model = FingerModel(load_scene(scene_file))
    built = time.perf_counter() - begun
    generator = np.random.default_rng(0)
    model.problem.displacement[:] = 1e-6 * generator.standard_normal(len(model.problem.displacement))
    model.problem.set_loads(*LOADS)
    residual = model.problem.residual()[0].norm()
    return {
        "build_seconds": built,
        "tangent_seconds": shortest(model.problem.tangent),
        "residual_seconds": shortest(lambda: model.problem.residual()[0].destroy()),
        "residual": residual,
        "tangent": model.problem.matrix.norm(),
    }


def compiler_flags(scene_file: Path) -> list[dict]:
    """Every set of flags in a process and a cache of its own."""
    found = []
    for flags in FLAGS:
        with tempfile.TemporaryDirectory(dir=ROOT / "out") as folder:
            settings = Path(folder) / "dolfinx" / "dolfinx_jit_options.json"
            settings.parent.mkdir()
            settings.write_text(json.dumps({"cffi_extra_compile_args": flags.split()}))
            done = subprocess.run(
                [sys.executable, "-m", "studies.solver.choices", str(scene_file)],
                cwd=ROOT,
                env=os.environ | {"XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder},
                stdout=subprocess.PIPE,
                check=True,
            )
        found.append({"flags": flags, **json.loads(done.stdout)})
        reference = found[0]
        for name in ("residual", "tangent"):
            found[-1][f"{name}_differs"] = abs(found[-1][name] / reference[name] - 1)
        say(found[-1])
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


def orders(scene: Scene, quick: bool) -> list[dict]:
    """Order 1 and order 2 on finer and finer meshes."""
    reference = state(FingerModel(variant(scene, *REFERENCE)))
    rows = [
        {"order": order, "cells": cells, **state(FingerModel(variant(scene, cells, order)))}
        for order, meshes in MESHES.items()
        for cells in meshes[: 2 if quick else None]
    ]
    compare(rows, reference)
    return rows


def measure(run: Run) -> dict:
    """All of it."""
    file = SCENES / ("draft.toml" if run.quick else "one_segment.toml")
    scene = load_scene(file)
    cells = {1: [20, 5], 2: [10, 5]}
    return {
        "scene": scene.name,
        "factorisations": run.once("factorisation of the tangent", factorisations, scene),
        "flags": run.once("compiler flags", compiler_flags, file),
        "quadrature": run.once("quadrature degree", quadrature, scene, cells),
        "orders": run.once("element order", orders, scene, run.quick),
    }


if __name__ == "__main__":
    print(json.dumps(assembly(Path(sys.argv[1]))))  # with the compiler flags of this process's settings

"""What the solver was chosen from, measured: orderings, factorisations, compiler flags, quadrature, element order.

python3 studies/solver/choices.py [OUT] [--quick]
    prints tables, writes OUT/choices.json (out/solver by default); one core
"""

from __future__ import annotations

import argparse
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

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from fingerfem import FingerModel, load_scene
from fingerfem.discretisation import forms
from fingerfem.equilibrium.continuation import StepOptions
from fingerfem.scene.scene import Scene
from studies.solver.solver import SCENES, say

ORDERINGS = {"AMD": 0, "AMF": 2, "Scotch": 3, "PORD": 4, "METIS": 5, "QAMD": 6, "automatic": 7}  # MUMPS' ICNTL(7)
FLAGS = ["-O1 -g0", "-O2 -g0", "-O3 -g0", "-O3 -march=native -g0", "-Ofast -march=native -g0"]
LOADS = [60.0, 0.0], 0.005  # of the states compared: tensions [N], d [m]
MESHES = {1: [[20, 5], [50, 5], [50, 8], [100, 10], [150, 15]], 2: [[10, 5], [20, 5], [25, 8], [50, 8]]}
REFERENCE = [80, 10], 2  # cells and order that errors are counted from


def timed(call, repeats: int = 3) -> float:
    """Shortest of some calls [s]."""
    seconds = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - begun)
    return min(seconds)


def factorisations(model: FingerModel) -> list[dict]:
    """The tangent of a bent finger, factorised by MUMPS in every way."""
    model.solve(*LOADS, sensitivities=False)
    matrix = model.problem.tangent()
    right, update, found = model.problem.residual()[0], matrix.createVecRight(), []
    factorised(matrix, "cholesky", "automatic").destroy()  # the first of all also wakes MUMPS
    for kind, ordering in [("cholesky", name) for name in ORDERINGS] + [("lu", "automatic")]:
        begun = time.perf_counter()
        ksp = factorised(matrix, kind, ordering)
        first = time.perf_counter() - begun

        def again(ksp=ksp) -> None:
            matrix.stateIncrease()
            ksp.setOperators(matrix)
            ksp.setUp()

        factor = ksp.getPC().getFactorMatrix()
        if ordering != "automatic" and factor.getMumpsInfog(7) != ORDERINGS[ordering]:
            say({"ordering": ordering, "not": "in this MUMPS, which took another"})
        else:
            row = {
                "factorisation": "LDL^T" if kind == "cholesky" else "LU",
                "ordering": ordering,
                "first_seconds": first,  # the analysis included, once a model
                "seconds": timed(again),
                "solve_seconds": timed(lambda ksp=ksp: ksp.solve(right, update)),
                "entries": _entries(factor.getMumpsInfog(9)),
            }
            found.append(row)
            say(row)
        ksp.destroy()
    return found


def factorised(matrix: PETSc.Mat, kind: str, ordering: str) -> PETSc.KSP:
    """A solver by MUMPS' factors of a matrix."""
    ksp = PETSc.KSP().create(matrix.comm)
    ksp.setType("preonly")
    ksp.getPC().setType(kind)
    ksp.getPC().setFactorSolverType("mumps")
    ksp.setOperators(matrix)
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
        "tangent_seconds": timed(model.problem.tangent),
        "residual_seconds": timed(lambda: model.problem.residual()[0].destroy()),
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
                [sys.executable, __file__, "--assembly", str(scene_file)],
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
    for order, degrees in ((1, (1, 2, 4, 6)), (2, (2, 4, 6, 8))):  # 1 to 4 points a direction, 2 to 5
        rows = []
        for degree in degrees:
            forms.quadrature_degree = partial(fixed, degree)
            try:
                model = FingerModel(variant(scene, cells[order], order))
                model.continuation.options = StepOptions(halvings=1)  # what does not converge shall say so soon
                row = {"order": order, "degree": degree, "chosen": degree == chosen(order), **state(model)}
                row["tangent_seconds"] = timed(model.problem.tangent)
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
    reference = state(FingerModel(variant(scene, *(([50, 8], 2) if quick else REFERENCE))))
    rows = [
        {"order": order, "cells": cells, **state(FingerModel(variant(scene, cells, order)))}
        for order, meshes in MESHES.items()
        for cells in meshes[: 2 if quick else None]
    ]
    compare(rows, reference)
    return rows


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", nargs="?", default="out/solver")
    parser.add_argument("--quick", action="store_true", help="the draft mesh instead of the paper's")
    parser.add_argument("--assembly", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.assembly:
        print(json.dumps(assembly(options.assembly)))
        return
    folder = Path(options.out)
    folder.mkdir(parents=True, exist_ok=True)
    file = SCENES / ("draft.toml" if options.quick else "one_segment.toml")
    scene = load_scene(file)
    print("factorisation of the tangent", flush=True)
    result: dict = {"scene": scene.name, "factorisations": factorisations(FingerModel(scene))}
    print("compiler flags", flush=True)
    result["flags"] = compiler_flags(file)
    print("quadrature degree", flush=True)
    result["quadrature"] = quadrature(
        scene, {1: [20, 5] if options.quick else [50, 8], 2: [10, 5] if options.quick else [25, 6]}
    )
    print("element order", flush=True)
    result["orders"] = orders(scene, options.quick)
    (folder / "choices.json").write_text(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()

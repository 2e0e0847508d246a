"""Part `speed`: from rest to 100 N and along a contact line, by this project, by DOLFINx's own solvers, by FElupe.

One scene, one mesh, one accuracy, one core. What is done once (compilation, symbolic factorisation, patterns) does not
count. The others get, from one load to the next, those of 1, 2, 4 ... equal steps that take least, and only these
count: nobody knows them before, it is the best that a user may hope for.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from fingerfem import FingerModel, load_scene
from studies.kinds import SCENES
from studies.peers.felupe.comparison import ask_felupe, described
from studies.peers.speed.dolfinx_defaults import SOLVERS, Equations, left_by_a_full_step
from studies.peers.speed.dolfinx_user import NotReached, User
from studies.runner import ROOT, Run, say
from studies.solver.speed import contact_force, line_distances

FEW, PULL, LINE = "1 N", "100 N", "contact line"
# Tensions [N] from rest; those of the contact line stay while the plane comes nearer.
TASKS = {FEW: [1.0, 0.0], PULL: [100.0, 0.0], LINE: [50.0, 20.0]}
STATES = 5  # of a training line, the first: those near the plane take plain Newton's method very many steps
SMALL = 10.0, 1.0, 1e-2, 1e-4  # tensions [N] from rest of which the first full step is looked at
OURS = "fingerfem"
OUR_SETTINGS = "predictor, step control, mixed-integration-point Newton, CHOLMOD, factors reused"
FELUPE = {"scipy": "full steps, SciPy's spsolve (default)", "pypardiso": "full steps, PyPardiso"}
# What others are asked; SNES with its line search does not leave rest, see `left_by_a_full_step`.
ON_DRAFT = {one: list(TASKS) for one in [*SOLVERS, *FELUPE]} | {"DOLFINx, SNES": [FEW, PULL]}
# On the paper's mesh, PETSc's LU goes to 1 N only, which tells what an iteration takes.
ON_PAPER_MESH = {
    "DOLFINx, NewtonSolver": [FEW],
    "DOLFINx, NewtonSolver, MUMPS": list(TASKS),
    "pypardiso": list(TASKS),
}
COSTS = "steps", "factorisations", "seconds"  # core-seconds
PARDISO = ROOT / "out" / "peers" / "pypardiso"


def row(solver: str, settings: str, task: str, **found: Any) -> dict[str, Any]:
    """One solver and one task.

    Args:
        solver: its name.
        settings: that it ran with.
        task: one of TASKS.
        found: of the keys below, all of which are None where it does not converge, but `failed`, which says why.
    """
    keys = (*COSTS, "tip", "contact_forces", "failed")
    assert set(found) <= set(keys), f"keys must be of {keys}, got {list(found)}"
    told = dict.fromkeys(keys) | found
    return {"solver": solver, "settings": settings, "task": task, "converged": told["failed"] is None} | told


def ours(model: FingerModel) -> dict[str, Any]:
    """All tasks by this project; the distances of the contact line [m]."""
    continuation, rows, distances = model.continuation, [], []
    for task, tensions in TASKS.items():
        before, begun = continuation.newton.factorisations, time.process_time()
        continuation.rest()
        continuation.advance(tensions, None)
        forces = None
        if task == LINE:
            nearest = model.scene.parameters[-1]["lower"]
            distances = line_distances(model.problem.reach(), nearest)[:STATES].tolist()
            forces = []
            for distance in distances:
                continuation.advance(tensions, distance)
                forces.append(contact_force(model))
        seconds, made = time.process_time() - begun, continuation.newton.factorisations - before
        tip = model.problem.tip().tolist()
        cost = {"factorisations": made, "seconds": seconds, "steps": continuation.steps}
        rows.append(row(OURS, OUR_SETTINGS, task, **cost, tip=tip, contact_forces=forces))
    return {"rows": rows, "distances": distances, "unknowns": model.problem.unknowns}


def by_user(model: FingerModel, user: User, task: str, distances: list[float]) -> list[float] | None:
    """A task by DOLFINx; the plane comes from where it touches, as it does for ours. Returns the contact forces [N].

    Raises:
        NotReached: it does not converge.
    """
    user.rest()
    tensions = np.array(TASKS[task])
    user.go((0 * tensions, None), (tensions, None))
    if task != LINE:
        return None
    last, forces = model.problem.reach(), []
    for distance in distances:
        user.go((tensions, last), (tensions, distance))
        forces.append(contact_force(model))
        last = distance
    return forces


def dolfinx(model: FingerModel, name: str, tasks: list[str], distances: list[float]) -> list[dict[str, Any]]:
    """Tasks by one of SOLVERS."""
    make, settings = SOLVERS[name]
    user, rows = User(model.problem, Equations(model.problem), make), []
    for task in tasks:
        try:
            forces = by_user(model, user, task, distances)
        except NotReached as failure:
            rows.append(row(name, settings, task, failed=str(failure)))
            continue
        cost = {key: sum(getattr(way, key) for way in user.ways) for key in COSTS}
        rows.append(row(name, settings, task, **cost, tip=model.problem.tip().tolist(), contact_forces=forces))
    return rows


def felupe(model: FingerModel, solver: str, tasks: list[str], distances: list[float], folder: Path) -> list[dict]:
    """Tasks by FElupe with one of FELUPE, each in a process of its own."""
    (arrays, numbers), rows = described(model), []
    for task in tasks:
        asked = {"task": "speed", "scene": numbers, "solver": solver, "pull": TASKS[task], "line": None}
        if task == LINE:
            asked |= {"pull": TASKS[FEW], "line": {"tensions": TASKS[LINE], "distances": distances}}
        displacements, told = ask_felupe(arrays, asked, folder, with_pardiso() if solver == "pypardiso" else None)
        paths, forces, tip = [told["from_rest"]], None, None
        if task == LINE:
            paths, forces = [told["line"]["pulled"], *told["line"]["states"]], told["line"]["contact_forces"]
        else:
            model.problem.displacement[:] = displacements[0].ravel()
            tip = model.problem.tip().tolist()
        failed = [path["failed"] for path in paths if not path["converged"]]
        if failed:
            rows.append(row("FElupe", FELUPE[solver], task, failed=failed[0]))
            continue
        cost = {key: sum(path[key] for path in paths) for key in COSTS}
        rows.append(row("FElupe", FELUPE[solver], task, **cost, tip=tip, contact_forces=forces))
    return rows


def with_pardiso() -> dict[str, str]:
    """Variables with which a process finds PyPardiso and its library, on one core.

    Raises:
        FileNotFoundError: it is not there.
    """
    modules, libraries = (sorted(PARDISO.rglob(name)) for name in ("pypardiso/__init__.py", "libmkl_rt.so*"))
    if not modules or not libraries:
        raise FileNotFoundError(f"{PARDISO} must hold pypardiso and mkl, got {len(modules)} and {len(libraries)} files")
    found = {"PYTHONPATH": str(modules[0].parents[1]), "PYPARDISO_MKL_RT": str(libraries[0])}
    return found | {"MKL_THREADING_LAYER": "SEQUENTIAL"}


def against(one: dict[str, Any], ours: dict[str, Any]) -> dict[str, Any]:
    """A row with its time as a multiple of ours, and how far it ends from ours [-], None where it does not say."""
    times = one["seconds"] / ours["seconds"] if one["converged"] else None
    tip = _apart([one["tip"]], [ours["tip"]]) if one["tip"] else None
    force = _apart(one["contact_forces"], ours["contact_forces"]) if one["contact_forces"] else None
    return one | {"times": times, "tip_differs": tip, "contact_force_differs": force}


def _apart(told: list, truth: list) -> float:
    """Largest relative difference [-]."""
    return max(float(np.linalg.norm(np.subtract(a, b)) / np.linalg.norm(b)) for a, b in zip(told, truth, strict=True))


def prepared(name: str) -> FingerModel:
    """A scene's model in which is done what is done once."""
    model = FingerModel(load_scene(SCENES / f"{name}.toml"))
    model.continuation.rest()
    model.continuation.advance([1.0, 0.0], None)
    return model


def on(run: Run, name: str, tasks: dict[str, list[str]]) -> dict[str, Any]:
    """A scene by ours, and by keys of SOLVERS and FELUPE the tasks that each is given."""
    model = prepared(name)
    told = run.once(f"{name}, fingerfem", ours, model)
    rows, distances = list(told["rows"]), told["distances"]
    for one, given in tasks.items():
        if one in SOLVERS:
            rows += run.once(f"{name}, {one}", dolfinx, model, one, given, distances)
        else:
            rows += run.once(f"{name}, FElupe, {one}", felupe, model, one, given, distances, run.folder / "speed")
    first = {one["task"]: one for one in told["rows"]}
    rows = [against(one, first[one["task"]]) for one in rows]
    for one in rows:
        say(one)
    return {"scene": name, "unknowns": told["unknowns"], "states": len(distances), "rows": rows}


def measure(run: Run) -> list[dict[str, Any]]:
    """The coarse mesh, with what stops a line search there; the paper's mesh."""
    stops = [left_by_a_full_step(prepared("draft").problem, tension) for tension in SMALL]
    found = [on(run, "draft", ON_DRAFT) | {"left_by_a_full_step": stops}]
    if not run.quick:
        found.append(on(run, "one_segment", ON_PAPER_MESH))
    return found

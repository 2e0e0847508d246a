"""Part `finite_elements`: the same states of the same meshes by another finite element code, FElupe.

FElupe solves them in a process of its own, of which nothing is imported here: it is given nodes, cells and the scene's
numbers, and has its own kinematics, quadrature, assembly, laws and Newton's method; contact, the tendons and the second
invariant of Mooney and Rivlin are written here once more as its items. What should come out is the same displacement
but for round-off.

make out/peers/felupe/ready     installs FElupe into a folder, for that process alone
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from fingerfem import FingerModel
from fingerfem.discretisation import regions
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.mechanics import contact
from fingerfem.scene.grid_lines import in_channel
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene
from studies.parts import ROOT, Run

FELUPE = ROOT / "out" / "peers" / "felupe"
# Newton's method quadratically: after an iteration that moves so little [-] there is nothing left but round-off.
TIGHT = NewtonOptions(tolerance=0.0, settled=1e-11, noise=1e-8)
NEO_HOOKEAN = {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7}
# The same moduli at small strain, a fifth of the shear modulus in C01.
MOONEY_RIVLIN = {"law": "mooney-rivlin", "C10": 1.52e6, "C01": 0.38e6, "D1": 3.22e-7}
SAINT_VENANT_KIRCHHOFF = {"law": "saint-venant-kirchhoff", "E": 9.88e6, "nu": 0.3}
NEARLY_INCOMPRESSIBLE = {"law": "neo-hookean", "C1": 1.9e6, "D1": 1.05e-8}  # Poisson's ratio 0.49
LAWS = (NEO_HOOKEAN, MOONEY_RIVLIN, SAINT_VENANT_KIRCHHOFF)
# Tensions [N] and distances [m], None without a plane.
ONE_SEGMENT = (([100.0, 0.0], None), ([50.0, 30.0], None), ([60.0, 20.0], None), ([60.0, 20.0], 0.005))
FEWER = (([100.0, 0.0], None), ([60.0, 20.0], None), ([60.0, 20.0], 0.012))
# Saint Venant's and Kirchhoff's law softens in compression: less of it.
SOFTENING = (([60.0, 0.0], None), ([40.0, 20.0], None), ([40.0, 20.0], 0.012))
TWO_SEGMENTS = (([40.0, 20.0], None), ([20.0, 15.0], None), ([20.0, 15.0], 0.030))
ONE_PRESSED = (([60.0, 20.0], None), ([60.0, 20.0], 0.012))
DRAFT, COARSE_QUADRATIC = ([20, 5], 1), ([10, 5], 2)

State = tuple[list[float], float | None]


def scene_of(name: str, law: dict[str, Any], mesh: tuple[list[int], int], method: str = "penalty") -> Scene:
    """A scene of the repository with another law, mesh and method of contact."""
    table = tomllib.loads((ROOT / "scenes" / f"{name}.toml").read_text())
    table["material"], table["mesh"] = law, {"cells": mesh[0], "order": mesh[1]}
    table["obstacle"]["method"] = method
    return Scene.model_validate(table)


def described(model: FingerModel) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """A finger for FElupe: its nodes, cells and what they are; and the scene's numbers. No answer is among them."""
    problem, scene = model.problem, model.scene
    channels = [in_channel(scene.outline, tendon, problem.mesh.midpoints) for tendon in scene.tendons]
    rubber = np.isin(problem.mesh.cells.values, regions.RUBBERS)  # of every cell, in their order
    arrays = {
        "points": problem.space.tabulate_dof_coordinates(),
        "cells": problem.space.dofmap.list,
        "rubber": rubber,
        "channels": np.array(channels),
    }
    obstacle = None
    if scene.obstacle is not None:
        gamma = float(problem.fields.stiffness.value)
        obstacle = {"method": scene.obstacle.method, "stiffness": gamma, "plates": contact.PLATES}
    return arrays, {
        "order": scene.mesh.order,
        "half": scene.is_half,
        "side": scene.geometry.side,
        "length": scene.geometry.length,
        "plates": [list(plate) for plate in scene.outline.plates],
        "channel_area": scene.geometry.channel_width**2,
        "law": scene.law.model_dump(),
        "plate_law": plate_law(scene.law).model_dump(),
        "mixed": scene.law.is_mixed,
        "obstacle": obstacle,
        "force_scale": problem.force_scale,
    }


def ask_felupe(arrays: dict[str, np.ndarray], settings: dict[str, Any], folder: Path) -> tuple[np.ndarray, Any]:
    """What FElupe's process answers: displacements, shape (states, nodes, 3) [m], and its report.

    Args:
        arrays: of `described`.
        settings: what process.py reads beside.
        folder: for the two files.
    """
    if not (FELUPE / "felupe").exists():
        raise FileNotFoundError(f"{FELUPE} must hold FElupe, got nothing there: make out/peers/felupe/ready")
    folder.mkdir(parents=True, exist_ok=True)
    given, wanted = folder / "asked.npz", folder / "answered.npz"
    whole: dict[str, Any] = arrays | {"settings": np.array(json.dumps(settings))}
    np.savez(given, **whole)
    one_core = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    variables = os.environ | one_core | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(FELUPE)])}
    words = [sys.executable, "-m", "studies.peers.felupe.process", str(given), str(wanted)]
    subprocess.run(words, check=True, env=variables, cwd=ROOT)
    with np.load(wanted) as file:
        found = file["displacements"], json.loads(str(file["report"]))["found"]
    given.unlink()
    wanted.unlink()
    return found


def compare(scene: Scene, states: list[State] | tuple[State, ...], folder: Path) -> list[dict[str, Any]]:
    """A scene's states by both codes, a row for each."""
    model = FingerModel(scene)
    model.continuation.newton.options = TIGHT
    arrays, numbers = described(model)
    asked = [{"tensions": tensions, "distance": distance} for tensions, distance in states]
    displacements, reports = ask_felupe(arrays, {"scene": numbers, "states": asked}, folder)
    rows = []
    for (tensions, distance), theirs, report in zip(states, displacements, reports, strict=True):
        ours = model.solve(tensions, distance, sensitivities=False)
        rows.append(row(model, (tensions, distance), ours, theirs, report))
    return rows


def row(model: FingerModel, state: State, ours: Any, theirs: np.ndarray, report: dict[str, Any]) -> dict[str, Any]:
    """How far the two codes' answers for a state are apart."""
    scene, way = model.scene, float(np.linalg.norm(ours.tip))
    failed = report["failed"]
    apart = np.abs(ours.displacement.reshape(-1, 3) - theirs).max()
    found: dict[str, Any] = {
        "scene": scene.name,
        "law": scene.law.model_dump()["law"] + (", mixed" if scene.law.is_mixed else ""),
        "mesh": {"cells": list(scene.mesh.cells), "order": scene.mesh.order},
        "method": scene.obstacle.method if scene.obstacle else None,
        "unknowns": model.problem.unknowns,
        "tensions": state[0],
        "distance": state[1],
        "tip_way": way,
        "displacement_difference": None if failed else float(apart) / way,
        "contact_force": None,
        "contact_force_difference": None,
        "our_iterations": ours.newton_iterations,
        "felupe_iterations": report["iterations"],
        "failed": failed,
    }
    if state[1] is not None and not failed:
        force = float(ours.contact_force)
        found["contact_force"] = force
        found["contact_force_difference"] = abs(report["contact_force"] - force) / force
    return found


def questions() -> dict[str, tuple[Scene, tuple[State, ...]]]:
    """What both codes are asked, by a name."""
    found: dict[str, tuple[Scene, tuple[State, ...]]] = {}
    for mesh in (DRAFT, COARSE_QUADRATIC):
        for law in LAWS:
            usual = ONE_SEGMENT if mesh == DRAFT else FEWER
            states = SOFTENING if law is SAINT_VENANT_KIRCHHOFF else usual
            found[f"{law['law']}, order {mesh[1]}"] = scene_of("one_segment", law, mesh), states
    found["mixed"] = scene_of("one_segment", NEARLY_INCOMPRESSIBLE, COARSE_QUADRATIC), ONE_PRESSED
    found["two segments"] = scene_of("two_segments", NEO_HOOKEAN, ([12, 8], 1)), TWO_SEGMENTS
    for mesh in (DRAFT, COARSE_QUADRATIC):
        found[f"Nitsche, order {mesh[1]}"] = scene_of("one_segment", NEO_HOOKEAN, mesh, "nitsche"), ONE_PRESSED
    return found


def measure(run: Run) -> list[dict]:
    """All states by both codes."""
    found = []
    for name, (scene, states) in questions().items():
        found += run.once(name, compare, scene, states, run.folder / "felupe")
    return found

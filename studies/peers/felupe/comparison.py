"""Part `finite_elements`: the same states of the same meshes by another finite element code, FElupe.

FElupe runs in a process of its own, of which nothing is imported here: make out/peers/felupe/ready. It gets nodes,
cells and the scene's numbers. Its Newton's method begins at a displacement that is 0.1 ppm too small.
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
from dolfinx import fem

from fingerfem import FingerModel
from fingerfem.discretisation import regions
from fingerfem.equilibrium.newton import NewtonOptions
from fingerfem.scene.laws import plate_law
from fingerfem.scene.scene import Scene
from studies.parts import ROOT, Run

FELUPE = ROOT / "out" / "peers" / "felupe"
SHORT = 1 - 1e-7  # of the displacement: where FElupe begins [-]
# Newton's method converges quadratically: an iteration that moves so little [-] leaves nothing but round-off.
TIGHT = NewtonOptions(tolerance=0.0, settled=1e-11, noise=1e-8)
NEO_HOOKEAN = {"law": "neo-hookean", "C1": 1.9e6, "D1": 2.43e-7}
# The same moduli at small strain, a fifth of the shear modulus in C01.
MOONEY_RIVLIN = {"law": "mooney-rivlin", "C10": 1.52e6, "C01": 0.38e6, "D1": 3.22e-7}
# Nearly incompressible, in the mixed form.
YEOH = {"law": "yeoh", "C1": 1.9e6, "C2": 3e5, "C3": 2e4, "D1": 2e-8}
WEIGHT = {"density": 1070.0, "direction": [0.3, -0.5, 0.8], "acceleration": 100.0}  # tenfold, so that it counts
# Tensions [N], pressures of chambers [Pa] and distances [m], None without a plane.
USUAL = (([100.0, 0.0], None), ([60.0, 20.0], None), ([60.0, 20.0], 0.005))
DRAFT, COARSE_QUADRATIC = ([20, 5], 1), ([10, 5], 2)

State = tuple[list[float], float | None]


def scene_of(name: str, law: dict[str, Any], mesh: tuple[list[int], int], **more: Any) -> Scene:
    """A scene of the repository with another law and mesh, and with more tables."""
    table = tomllib.loads((ROOT / "scenes" / f"{name}.toml").read_text())
    table["material"], table["mesh"] = law, {"cells": mesh[0], "order": mesh[1]}
    return Scene.model_validate(table | more)


def described(model: FingerModel) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Input of FElupe for a finger in front of a plane: nodes, cells and their regions; the scene's numbers."""
    problem, scene, weight = model.problem, model.scene, model.scene.gravity
    arrays = {
        "points": problem.space.tabulate_dof_coordinates(),
        "cells": problem.space.dofmap.list,
        "rubber": np.isin(problem.mesh.cells.values, regions.of_material(0)),  # of every cell, in their order
        "channels": np.array([problem.mesh.pulled(scene, k)[0] for k in range(len(scene.tendons))]),
        "walls": np.zeros((len(scene.chambers), len(problem.space.tabulate_dof_coordinates())), bool),  # their nodes
    }
    for own, wall in zip(arrays["walls"], problem.mesh.walls, strict=True):
        own[fem.locate_dofs_topological(problem.space, 2, wall)] = True
    return arrays, {
        "order": scene.mesh.order,
        "side": scene.geometry.side,
        "length": scene.geometry.length,
        "channel_area": scene.geometry.channel_width**2,
        "law": scene.law.model_dump(),
        "mixed": int(scene.law.is_mixed),
        "densities": [0.0, 0.0] if weight is None else [weight.density, weight.plate_density],
        "acceleration": [0.0, 0.0, 0.0] if weight is None else weight.vector.tolist(),
        "plate_law": plate_law(scene.law).model_dump(),
        "stiffness": float(problem.fields.stiffness.value),
        "force_scale": problem.force_scale,
    }


def ask_felupe(arrays: dict[str, np.ndarray], scene: dict[str, Any], folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Answers of FElupe's process: displacements, shape (states, nodes, 3) [m], and contact forces [N]."""
    if not (FELUPE / "felupe").exists():
        raise FileNotFoundError(f"{FELUPE} must hold FElupe, got nothing there: make out/peers/felupe/ready")
    folder.mkdir(parents=True, exist_ok=True)
    given, wanted = folder / "asked.npz", folder / "answered.npz"
    whole: dict[str, Any] = arrays | {"scene": np.array(json.dumps(scene))}
    np.savez(given, **whole)
    variables = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join([str(ROOT), str(FELUPE)])}
    words = [sys.executable, "-m", "studies.peers.felupe.finger", str(given), str(wanted)]
    subprocess.run(words, check=True, env=variables, cwd=ROOT)
    with np.load(wanted) as file:
        return file["displacements"], file["contact_forces"]


def compare(scene: Scene, states: tuple[State, ...], folder: Path, changed: dict[str, Any] | None = None) -> dict:
    """Largest differences of a scene's states by both codes; `changed` are numbers that FElupe gets wrong."""
    model = FingerModel(scene)
    model.continuation.newton.options = TIGHT
    ours = [model.solve(tensions, distance, sensitivities=False) for tensions, distance in states]
    moved = np.array([state.displacement.reshape(-1, 3) for state in ours])
    arrays, numbers = described(model)
    asked = numbers | {"states": states} | (changed or {})
    theirs, forces = ask_felupe(arrays | {"starts": SHORT * moved}, asked, folder)
    pressed = [(one.contact_force, force) for one, force in zip(ours, forces, strict=True) if one.contact_force]
    return {
        "scene": scene.name,
        "law": scene.law.model_dump()["law"],
        "mesh": f"{scene.mesh.cells[0]} x {scene.mesh.cells[1]}, order {scene.mesh.order}",
        "unknowns": model.problem.unknowns,
        "states": len(states),
        "displacement": max(
            float(np.abs(one - other).max() / np.linalg.norm(state.tip))
            for one, other, state in zip(theirs, moved, ours, strict=True)
        ),
        "contact_force": max(abs(force / one - 1) for one, force in pressed) if pressed else None,
    }


def measure(run: Run) -> list[dict]:
    """All laws and orders; Yeoh's rubber has weight."""
    laws: tuple[tuple[dict, dict], ...] = ((NEO_HOOKEAN, {}), (MOONEY_RIVLIN, {}), (YEOH, {"gravity": WEIGHT}))
    asked = [
        (scene_of("one_segment", law, mesh, **more), USUAL) for mesh in (DRAFT, COARSE_QUADRATIC) for law, more in laws
    ]
    return [run.once(f"{k}", compare, *one, run.folder / "felupe") for k, one in enumerate(asked)]

"""The full-order solver, measured: factorisations, and growth with the unknowns.

One core; the paper's mesh, or the draft mesh in the short form.
"""

from __future__ import annotations

import time

import numpy as np

from fingerfem import FingerModel, load_scene
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.scene.scene import Scene
from studies.kinds import SCENES
from studies.parts import Run

LINES = [[50.0, 20.0], [100.0, 60.0]]  # tensions of contact lines [N]
STATES = 9  # of a line
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
    scene = load_scene(SCENES / "one_segment.toml")
    model = FingerModel(scene)
    model.continuation.rest()
    model.continuation.advance([1.0, 0.0], None)  # what is done once: compiled forms, symbolic factorisation
    found: dict = {"scene": scene.name, "from_rest": run.once("from rest to 100 N", from_rest, model)}
    found["lines"] = [run.once(f"contact line at {line} N", contact_line, model, line) for line in LINES]
    total = sum(line["factorisations"] for line in found["lines"])
    found["factorisations_per_contact_state"] = total / (STATES * len(LINES))
    found["sizes"] = [run.once(f"cells {cells}", on_mesh, scene, cells) for cells in SIZES]
    return found

"""What each kind of scene costs, measured on one mesh: unknowns, compiled forms, time of one Newton iteration.

One core.
"""

from __future__ import annotations

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from studies.kinds import forms_of, kinds
from studies.measures import shortest
from studies.runner import Run


def cost(name: str, scene: Scene) -> dict:
    """What one iteration of a scene costs, at rest: assembly of residual and tangent, factorisation, solve."""
    model = FingerModel(scene)
    newton = model.continuation.newton
    linearisation = newton.linearise()
    right, _ = model.problem.residual()
    assembly = shortest(lambda: model.problem.residual()[0].destroy()) + shortest(model.problem.tangent)
    seconds = {
        "assembly_seconds": assembly,
        "solve_seconds": shortest(lambda: linearisation.solve(right.copy())),
        "factorise_seconds": shortest(newton.linearise) - shortest(model.problem.tangent),
    }
    return {
        "scene": name,
        "parameters": len(scene.parameters),
        "unknowns": model.problem.unknowns,
        "forms": forms_of(model.problem.forms),
        **seconds,
        "iteration_seconds": sum(seconds.values()),
    }


def measure(run: Run) -> list[dict]:
    """A row a kind of scene; the short form leaves out Nitsche's method, whose forms take long to compile."""
    rows = []
    for name, table in kinds().items():
        if run.quick and "Nitsche" in name:
            continue
        table["mesh"] = {"cells": [20 if run.quick else 30, 10], "order": 1}  # of each segment
        rows.append(run.once(name, cost, name, Scene.model_validate(table)))
    return rows

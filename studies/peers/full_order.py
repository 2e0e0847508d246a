"""Part `reference`: what the full-order model answers by mesh; all others are held against the finest."""

from __future__ import annotations

import tomllib

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from studies.parts import Run
from studies.peers.question import CONTACT, FREE, SCENE, answers

# Cells along and across, Lagrange order; the finest last.
MESHES = (("draft mesh", (20, 5, 1)), ("paper's mesh", (100, 10, 1)), ("standard mesh", (10, 5, 2)))
FINER, FINEST = (24, 6, 2), (40, 8, 2)
LIMITS = "the reference is the same code on a finer mesh: law, tendon and contact are the same"


def solved(name: str, mesh: tuple[int, int, int]) -> dict:
    """Every state solved from rest, with F1 alone: half the finger is modelled, by symmetry."""
    along, across, order = mesh
    table = tomllib.loads(SCENE.read_text())
    table |= {"tendons": table["tendons"][:1], "mesh": {"cells": [along, across], "order": order}}
    model = FingerModel(Scene.model_validate(table))

    def ask(tension: float, distance: float | None) -> tuple[list[float], float | None]:
        state = model.solve([tension], distance, sensitivities=False)
        return state.tip.tolist(), state.contact_force

    ask(FREE[0], CONTACT[0][1])  # compiles
    settings = f"{along} x {across} x {across} cells of order {order}, half of them by symmetry; from rest"
    return answers(ask, "finite elements", name=name, settings=settings, limits=LIMITS).as_json()


def measure(run: Run) -> dict:
    """The answers by mesh."""
    ours = [run.once(name, solved, f"fingerfem, {name}", mesh) for name, mesh in MESHES]
    finer, finest = (run.once(name, solved, name, mesh) for name, mesh in (("finer", FINER), ("finest", FINEST)))
    return {"ours": ours, "finer": finer, "finest": finest}

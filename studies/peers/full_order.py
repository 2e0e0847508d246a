"""Part `reference`: what the full-order model answers by mesh; all others are held against the finest."""

from __future__ import annotations

import time
import tomllib

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from studies.parts import Run
from studies.peers.question import CONTACT, FREE, SCENE, Answers

# Cells along and across, Lagrange order; the finest last.
MESHES = (("draft mesh", (20, 5, 1)), ("paper's mesh", (100, 10, 1)), ("standard mesh", (10, 5, 2)))
FINER, FINEST = (24, 6, 2), (40, 8, 2)
LIMITS = "the reference is the same code on a finer mesh: law, tendon and contact are the same"


def answers(name: str, mesh: tuple[int, int, int]) -> Answers:
    """Every state solved from rest, with F1 alone: half the finger is modelled, by symmetry."""
    along, across, order = mesh
    table = tomllib.loads(SCENE.read_text())
    table |= {"tendons": table["tendons"][:1], "mesh": {"cells": [along, across], "order": order}}
    model = FingerModel(Scene.model_validate(table))
    model.solve([FREE[0]], CONTACT[0][1], sensitivities=False)  # compiles
    begun = time.process_time()
    free = [model.solve([tension], sensitivities=False) for tension in FREE]
    touching = [model.solve([tension], distance, sensitivities=False) for tension, distance in CONTACT]
    seconds = (time.process_time() - begun) / (len(FREE) + len(CONTACT))
    return Answers(
        name=name,
        kind="finite elements",
        free_tips=[state.tip.tolist() for state in free],
        contact_tips=[state.tip.tolist() for state in touching],
        contact_forces=[state.contact_force for state in touching],
        seconds=seconds,
        settings=f"{along} x {across} x {across} cells of order {order}, half of them by symmetry; from rest",
        limits=LIMITS,
    )


def measure(run: Run) -> dict:
    """The answers by mesh."""
    ours = [run.once(name, lambda n=name, m=mesh: answers(f"fingerfem, {n}", m).as_json()) for name, mesh in MESHES]
    finer = run.once("finer", lambda: answers("finer", FINER).as_json())
    finest = run.once("finest", lambda: answers("reference", FINEST).as_json())
    return {"ours": ours, "finer": finer, "finest": finest}

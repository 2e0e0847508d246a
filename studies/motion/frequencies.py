"""Natural frequencies of rods against the full-order model, about free states and states in contact with a plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from rom import MovingFinger, TouchedSegment
from rom.error_statistics import quantiles
from rom.files.checked_file import ModelError
from studies.motion.fingers import DENSITY, DISTANCES, table, touching, trained
from studies.parts import Run

STATES = {"square": 35, "two segments": 35, "ring": 18, "circle": 12}  # free and in contact in turns
SEED = 44
LARGEST = 5.0  # tension [N]
DEPTHS = 0.3, 0.95  # d over the distance of touch [-]
MODES = 3
PRESSED = "two segments"  # the finger of the worst state on rubber
KINDS = "free", "plates", "rubber", "one"  # no contact; of plates alone; of rubber too; of rubber in one of the models


def states(run: Run, name: str) -> dict[str, Any]:
    """Random states of a finger: relative errors of its first frequencies by kind, and how many were left out."""
    from fingerfem.dynamics.modes import ModalAnalysis
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.scene.scene import Scene

    rod, random = trained(run, name), np.random.default_rng(SEED)
    full, model = ModalAnalysis(Scene.model_validate(table(rod, before_plane=True))), touching(rod)
    upper = np.minimum(LARGEST, [one.upper for one in rod.parameters])
    finger = MovingFinger(model, np.append(0 * upper, np.inf), DENSITY)
    errors: dict[str, list[list[float]]] = {kind: [] for kind in KINDS}
    points: dict[str, list[list[float]]] = {kind: [] for kind in KINDS}
    left = {"beyond": 0, "failed": 0}
    for k in range(STATES[name]):
        tensions, d = upper * random.random(len(upper)), np.inf
        while k % 2 and not DISTANCES[0] <= d <= DISTANCES[1]:
            tensions = upper * random.random(len(upper))
            d = random.uniform(*DEPTHS) * float(model.evaluate([*tensions, np.inf]).touch_distance)
        try:
            ours = finger.frequencies([*tensions, d], MODES)
            theirs = full.solve(tensions, d if k % 2 else None, count=MODES).frequencies
        except ModelError:
            left["beyond"] += 1
            continue
        except LoadNotReached:
            left["failed"] += 1
            continue
        touched = [on_rubber(model, [*tensions, d]), presses_rubber(full.problem)] if k % 2 else []
        kind = KINDS[(1 + touched[0] if touched[0] == touched[1] else 3) if touched else 0]
        errors[kind].append(np.abs(ours / theirs - 1).tolist())
        points[kind].append([*tensions.tolist(), float(d)])
    return {"errors": errors, "points": points, "left": left}


def on_rubber(model: TouchedSegment, point: list[float]) -> bool:
    """True if the plane presses on rubber of the rod."""
    return any(one.rubber for one in model.contact_forces(point))


def presses_rubber(problem: Any) -> bool:
    """True if the plane presses on nodes of rubber of the full-order model."""
    from fingerfem.scene.grid_lines import in_plate

    outline, rest = problem.scene.outline, problem.rest
    plates = [in_plate(outline, k, rest.T) for k in range(len(problem.scene.geometry.segments))]
    forces = np.abs(problem.contact.nodal_force()[: len(rest)]).max(axis=1)
    return bool((forces[~np.any(plates, axis=0)] > 0).any())


def finer(run: Run, name: str, point: list[float]) -> dict[str, Any]:
    """The second frequency of a finger in contact, of the rod and of meshes with more cells across [Hz]."""
    from fingerfem.dynamics.modes import ModalAnalysis
    from fingerfem.scene.scene import Scene

    rod = trained(run, name)
    model, scene = touching(rod), table(rod, before_plane=True)
    along, across = scene["mesh"]["cells"]
    ours = MovingFinger(model, np.append(0.0 * np.array(point[:-1]), np.inf), DENSITY).frequencies(point, MODES)
    meshes = list[list[float]]()
    for cells in (across, 2 * across, 4 * across):
        full = ModalAnalysis(Scene.model_validate(scene | {"mesh": scene["mesh"] | {"cells": [along, cells]}}))
        meshes.append([cells, float(full.solve(point[:-1], point[-1], count=MODES).frequencies[1])])
    return {"name": name, "rod": float(ours[1]), "meshes": meshes}


def measure(run: Run) -> dict[str, Any]:
    """Errors of every finger, and over all fingers by kind."""
    rows = {name: run.once(name, states, run, name) for name in STATES}
    found = {
        name: {kind: [quantiles(own) for own in np.array(one).T] for kind, one in row["errors"].items() if one}
        for name, row in rows.items()
    }
    pressed = rows[PRESSED]["points"]["rubber"][int(np.argmax(rows[PRESSED]["errors"]["rubber"], axis=0)[1])]
    left = {name: sum(row["left"][name] for row in rows.values()) for name in ("beyond", "failed")}
    return {
        "fingers": found,
        "left": left,
        "states": sum(STATES.values()),
        "finer": run.once("finer", finer, run, PRESSED, pressed),
    }

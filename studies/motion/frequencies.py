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
KINDS = "free", "plates", "rubber", "one"  # no contact; of plates alone; of rubber too; of rubber in one of the models
FINER: dict[str, Any] = {"order": 2}  # of the same cells, for the shape of rubber
PULLED = [4.2, 2.1, 2.4, 3.6]  # tensions there [N]


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
    return {"errors": errors, "left": left}


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


def bulge(run: Run) -> dict[str, float]:
    """Heights of the square finger's face midway between its plate and the nearest cross-section of nodes [m].

    They are heights above straight lines between both, of the rod and of the full-order model by order 2: their
    means across the face, and the largest difference.
    """
    from fingerfem import FingerModel
    from fingerfem.scene.scene import Scene

    rod = trained(run, "square")
    scene = table(rod)
    finer = FingerModel(Scene.model_validate(scene | {"mesh": scene["mesh"] | FINER}))
    finer.solve(PULLED, sensitivities=False)
    rest, top = finer.problem.space.tabulate_dof_coordinates(), finer.problem.scene.geometry.shape.top
    plate = scene["geometry"]["segments"][0] - scene["geometry"]["plate"]
    planes = np.unique(rest[rest[:, 0] < plate + 1e-9, 0].round(9))[-3:]
    face = np.isclose(rest[:, 1], top, atol=1e-9)
    rows = [np.flatnonzero(face & np.isclose(rest[:, 0], x, atol=1e-9)) for x in planes]
    nodes = np.array([row[np.argsort(rest[row, 2])] for row in rows])

    def heights(displaced: np.ndarray) -> np.ndarray:
        near, middle, far = rest[nodes] + displaced
        along = (far - near) / np.linalg.norm(far - near, axis=1)[:, None]
        return np.asarray(np.cross(along, middle - near)[:, 2])

    model = touching(rod).displacement([*PULLED, np.inf], rest[nodes].reshape(-1, 3)).reshape(*nodes.shape, 3)
    ours, theirs = heights(model), heights(finer.problem.displacement.reshape(-1, 3)[nodes])
    return {"rod": ours.mean(), "finer": theirs.mean(), "difference": float(np.abs(ours - theirs).max())}


def measure(run: Run) -> dict[str, Any]:
    """Errors of every finger, and over all fingers by kind."""
    rows = {name: run.once(name, states, run, name) for name in STATES}
    found = {
        name: {kind: [quantiles(own) for own in np.array(one).T] for kind, one in row["errors"].items() if one}
        for name, row in rows.items()
    }
    left = {name: sum(row["left"][name] for row in rows.values()) for name in ("beyond", "failed")}
    return {
        "fingers": found,
        "left": left,
        "states": sum(STATES.values()),
        "bulge": run.once("bulge", bulge, run),
    }

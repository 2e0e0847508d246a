"""Full-order states of the draft finger of another law and mesh: poses of the tip, shortenings and contact forces."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies import sets
from studies.cores import on_cores
from studies.parts import Run

# Laws with the small-strain moduli of the bundled finger's neo-Hookean one.
LAWS: dict[str, dict[str, Any]] = {
    "Mooney-Rivlin": {"law": "mooney-rivlin", "C10": 1.52e6, "C01": 0.38e6, "D1": 2.43e-7},
    "Yeoh": {"law": "yeoh", "C1": 1.9e6, "C2": 1.0e5, "D1": 2.43e-7},
}
LARGEST, COUNT, SEED = 90.0, 60, 5  # tension [N], states; every other one touches the plane
DEPTHS, NEAREST = (0.5e-3, 12e-3), 2e-3  # of the plane beyond where it is touched, and its least distance [m]
FARTHER = 3e-3  # fingers that touch only nearer planes stay free [m]
FRONT = 1e-9  # of nodes on the front face, from that [m]


def measure(run: Run) -> list[list[dict[str, Any]]]:
    """States of every law."""
    return on_cores(solved, [(law,) for law in LAWS])


def solved(law: str) -> list[dict[str, Any]]:
    """States at random tensions: tensions [N], d [m] (None if free), tip displacement, rotation, shortenings, force."""
    from fingerfem import FingerModel
    from fingerfem.scene.scene import Scene

    table = sets.draft_table(sets.STANDARD) | {"material": LAWS[law]}
    table["obstacle"] = {name: one for name, one in table["obstacle"].items() if name != "pad"}
    model, random, found = FingerModel(Scene.model_validate(table)), np.random.default_rng(SEED), []
    nodes = model.problem.space.tabulate_dof_coordinates()
    front = np.abs(nodes[:, 0] - table["geometry"]["segments"][0]) < FRONT
    for k in range(COUNT):
        pulled, distance = random.uniform(0, LARGEST, 2), None
        state = model.solve(pulled, sensitivities=False)
        if k % 2 and state.touch_distance is not None and state.touch_distance > FARTHER:
            nearest = max(NEAREST, state.touch_distance - DEPTHS[1])
            distance = float(random.uniform(nearest, state.touch_distance - DEPTHS[0]))
            state = model.solve(pulled, distance, sensitivities=False)
        moved = state.displacement.reshape(-1, 3)[front]
        found.append(
            {
                "tensions": pulled.tolist(),
                "distance": distance,
                "tip": state.tip.tolist(),
                "rotation": rotation(nodes[front], nodes[front] + moved).tolist(),
                "shortening": list(state.channel_shortening.values()),
                "force": float(state.contact_force or 0.0),
            }
        )
    return found


def rotation(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The rotation of a rigid face by the places of its nodes, shape (3, 3) (Kabsch 1976)."""
    first, second = (one - one.mean(axis=0) for one in (before, after))
    left, _, right = np.linalg.svd(first.T @ second)
    return right.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ left.T

"""What is held, fed to the full-order model, as figures 7 and 8 of the paper.

Random starts, distances and contact forces; every answer that is converged is solved again by the full-order model of
the mesh that the model was trained on, from rest.
"""

from __future__ import annotations

import numpy as np

from control import Finger
from control.model import Model
from fingerfem import FingerModel
from fingerfem.certify import full_order_scene
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.scene.scene import Scene
from studies.control.models import finger
from studies.parts import Run

CASES, SEED = 20, 2018
FORCES = 0.25, 4.0  # [N], two octaves on both sides of the paper's 1 N


def answers(known: Model, cases: int, seed: int) -> list[dict]:
    """Held answers: `cases` that are converged, of random starts, distances and contact forces."""
    finger, (lower, upper) = Finger(known), known.limits
    random = np.random.default_rng(seed)
    found: list[dict] = []
    while len(found) < cases:
        *start, distance = lower + random.random(len(lower)) * (upper - lower)
        target = float(np.exp(random.uniform(*np.log(FORCES))))
        motion = finger.hold(target, float(distance), start=start)
        if motion.converged:
            point = [*motion.tensions, distance]
            found.append(
                {
                    "target": target,
                    "distance": float(distance),
                    "tensions": motion.tensions.tolist(),
                    "estimated_error": motion.error,
                    "tip": known.evaluate(point).tip.tolist(),
                }
            )
    return found


def verified(case: dict, full_order: FingerModel) -> dict:
    """A held answer with what the full-order model says of it; `force` is None where that found no equilibrium."""
    try:
        state = full_order.solve(case["tensions"], case["distance"], sensitivities=False)
    except LoadNotReached as error:
        return case | {"force": None, "reason": str(error)}
    return case | {
        "force": state.contact_force,
        "error": abs(state.contact_force / case["target"] - 1),
        "tip_error": float(np.linalg.norm(np.array(case["tip"]) - state.tip)),
        "full_order_tip": state.tip.tolist(),
    }


def summary(cases: list[dict]) -> dict:
    """Errors of the cases that the full-order model solved."""
    solved = [case for case in cases if case["force"] is not None]
    errors, tips = np.array([case["error"] for case in solved]), np.array([case["tip_error"] for case in solved])
    moved = np.array([np.linalg.norm(case["full_order_tip"]) for case in solved])
    off = np.array([abs(case["force"] - case["target"]) for case in solved])
    return {
        "cases": len(cases),
        "not_solved": len(cases) - len(solved),
        "median": float(np.median(errors)),
        "p95": float(np.percentile(errors, 95)),
        "max": float(errors.max()),
        "within_estimate": int(np.sum(off <= [case["estimated_error"] for case in solved])),
        "tip_median": float(np.median(tips / moved)),
        "tip_max": float(np.max(tips / moved)),
    }


def measure(run: Run) -> dict:
    """A summary, and every case."""
    known = finger()
    full_order = FingerModel(Scene(**full_order_scene(known)))
    cases = [
        run.once(f"answer {k + 1}", verified, case, full_order) for k, case in enumerate(answers(known, CASES, SEED))
    ]
    return summary(cases) | {"each": cases}

"""Simulated grasps of unknown objects, with noise, delay, rounding and errors of the model."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from control import Flaws, Gripper, Limits, Object, SimulatedPlant
from control.grasping.grasp_forces import carries
from control.loop import run
from control.model import Model
from studies.control.models import finger
from studies.parts import Run, say

RATE = 1000.0  # [Hz]
MOTOR = 500.0  # [N/s], most that a tension changes
CLOSING, HOLDING = 3.0, 0.2  # [s]: at most until it holds; then lifted
LOOKS = 20  # at the lifted object


def drawn(random: np.random.Generator, gripper: Gripper) -> tuple[Object, np.ndarray, float, list[Flaws]]:
    """An object, its distances from the fingers [m], its admissible force [N], and the fingers' flaws."""
    while True:
        angle, away, radius = random.uniform(0, 2 * np.pi), random.uniform(0, 0.004), random.uniform(0.008, 0.018)
        distances = gripper.distances([away * np.cos(angle), away * np.sin(angle)], radius)
        if distances.min() >= gripper.model.limits[0][-1]:
            break
    held = Object(
        mass=float(np.exp(random.uniform(*np.log([0.01, 0.3])))),
        friction=random.uniform(0.3, 1.0),
        admissible_force=float(np.exp(random.uniform(*np.log([0.5, 6.0])))),
        down=tuple(random.standard_normal(3)),
    )
    noise, delay = random.uniform(0.002, 0.02), int(random.integers(0, 6))
    errors = random.choice(np.array([-0.05, 0.05]), gripper.directions.shape[0])
    flaws = [
        Flaws(noise=noise, resolution=0.005, delay=delay, period=1 / RATE, force_error=float(error)) for error in errors
    ]
    return held, distances, noise, flaws


def grasped(gripper: Gripper, random: np.random.Generator) -> dict:
    """One grasp: what became of the object, and why."""
    held, distances, noise, flaws = drawn(random, gripper)
    known: dict[str, Any] = {"mass": held.mass, "friction": held.friction, "admissible_force": held.admissible_force}
    known |= {"distances": distances.tolist(), "noise": noise, "delay": flaws[0].delay}
    targets = gripper.targets(held)
    if not targets.exist:
        return known | {"fate": "refused", "reason": targets.reason}
    options = gripper.options(float(targets.contact_forces.min()), noise, flaws[0].delay, 1 / RATE)
    plants = [
        SimulatedPlant(gripper.model, float(d), flaw, seed=int(random.integers(2**31)))
        for d, flaw in zip(distances, flaws, strict=True)
    ]
    grips = gripper.grips(targets.contact_forces, options)
    forces: list[np.ndarray] = []

    def watch(_: int) -> None:
        forces.append(np.array([plant.contact_force for plant in plants]))

    closing = 0
    while closing < CLOSING * RATE and not all(grip.done for grip in grips):
        report = run(grips, plants, 50, watch)
        closing += report.periods
    status = [grip.status for grip in grips]
    known |= {"status": status, "seconds": closing / RATE, "targets": targets.contact_forces.tolist()}
    if any(grip.status != "converged" for grip in grips):
        worst = max(force.max() for force in forces)
        possible = gripper.targets(held, distances)
        fate = "crushed" if worst > held.admissible_force else "not lifted" if possible.exist else "out of reach"
        return known | {"fate": fate, "reason": possible.reason or str(status), "hardest": float(worst)}
    forces_before = len(forces)
    run(grips, plants, round(HOLDING * RATE), watch)
    hardest = max(float(force.max()) for force in forces)
    looks = forces[forces_before :: max((len(forces) - forces_before) // LOOKS, 1)]
    lifted = all(carries(gripper.directions, held, force) for force in looks)
    errors = np.abs(np.array(forces[forces_before:]) / targets.contact_forces - 1)
    fate = "crushed" if hardest > held.admissible_force else "held" if lifted else "dropped"
    return known | {"fate": fate, "reason": "", "hardest": hardest, "force_error": float(errors.max())}


def campaign(known: Model, grasps: int, seed: int) -> dict:
    """Many grasps: counts by fate, and those that failed."""
    gripper, random = Gripper(known, limits=Limits(rate=MOTOR)), np.random.default_rng(seed)
    found = []
    for i in range(grasps):
        found.append(grasped(gripper, random))
        if (i + 1) % 100 == 0:
            say({"grasps": i + 1} | Counter(one["fate"] for one in found))
    held = [one for one in found if one["fate"] == "held"]
    fates = ("held", "dropped", "crushed", "not lifted", "out of reach", "refused")
    return {
        "grasps": grasps,
        **{fate.replace(" ", "_"): sum(one["fate"] == fate for one in found) for fate in fates},
        "force_error_median": float(np.median([one["force_error"] for one in held])) if held else None,
        "force_error_max": float(max(one["force_error"] for one in held)) if held else None,
        "seconds_median": float(np.median([one["seconds"] for one in held])) if held else None,
        "reasons": [one["reason"] for one in found if one["fate"] == "refused"][:5],
        "failed": [one for one in found if one["fate"] in ("dropped", "crushed", "not lifted")],
    }


def measure(run: Run) -> dict:
    """With the bundled finger."""
    return campaign(finger(), 500, seed=2018)

"""Histories with friction of the assembled finger, against the full-order model with friction, before planes."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

from rom import Rod, TouchedSegment, friction_history
from rom.error_statistics import quantiles
from rom.rod.objects.shapes import facing_plane
from studies.rods import plans
from studies.rods.full_order import obstacle
from studies.runner import Run

CORES, INCREMENTS = 2, 4
PULLED, FORCES = ((15.0, 80.0), (0.0, 40.0)), (0.3, 6.0)  # tensions, and force without friction at first [N]
FRICTION, ASIDE, CHANGED = (0.2, 0.8), 1.5e-3, 8.0  # coefficients [-]; motions of the plane [m] and of tensions [N]
NEARER = 2e-4  # and of the plane towards the finger [m]
MOST = 100  # draws for one history


def draw(model: TouchedSegment, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, float]:
    """Points, motions of the plane and coefficient of one history: it presses, is dragged, pulled, and dragged back."""
    for _ in range(MOST):
        pulled = [random.uniform(*ends) for ends in PULLED]
        touch = float(model.outputs(np.array([[*pulled, np.inf]]))[0, 4])
        d = touch - random.uniform(2e-4, 4e-3)
        answer = model.evaluate([*pulled, d])
        if answer.inside and FORCES[0] < answer.contact_force < FORCES[1]:
            break
    first = np.array([*pulled, d])
    change = np.array([*random.uniform(-CHANGED, CHANGED, 2), random.uniform(-NEARER, NEARER)])
    second = np.clip(first + change, 0.0, None)
    way = random.uniform(-ASIDE, ASIDE, 3) * [1, 0, 1]
    points = np.array([first, first, second, second])
    return points, np.array([0 * way, way, way, 0 * way]), float(random.uniform(*FRICTION))


def compared(rod: Rod, table: dict[str, Any], seeds: list[int]) -> list[dict[str, Any]]:
    """Histories of some seeds, of both models."""
    from fingerfem import FingerModel, LoadNotReached
    from fingerfem.friction_history import friction_history as full_order
    from fingerfem.scene.scene import Scene

    plane = facing_plane(2 * rod.half_lengths[1], (1e-4, rod.rest[0]))
    scene = {key: value for key, value in table.items() if key != "load"} | {"obstacle": obstacle(plane)}
    model, full = TouchedSegment(rod=rod, obstacle=plane), FingerModel(Scene.model_validate(scene))
    rows = []
    for seed in seeds:
        points, moved, coefficient = draw(model, np.random.default_rng([21, seed]))
        ours = friction_history(model, points, coefficient, moved, INCREMENTS)
        row: dict[str, Any] = {"status": next((one.status for one in ours if one.status != "converged"), "converged")}
        if row["status"] == "converged":
            try:
                theirs = full_order(full, points, coefficient, moved, INCREMENTS)
            except LoadNotReached:
                row["status"] = "full-order not converged"
        if row["status"] == "converged":
            largest = max(float(np.linalg.norm(one.force)) for one in theirs)
            pairs = list(zip(ours, theirs, strict=True))
            row["errors"] = [float(np.linalg.norm(one.force - other.force)) / largest for one, other in pairs]
            row["slides"] = [
                [bool(one.contacts) and all(contact.slides for contact in one.contacts), bool(other.sticks == 0)]
                for one, other in pairs
            ]
        rows.append(row)
    return rows


def measure(run: Run) -> dict[str, Any]:
    """Errors of forces over the largest of a history, and how often both slide or neither does."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    plan, count = (plans.QUICK, 2) if run.quick else (plans.LARGE, 60)
    rod, table = plans.rod(run, plan), tomllib.loads(plans.scene(run, plan).read_text())
    parts = [list(range(k, count, CORES)) for k in range(CORES)]
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        rows = [row for part in pool.map(compared, [rod] * CORES, [table] * CORES, parts) for row in part]
    good = [row for row in rows if "errors" in row]
    decided = np.array([pair for row in good for pair in row["slides"]])
    names = ("out_of_domain", "no_equilibrium", "full-order not converged")
    return {
        "histories": count,
        "compared": len(good),
        "points": sum(len(row["errors"]) for row in good),
        "force": quantiles(np.concatenate([row["errors"] for row in good])),
        "alike": float(np.mean(decided[:, 0] == decided[:, 1])),
        **{name.replace(" ", "_").replace("-", "_"): sum(row["status"] == name for row in rows) for name in names},
    }

"""Histories with friction of the assembled finger, against the full-order model with friction, before planes."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np

from rom import Rod, TouchedSegment, friction_history
from rom.error_statistics import quantiles
from rom.rod.objects.shapes import facing_plane
from studies.rods import plans
from studies.rods.full_order import obstacle
from studies.rods.rubber import anywhere, clear_of_clamp
from studies.rods.scattered_objects import DISTANCE
from studies.runner import Run

CORES, INCREMENTS = 2, 4
PULLED, FORCES = ((15.0, 80.0), (0.0, 40.0)), (0.3, 6.0)  # tensions, and force without friction at first [N]
FRICTION, ASIDE, CHANGED = (0.2, 0.8), 1.5e-3, 8.0  # coefficients [-]; motions of the plane [m] and of tensions [N]
NEARER = 2e-4  # and of the plane towards the finger [m]
DEPTHS = 2e-4, 4e-3  # beyond touch [m]
MOST = 1000  # draws for one history


@dataclass(frozen=True)
class History:
    """Points, motions of the plane, and coefficient of friction: it presses, is dragged, pulled, and dragged back."""

    model: TouchedSegment
    points: np.ndarray
    moved: np.ndarray
    friction: float


def plate_first(rod: Rod, pulled: np.ndarray, random: np.random.Generator) -> tuple[TouchedSegment, float]:
    """The paper's plane, where d has it pressed."""
    model = TouchedSegment(rod=rod, obstacle=facing_plane(2 * rod.half_lengths[1], (1e-4, rod.rest[0])))
    touch = float(model.outputs(np.array([[*pulled, np.inf]]))[0, 4])
    return model, touch - random.uniform(*DEPTHS)


def rubber_first(rod: Rod, pulled: np.ndarray, random: np.random.Generator) -> tuple[TouchedSegment, float]:
    """A plane that touches the finger anywhere."""
    return TouchedSegment(rod=rod, obstacle=anywhere(rod, pulled, random, "plane")[0]), DISTANCE - random.uniform(
        *DEPTHS
    )


def draw(rod: Rod, rubber: bool, random: np.random.Generator) -> History:
    """A random one, that begins with contact on the rubber, or on the plate alone."""
    for _ in range(MOST):
        pulled = np.array([random.uniform(*ends) for ends in PULLED])
        model, d = (rubber_first if rubber else plate_first)(rod, pulled, random)
        first, normal = np.array([*pulled, d]), np.array(model.obstacle.numbers()["axis"])
        if not clear_of_clamp(rod, obstacle(model.obstacle), d):
            continue
        answer = model.evaluate(first)
        if not (answer.inside and FORCES[0] < answer.contact_force < FORCES[1]):
            continue
        if any(one.rubber for one in model.contact_forces(first)) == rubber:
            break
    change = np.array([*random.uniform(-CHANGED, CHANGED, 2), random.uniform(-NEARER, NEARER)])
    second = np.append(np.clip((first + change)[:-1], 0.0, None), first[-1] + change[-1])
    way = random.uniform(-ASIDE, ASIDE, 3)
    way -= (way @ normal) * normal
    moved = np.array([0 * way, way, way, 0 * way])
    return History(model, np.array([first, first, second, second]), moved, float(random.uniform(*FRICTION)))


def compared(rod: Rod, table: dict[str, Any], rubber: bool, seeds: list[int]) -> list[dict[str, Any]]:
    """Histories of some seeds, of both models."""
    from fingerfem import FingerModel, LoadNotReached
    from fingerfem.friction_history import friction_history as full_order
    from fingerfem.scene.scene import Scene

    rows = []
    for seed in seeds:
        one = draw(rod, rubber, np.random.default_rng([21, seed]))
        ours = friction_history(one.model, one.points, one.friction, one.moved, INCREMENTS)
        row: dict[str, Any] = {"status": next((one.status for one in ours if one.status != "converged"), "converged")}
        if row["status"] == "converged":
            scene = {key: value for key, value in table.items() if key != "load"}
            scene |= {"obstacle": obstacle(one.model.obstacle)}
            try:
                full = FingerModel(Scene.model_validate(scene))
                theirs = full_order(full, one.points, one.friction, one.moved, INCREMENTS)
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


def table_row(rows: list[dict[str, Any]], touched: str) -> dict[str, Any]:
    """Errors of forces over the largest of a history, and how often both slide or neither does."""
    good = [row for row in rows if "errors" in row]
    decided = np.array([pair for row in good for pair in row["slides"]])
    names = ("out_of_domain", "no_equilibrium", "full-order not converged")
    return {
        "touched": touched,
        "histories": len(rows),
        "compared": len(good),
        "points": sum(len(row["errors"]) for row in good),
        "force": quantiles(np.concatenate([row["errors"] for row in good])),
        "alike": float(np.mean(decided[:, 0] == decided[:, 1])),
        **{name.replace(" ", "_").replace("-", "_"): sum(row["status"] == name for row in rows) for name in names},
    }


def measure(run: Run) -> list[dict[str, Any]]:
    """Histories that begin on the plate, and on the rubber."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    plan, count = (plans.QUICK, 2) if run.quick else (plans.LARGE, 30)
    rod, table = plans.rod(run, plan), tomllib.loads(plans.scene(run, plan).read_text())
    parts, found = [list(range(k, count, CORES)) for k in range(CORES)], []
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        for touched in ("plate", "rubber"):
            given = [rod] * CORES, [table] * CORES, [touched == "rubber"] * CORES, parts
            found.append(table_row([row for part in pool.map(compared, *given) for row in part], touched))
    return found

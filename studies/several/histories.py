"""Histories with friction of the assembled finger, against the full-order model with friction."""

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
from rom.rod.touched_rod import ContactForce
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Table, obstacle
from studies.rods.scattered_objects import DISTANCE
from studies.rubber.random_objects import anywhere, clear_of_clamp

CORES, INCREMENTS = 2, 4
PULLED, FORCES = ((15.0, 80.0), (0.0, 40.0)), (0.3, 6.0)  # tensions, and force without friction at first [N]
FRICTION, ASIDE, CHANGED = (0.2, 0.8), 1.5e-3, 8.0  # coefficients [-]; motions of the plane [m] and of tensions [N]
NEARER, DRAGGED = 2e-4, 5e-4  # and of a plane, and of a round object, along its direction [m]
PLATE, RUBBER, ROUND = "plate", "rubber", "rubber, by a ball, a cylinder or a box"  # what is touched first
DEPTHS = 2e-4, 4e-3  # beyond touch [m]
HALF = 0.5  # of the normal force [-]: a finger slides if more of it is at points that slide
MOST = 1000  # draws for one history


@dataclass(frozen=True)
class History:
    """Points, motions of a plane besides, and coefficient of friction.

    A plane presses, is dragged, the finger is pulled, and the plane is dragged back. A round object moves along its
    direction alone, which is oblique to the surface, there and back.
    """

    model: TouchedSegment
    table: Table
    points: np.ndarray
    moved: np.ndarray
    friction: float


def pressing(
    rod: Rod, touched: str, pulled: np.ndarray, random: np.random.Generator
) -> tuple[TouchedSegment, Table, float]:
    """The paper's plane, or an object that touches the finger anywhere; its table, and d that has it pressed."""
    if touched != PLATE:
        shape = "plane" if touched == RUBBER else str(random.choice(["sphere", "cylinder", "box"]))
        found, table = anywhere(rod, pulled, random, shape)
        return TouchedSegment(rod=rod, obstacle=found), table, DISTANCE - random.uniform(*DEPTHS)
    plane = facing_plane(2 * rod.half_lengths[1], (1e-4, rod.rest[0]))
    model = TouchedSegment(rod=rod, obstacle=plane)
    touch = float(model.outputs(np.array([[*pulled, np.inf]]))[0, 4])
    return model, obstacle(plane), touch - random.uniform(*DEPTHS)


def draw(rod: Rod, touched: str, random: np.random.Generator) -> History:
    """A random one, that begins with contact on the rubber, or on the plate alone."""
    for _ in range(MOST):
        pulled = np.array([random.uniform(*ends) for ends in PULLED])
        model, table, d = pressing(rod, touched, pulled, random)
        first = np.array([*pulled, d])
        if not clear_of_clamp(rod, table, d):
            continue
        answer = model.evaluate(first)
        if not (answer.inside and FORCES[0] < answer.contact_force < FORCES[1]):
            continue
        if any(one.rubber for one in model.contact_forces(first)) == (touched != PLATE):
            break
    along = DRAGGED if touched == ROUND else NEARER
    change = np.array([*random.uniform(-CHANGED, CHANGED, 2), random.uniform(-along, along)])
    second = np.append(np.clip((first + change)[:-1], 0.0, None), first[-1] + change[-1])
    way = np.zeros(3)
    if touched != ROUND:
        normal = np.array(model.obstacle.numbers()["axis"])
        way = random.uniform(-ASIDE, ASIDE, 3)
        way -= (way @ normal) * normal
    points, moved = np.array([first, first, second, second]), np.array([0 * way, way, way, 0 * way])
    if touched == ROUND:
        points, moved = np.array([first, second, first]), np.zeros((3, 3))
    return History(model, table, points, moved, float(random.uniform(*FRICTION)))


def sliding(contacts: list[ContactForce]) -> float:
    """Share of the normal force at contacts that slide [-]; nan without contact."""
    pressed = np.array([one.force @ one.normal for one in contacts])
    slides = np.array([one.slides for one in contacts], bool)
    return float(pressed[slides].sum() / pressed.sum()) if len(contacts) else np.nan


def compared(rod: Rod, table: Table, touched: str, seeds: list[int]) -> list[dict[str, Any]]:
    """Histories of some seeds, of both models."""
    from fingerfem import FingerModel, LoadNotReached
    from fingerfem.friction_history import friction_history as full_order
    from fingerfem.scene.scene import Scene

    rows = []
    for seed in seeds:
        one = draw(rod, touched, np.random.default_rng([21, seed]))
        ours = friction_history(one.model, one.points, one.friction, one.moved, INCREMENTS)
        row: dict[str, Any] = {"status": next((one.status for one in ours if one.status != "converged"), "converged")}
        if row["status"] == "converged":
            scene = {key: value for key, value in table.items() if key != "load"}
            scene |= {"obstacle": one.table}
            try:
                full = FingerModel(Scene.model_validate(scene))
                theirs = full_order(full, one.points, one.friction, one.moved, INCREMENTS)
            except LoadNotReached:
                row["status"] = "full-order not converged"
        if row["status"] == "converged":
            largest = max(float(np.linalg.norm(one.force)) for one in theirs)
            pairs = list(zip(ours, theirs, strict=True))
            row["errors"] = [float(np.linalg.norm(one.force - other.force)) / largest for one, other in pairs]
            row["slides"] = [[sliding(one.contacts) > HALF, bool(1 - other.sticks > HALF)] for one, other in pairs]
        rows.append(row)
    return rows


def table_row(rows: list[dict[str, Any]], touched: str) -> dict[str, Any]:
    """Errors of forces over the largest of a history, and how often most of both slides, or of neither."""
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
    plan, count = plans.LARGE, 20
    rod, table = plans.rod(run, plan), tomllib.loads(plans.scene(run, plan).read_text())
    parts, found = [list(range(k, count, CORES)) for k in range(CORES)], []
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        for touched in (PLATE, RUBBER, ROUND):
            given = [rod] * CORES, [table] * CORES, [touched] * CORES, parts
            found.append(table_row([row for part in pool.map(compared, *given) for row in part], touched))
    return found

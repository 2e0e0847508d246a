"""Histories with friction of the assembled finger, against the full-order model with friction."""

from __future__ import annotations

import tomllib
from collections import Counter
from typing import Any, NamedTuple

import numpy as np

from rom import Rod, TouchedSegment, friction_history
from rom.error_statistics import quantiles
from rom.rod.touched_rod import ContactForce
from studies.cores import on_cores
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Table, rigid
from studies.rods.random_objects import DEPTHS, DISTANCE, anywhere, at_plate, clear_of_clamp

COUNT, INCREMENTS = 16, 4  # histories of every kind; increments between two points
PULLED, FORCES = ((15.0, 80.0), (0.0, 40.0)), (0.3, 6.0)  # tensions, and force without friction at first [N]
FRICTION, ASIDE, CHANGED = (0.2, 0.8), 1.5e-3, 8.0  # coefficients [-]; motions of the plane [m] and of tensions [N]
ALONG = {"plate": 2e-4, "rubber": 5e-4}  # part that is touched first; motion of the object along its direction [m]
SHAPES = {"plate": ("plane",), "rubber": ("sphere", "cylinder", "box")}
HALF = 0.5  # of the normal force [-]: a finger slides if more of it is at points that slide


class History(NamedTuple):
    """An obstacle, points (tensions, d), additional motions of the object [m], coefficient of friction [-]."""

    table: Table
    points: np.ndarray
    moved: np.ndarray
    friction: float


def first_contact(rod: Rod, touched: str, random: np.random.Generator) -> tuple[Table, np.ndarray]:
    """An obstacle, and tensions and d at which it presses on the plate alone, or on rubber too."""
    while True:
        pulled = np.array([random.uniform(*ends) for ends in PULLED])
        made = at_plate if touched == "plate" else anywhere
        table = made(rod, pulled, random, str(random.choice(SHAPES[touched])))
        point = np.append(pulled, DISTANCE - random.uniform(*DEPTHS))
        model = TouchedSegment(rod=rod, obstacle=rigid(table))
        answer, contacts = model.evaluate(point), model.contact_forces(point)
        is_pressed = answer.inside and FORCES[0] < answer.contact_force < FORCES[1]
        is_rubber = any(one.rubber for one in contacts)
        if is_pressed and is_rubber == (touched == "rubber") and clear_of_clamp(rod, table, point[-1]):
            return table, point


def draw(rod: Rod, touched: str, random: np.random.Generator) -> History:
    """A random history: a plane moves aside as the tensions change, a round object along its direction, and back."""
    table, first = first_contact(rod, touched, random)
    change = np.append(random.uniform(-CHANGED, CHANGED, 2), random.uniform(-ALONG[touched], ALONG[touched]))
    second = np.append(np.clip((first + change)[:-1], 0.0, None), (first + change)[-1])
    friction = float(random.uniform(*FRICTION))
    if touched == "rubber":
        return History(table, np.array([first, second, first]), np.zeros((3, 3)), friction)
    normal, aside = np.array(table["normal"]), random.uniform(-ASIDE, ASIDE, 3)
    aside -= (aside @ normal) * normal
    moved = np.array([0 * aside, aside, aside, 0 * aside])
    return History(table, np.array([first, first, second, second]), moved, friction)


def sliding(contacts: list[ContactForce]) -> float:
    """Share of the normal force at contacts that slide [-]; nan without contact."""
    pressed = np.array([one.force @ one.normal for one in contacts])
    slides = np.array([one.slides for one in contacts], bool)
    return float(pressed[slides].sum() / pressed.sum()) if len(contacts) else np.nan


def compared(rod: Rod, table: Table, touched: str, seed: int) -> dict[str, Any]:
    """One history of both models: its status, and the errors and decisions of every point."""
    from fingerfem import FingerModel, LoadNotReached
    from fingerfem.friction_history import friction_history as full_order
    from fingerfem.scene.scene import Scene

    one = draw(rod, touched, np.random.default_rng([21, seed]))
    model = TouchedSegment(rod=rod, obstacle=rigid(one.table))
    ours = friction_history(model, one.points, one.friction, one.moved, INCREMENTS)
    status = next((state.status for state in ours if state.status != "converged"), "converged")
    if status != "converged":
        return {"status": status}
    scene = {key: value for key, value in table.items() if key != "load"} | {"obstacle": one.table}
    try:
        full = FingerModel(Scene.model_validate(scene))
        theirs = full_order(full, one.points, one.friction, one.moved, INCREMENTS)
    except LoadNotReached:
        return {"status": "not_converged"}
    largest = max(float(np.linalg.norm(state.force)) for state in theirs)
    pairs = list(zip(ours, theirs, strict=True))
    return {
        "status": status,
        "errors": [float(np.linalg.norm(own.force - true.force)) / largest for own, true in pairs],
        "slides": [[sliding(own.contacts) > HALF, bool(1 - true.sticks > HALF)] for own, true in pairs],
    }


def kind(run: Run, touched: str) -> dict[str, Any]:
    """Errors of forces over the largest of a history, and the share of points where both slide or neither does."""
    rod, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    rows = on_cores(compared, [(rod, table, touched, seed) for seed in range(COUNT)])
    good = [row for row in rows if "errors" in row]
    decided = np.array([pair for row in good for pair in row["slides"]])
    statuses = Counter(row["status"] for row in rows)
    return {
        "touched": touched,
        "compared": len(good),
        "force": quantiles(np.concatenate([row["errors"] for row in good])),
        "alike": float(np.mean(decided[:, 0] == decided[:, 1])),
        **{name: statuses[name] for name in ("out_of_domain", "no_equilibrium", "not_converged")},
    }


def measure(run: Run) -> list[dict[str, Any]]:
    """Histories that begin on the plate, and on the rubber."""
    return [run.once(touched, kind, run, touched) for touched in ALONG]

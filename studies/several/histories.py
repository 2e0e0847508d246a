"""Histories with friction of the assembled finger, against the full-order model with friction."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import Any

import numpy as np

from rom import Rod, TouchedSegment, friction_history
from rom.error_statistics import quantiles
from rom.rod.touched_rod import ContactForce
from studies.cores import on_cores
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Table, rigid
from studies.rods.random_objects import DEPTHS, DISTANCE, anywhere, clear_of_clamp

COUNT, INCREMENTS = 16, 4  # histories of every kind; increments between two points
PULLED, FORCES = ((15.0, 80.0), (0.0, 40.0)), (0.3, 6.0)  # tensions, and force without friction at first [N]
FRICTION, ASIDE, CHANGED = (0.2, 0.8), 1.5e-3, 8.0  # coefficients [-]; motions of the plane [m] and of tensions [N]
NEARER, DRAGGED = 2e-4, 5e-4  # motion of a plane, and of a round object, along its direction [m]
PLATE, RUBBER, ROUND = "plate", "rubber", "rubber, by a ball, a cylinder or a box"  # what is touched first
HALF = 0.5  # of the normal force [-]: a finger slides if more of it is at points that slide


@dataclass(frozen=True)
class History:
    """An obstacle, points (tensions, d), additional motions of the object [m], coefficient of friction [-]."""

    table: Table
    points: np.ndarray
    moved: np.ndarray
    friction: float


def pressing(rod: Rod, touched: str, pulled: np.ndarray, random: np.random.Generator) -> tuple[Table, float]:
    """The paper's plane, or an obstacle that touches the finger anywhere; d at which it presses [m]."""
    if touched != PLATE:
        shape = "plane" if touched == RUBBER else str(random.choice(["sphere", "cylinder", "box"]))
        return anywhere(rod, pulled, random, shape), DISTANCE - random.uniform(*DEPTHS)
    table: Table = {"shape": "plane", "centre": [0.0, rod.half_lengths[1], 0.0], "normal": [0.0, -1.0, 0.0]}
    table |= {"direction": [0.0, 1.0, 0.0], "distance": [1e-4, rod.rest[0]], "method": "penalty"}
    touch = TouchedSegment(rod=rod, obstacle=rigid(table)).outputs(np.array([[*pulled, np.inf]]))[0, 4]
    return table, float(touch) - random.uniform(*DEPTHS)


def first_contact(rod: Rod, touched: str, random: np.random.Generator) -> tuple[Table, np.ndarray]:
    """An obstacle, and tensions and d at which it presses on the plate alone, or on rubber too."""
    while True:
        pulled = np.array([random.uniform(*ends) for ends in PULLED])
        table, d = pressing(rod, touched, pulled, random)
        if not clear_of_clamp(rod, table, d):
            continue
        model, point = TouchedSegment(rod=rod, obstacle=rigid(table)), np.array([*pulled, d])
        answer = model.evaluate(point)
        if not (answer.inside and FORCES[0] < answer.contact_force < FORCES[1]):
            continue
        if any(one.rubber for one in model.contact_forces(point)) == (touched != PLATE):
            return table, point


def draw(rod: Rod, touched: str, random: np.random.Generator) -> History:
    """A random history.

    A plane presses, is dragged, the finger is pulled, and the plane is dragged back. A round object moves along its
    direction alone, which is oblique to the surface, there and back.
    """
    table, first = first_contact(rod, touched, random)
    along = DRAGGED if touched == ROUND else NEARER
    change = np.array([*random.uniform(-CHANGED, CHANGED, 2), random.uniform(-along, along)])
    second = np.append(np.clip((first + change)[:-1], 0.0, None), first[-1] + change[-1])
    friction = float(random.uniform(*FRICTION))
    if touched == ROUND:
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


def table_row(rows: list[dict[str, Any]], touched: str) -> dict[str, Any]:
    """Errors of forces over the largest of a history, and how often both slide or neither does."""
    good = [row for row in rows if "errors" in row]
    decided = np.array([pair for row in good for pair in row["slides"]])
    return {
        "touched": touched,
        "compared": len(good),
        "force": quantiles(np.concatenate([row["errors"] for row in good])),
        "alike": float(np.mean(decided[:, 0] == decided[:, 1])),
        **{
            name: sum(row["status"] == name for row in rows)
            for name in ("out_of_domain", "no_equilibrium", "not_converged")
        },
    }


def kind(run: Run, touched: str) -> dict[str, Any]:
    """All histories of a kind."""
    rod, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    return table_row(on_cores(compared, [(rod, table, touched, seed) for seed in range(COUNT)]), touched)


def measure(run: Run) -> list[dict[str, Any]]:
    """Histories that begin on the plate, and on the rubber."""
    return [run.once(touched, kind, run, touched) for touched in (PLATE, RUBBER, ROUND)]

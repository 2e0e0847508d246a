"""Full-order states of a finger that random objects press: tensions, shortenings and contact forces, without noise."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import Any

import numpy as np

from control.feel.felt import NORMAL_95
from rom import Rod, TouchedSegment
from studies.cores import on_cores
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Pressed, Table, rigid
from studies.rods.random_objects import DEPTHS, DISTANCE, SHAPES, on_surface

PLAN = plans.LARGE  # the finger's set
EACH, SEED = 10, 21  # states by shape; of the draws
FORCES = 0.1, 15.0  # least and largest contact force that is compared [N]
AROUND = DEPTHS[1] + 2e-3, 2e-3  # extent of the range of distances below and above first touch [m]
SAMPLES = 12  # cross-sections, from the nearest of which the position of a contact is measured


@dataclass(frozen=True, kw_only=True)
class Case:
    """A full-order state: the object at d [m], contact force along its direction [N], shortenings [m]."""

    tensions: list[float]
    object: Table
    d: float
    contact_force: float
    shortenings: list[float]


def before(finger: Rod, table: Table) -> TouchedSegment:
    """The finger before an object whose distance is known within some millimetres."""
    near, far = AROUND
    return TouchedSegment(rod=finger, obstacle=rigid(table | {"distance": (DISTANCE - near, DISTANCE + far)}))


def solved(scene: Table, drawn: Pressed) -> tuple[float, list[float]] | None:
    """Contact force [N] and shortenings [m]; None if the full-order model finds no state that it stands by."""
    from fingerfem import FingerModel
    from fingerfem.equilibrium.failures import LoadNotReached
    from fingerfem.scene.scene import Scene

    table = {key: value for key, value in scene.items() if key != "load"} | {"obstacle": drawn.objects[0]}
    try:
        state = FingerModel(Scene.model_validate(table)).solve(drawn.tensions, drawn.d, sensitivities=False)
    except LoadNotReached:
        return None
    assert state.contact_force is not None
    return None if state.marks else (state.contact_force, list(state.channel_shortening.values()))


def states(run: Run) -> list[dict[str, Any]]:
    """Cases of every shape."""
    plans.rod(run, PLAN)  # trained before two processes ask for it
    return on_cores(of_shape, [(run, shape) for shape in SHAPES])


def of_shape(run: Run, shape: str) -> dict[str, Any]:
    """Cases of a shape, and counts of draws that are not compared."""
    finger, scene = plans.rod(run, PLAN), tomllib.loads(plans.scene(run, PLAN).read_text())
    random = np.random.default_rng((SEED, SHAPES.index(shape)))
    cases: list[dict] = []
    counts = {"marked": 0, "force": 0, "failed": 0}
    while len(cases) < EACH:
        drawn = on_surface(finger, random, shape)
        if drawn is None:
            continue
        answer = before(finger, drawn.objects[0]).evaluate([*drawn.tensions, drawn.d])
        if not answer.inside:
            counts["marked"] += 1
            continue
        if not FORCES[0] <= answer.contact_force <= FORCES[1]:
            counts["force"] += 1
            continue
        found = solved(scene, drawn)
        if found is None:
            counts["failed"] += 1
            continue
        force, shorter = found
        case = Case(
            tensions=drawn.tensions.tolist(),
            object=drawn.objects[0],
            d=drawn.d,
            contact_force=force,
            shortenings=shorter,
        )
        cases.append(vars(case))
    return {"cases": cases, **counts}


def error_of(finger: Rod, case: Case) -> float:
    """The largest error of the reduced model's shortenings, over its estimated standard deviation [-]."""
    answer = before(finger, case.object).evaluate([*case.tensions, case.d])
    off = np.abs(np.asarray(answer.shortenings) - case.shortenings).max()
    return float(off / (answer.shortening_error / NORMAL_95))


def resultant(finger: Rod, case: Case) -> tuple[float, np.ndarray]:
    """Position along the axis at rest [m] and components along y and z there, shape (2,) [N], of the contact force.

    Both are those of the reduced model at the same d; the size is the full-order model's.
    """
    model, point = before(finger, case.object), [*case.tensions, case.d]
    touches = model.contact_forces(point)
    forces = np.array([one.force for one in touches])
    weights = np.linalg.norm(forces, axis=1)
    place = weights @ np.array([one.place for one in touches]) / weights.sum()
    at = np.linspace(0.0, finger.rest[0] + finger.half_lengths[0], SAMPLES)
    sections = model.sections(point, at)
    ahead = np.einsum("nk,nk->n", place - sections.centres, sections.rotations[:, :, 0])
    near = int(np.argmin(np.linalg.norm(place - sections.centres, axis=1) + np.abs(ahead)))
    size = case.contact_force / float(model.evaluate(point).contact_force)
    return float(np.clip(at[near] + ahead[near], at[0], at[-1])), size * (
        forces.sum(axis=0) @ sections.rotations[near]
    )[1:]

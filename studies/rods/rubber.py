"""Contact anywhere on a finger, rubber included, against the full-order model of the elements' own mesh."""

from __future__ import annotations

import os
import tomllib
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from rom import Cylinder, Plane, Rod, Sphere, TouchedSegment
from rom.error_statistics import quantiles
from rom.rod.objects.shapes import Object
from studies.rods import plans
from studies.rods.full_order import FullOrder, Table, obstacle, random_box
from studies.rods.objects import CORES, FELT
from studies.rods.scattered_objects import DISTANCE, SHAPES, tensions
from studies.runner import Run

DEPTHS, RADII = (2e-4, 4e-3), (3e-3, 3e-2)  # beyond touch; of round objects [m]
TILT, EDGE = np.radians(40), 0.8  # of an object against the surface; of half the side: beyond, an edge's neighbourhood
MOST = 10.0  # forces that are compared [N]
AWAY, CLEAR = 0.15, 1e-3  # [m]; the latter of the clamp from planes, at least


def anywhere(finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str) -> tuple[Object, Table]:
    """An object that touches the free finger where d is DISTANCE, at a random place from a fifth of its length on."""
    half, angle = finger.half_lengths[1], random.uniform(0, 2 * np.pi)
    ray = np.array([np.cos(angle), np.sin(angle)])
    across = ray * half / np.abs(ray).max()
    outward = np.where(np.abs(across) > EDGE * half, np.sign(across), 0.0)  # of a face, or between two
    section = finger.sections(pulled, at=[random.uniform(0.2, 1.0) * finger.rest[0]])
    place = section.centres[0] + section.rotations[0] @ [0.0, *across]
    outward = section.rotations[0] @ [0.0, *outward / np.linalg.norm(outward)]
    aside = np.cross(outward, random.standard_normal(3))
    tilt = random.uniform(0, TILT)
    away = np.cos(tilt) * outward + np.sin(tilt) * aside / np.linalg.norm(aside)
    radius = float(np.exp(random.uniform(*np.log(RADII))))
    axis, state = np.cross(away, random.standard_normal(3)), random.bit_generator.state

    def made(shift: float, distances: tuple[float, float]) -> tuple[Object, Table | None]:
        where: Table = {"direction": tuple(away), "distances": distances}
        point = place + shift * away
        if shape == "plane":
            return Plane(centre=tuple(point), normal=tuple(-away), **where), None
        if shape == "sphere":
            return Sphere(centre=tuple(point + radius * away), radius=radius, **where), None
        if shape == "cylinder":
            return Cylinder(centre=tuple(point + radius * away), radius=radius, axis=tuple(axis), **where), None
        random.bit_generator.state = state
        return random_box(random, tuple(point), where)

    found, _ = made(0.0, (-1.0, 1.0))
    touch = float(TouchedSegment(rod=finger, obstacle=found).outputs(np.array([[*pulled, 1.0]]))[0, 4])
    found, own = made(touch - DISTANCE, (0.0, AWAY))
    return found, obstacle(found, own)


def clear_of_clamp(model: TouchedSegment, d: float) -> bool:
    """Whether the object is no plane that presses on the clamp too."""
    if not isinstance(model.obstacle, Plane):
        return True
    half = model.rod.half_lengths[1]
    clamp = np.array([[0.0, y, z] for y in (-half, half) for z in (-half, half)])
    return bool(((clamp - model.obstacle.centre - d * model.direction) @ model.obstacle.normal).min() > CLEAR)


def compared(run: Run, plan: plans.Plan, shape: str, count: int) -> dict:
    """Random objects of one shape."""
    finger, random = plans.rod(run, plan), np.random.default_rng(21)
    full = FullOrder(tomllib.loads(plans.scene(run, plan).read_text()))
    rows: list[tuple[float, float, float]] = []
    counts = dict.fromkeys(("no answer", "marked", "weak", "failed"), 0)
    while len(rows) < count:
        pulled = tensions(finger, random)
        found, table = anywhere(finger, pulled, random, shape)
        model = TouchedSegment(rod=finger, obstacle=found)
        point = np.array([*pulled, DISTANCE - float(np.exp(random.uniform(*np.log(DEPTHS))))])
        if not clear_of_clamp(model, float(point[-1])):
            continue
        answers = model.answers(point)
        force = float(answers.out[0, 3])
        if answers.evaluations[0] < 0:
            counts["no answer"] += 1
        elif not answers.inside[0] or force > MOST:
            counts["marked"] += 1
        elif not any(one.rubber for one in model.contact_forces(point)) or force < FELT:
            counts["weak"] += 1
        else:
            found_forces = full.approached(table, pulled, float(point[-1]))
            if found_forces is None:
                counts["failed"] += 1
                continue
            true = float(found_forces[0])
            expected = float(model.evaluate(point).error["contact_force"])
            rows.append((abs(force - true), expected, true))
    off, expected, true = np.array(rows).T
    return {
        "shape": shape,
        **counts,
        "error": quantiles(off / true),
        "covered": float((off <= expected).mean()),
        "ratio": float(np.median(expected) / np.median(off)),
    }


def measure(run: Run) -> list[dict]:
    """Every shape, a shape a process, each on one core."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    plan, count = (plans.QUICK, 2) if run.quick else (plans.LARGE, 10)
    plans.rod(run, plan)
    with ProcessPoolExecutor(CORES, mp_context=get_context("spawn")) as pool:
        return [one.result() for one in [pool.submit(compared, run, plan, shape, count) for shape in SHAPES]]

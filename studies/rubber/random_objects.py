"""Contact anywhere on a finger, rubber included, against the full-order model of the elements' own mesh."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np

from rom import Cylinder, Plane, Rod, Sphere, TouchedSegment
from rom.rod.objects.shapes import RigidObject
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Table, obstacle, random_box
from studies.rods.scattered_objects import DISTANCE, SHAPES, tensions
from studies.rubber.pressed_objects import Pressed, by_core, summary

DEPTHS, RADII = (2e-4, 4e-3), (3e-3, 3e-2)  # beyond touch; of round objects [m]
TILT, EDGE = np.radians(40), 0.8  # of an object against the surface; of half the side: beyond, an edge's neighbourhood
MOST = 10.0  # forces that are compared [N]
AWAY, CLEAR = 0.15, 1e-3  # [m]; the latter of the clamp from planes, at least


def anywhere(finger: Rod, pulled: np.ndarray, random: np.random.Generator, shape: str) -> tuple[RigidObject, Table]:
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

    def made(shift: float, distances: tuple[float, float]) -> tuple[RigidObject, Table | None]:
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


def clear_of_clamp(finger: Rod, table: Table, d: float) -> bool:
    """Whether an object, as the table of a scene, at d [m] is away from where the finger is clamped."""
    from fingerfem.mechanics.obstacles import NUMPY, bodies
    from fingerfem.scene.obstacle import Obstacle

    half, along = finger.half_lengths[1], np.linspace(-1.0, 1.0, 21)
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]])
    outline = [((1 - s) * one + (1 + s) * two) / 2 for one, two in pairwise(corners) for s in along]
    y, z = half * np.array(outline).T
    (body,) = bodies(Obstacle.model_validate(table), 2 * half)
    return bool(body.signed_distance((0 * y, y, z), d, NUMPY).min() > CLEAR)


def pressed(finger: Rod, random: np.random.Generator, shape: str) -> Pressed | None:
    """One object of a shape, pressed in by a random depth."""
    pulled = tensions(finger, random)
    found, table = anywhere(finger, pulled, random, shape)
    d = DISTANCE - float(np.exp(random.uniform(*np.log(DEPTHS))))
    if not clear_of_clamp(finger, table, d):
        return None
    return Pressed(pulled, [(found, table)], d)


def by_shape(run: Run, plan: plans.Plan, count: int) -> list[dict]:
    """Every shape, a shape a process."""
    calls = [(partial(pressed, shape=shape), [21], count, MOST, True) for shape in SHAPES]
    found = zip(SHAPES, by_core(run, plan, calls), strict=True)
    return [{"shape": shape, **summary([one])} for shape, one in found]


def measure(run: Run) -> list[dict]:
    """On the elements' own mesh."""
    plan = plans.LARGE
    return list(run.once(plan.name, by_shape, run, plan, 10))

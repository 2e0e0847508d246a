"""Two objects at once, and cylinders that a finger wraps, against the full-order model of the elements' own mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rom import Cylinder, Rod
from rom.rod.objects.shapes import RigidObject
from studies.parts import Run
from studies.rods import plans
from studies.rods.full_order import Table, obstacle
from studies.rods.scattered_objects import DISTANCE, SHAPES, tensions
from studies.rubber.pressed_objects import Pressed, by_core, summary
from studies.rubber.random_objects import DEPTHS, MOST, anywhere, clear_of_clamp

RADII, PLACES, CLEARANCE = (0.006, 0.020), (0.2, 0.7), 1.5e-3  # [m]; of the finger's length [-]; at rest, at most [m]
PULLED = ((30.0, 100.0), (0.0, 20.0))  # towards the cylinder, and across [N]
LEANS, ASIDE = 0.2, 2e-3  # of an axis, its part along the finger [-]; of its centre [m]


def advanced(found: RigidObject, table: Table, depth: float) -> tuple[RigidObject, Table]:
    """An object that is nearer by a depth [m] at every d, and its table."""
    way = depth * np.array(found.numbers()["direction"])
    moved = replace(found, centre=tuple((np.array(found.centre) - way).tolist()))
    return moved, table | {"centre": list(moved.centre)}


def pair(finger: Rod, random: np.random.Generator) -> Pressed | None:
    """Two objects, each of a random shape at a random place, pressed in by its own depth."""
    pulled, both = tensions(finger, random), []
    for shape in random.choice(SHAPES, 2):
        found, table = anywhere(finger, pulled, random, str(shape))
        both.append(advanced(found, table, float(np.exp(random.uniform(*np.log(DEPTHS))))))
    clear = [clear_of_clamp(finger, table, DISTANCE) for _, table in both]
    return Pressed(pulled, both, DISTANCE) if all(clear) else None


def wrapped(finger: Rod, random: np.random.Generator) -> Pressed:
    """A cylinder beside the straight finger, which is pulled around it."""
    radius, place = random.uniform(*RADII), random.uniform(*PLACES) * finger.rest[0]
    height = finger.half_lengths[1] + radius + random.uniform(0, CLEARANCE)
    found = Cylinder(
        centre=(float(place), float(height), float(random.uniform(-ASIDE, ASIDE))),
        direction=(0.0, 1.0, 0.0),
        radius=float(radius),
        axis=(float(random.uniform(-LEANS, LEANS)), 0.0, 1.0),
        distances=(0.0, 0.2),
    )
    pulled = np.array([random.uniform(*one) for one in PULLED])
    return Pressed(pulled, [(found, obstacle(found) | {"distance": [0.0, 0.2]})], 0.0, stands=True)


def measure(run: Run) -> dict:
    """Both, each in two halves."""
    plan, count = plans.LARGE, 15
    pairs = by_core(run, plan, [(pair, [31, k], count, MOST) for k in range(2)])
    around = by_core(run, plan, [(wrapped, [41, k], 20) for k in range(2)])
    return {"pairs": summary(pairs), "wrapped": summary(around)}

"""Two objects at once, and cylinders that a finger wraps, against the full-order model of the elements' own mesh."""

from __future__ import annotations

import tomllib

import numpy as np

from rom import Rod
from studies.cores import on_cores
from studies.parts import Run
from studies.rods import plans
from studies.rods.compared import Question, compared, summary
from studies.rods.full_order import Pressed
from studies.rods.random_objects import DEPTHS, DISTANCE, SHAPES, anywhere, clear_of_clamp, logarithmic, tensions

MOST = 10.0  # largest force of a pair that is compared [N]
RADII, PLACES, CLEARANCE = (0.006, 0.020), (0.2, 0.7), 1.5e-3  # [m]; of the finger's length [-]; at rest, at most [m]
PULLED = ((30.0, 100.0), (0.0, 20.0))  # towards the cylinder, and across [N]
LEANS, ASIDE = 0.2, 2e-3  # component of an axis along the finger [-]; offset of its centre [m]


def pair(finger: Rod, random: np.random.Generator) -> Pressed | None:
    """Two objects, each of a random shape at a random place, which advance by depths of their own."""
    pulled, both = tensions(finger, random), []
    for shape in random.choice(SHAPES, 2):
        table = anywhere(finger, pulled, random, str(shape))
        advance = logarithmic(random, DEPTHS) * np.array(table["direction"])
        both.append(table | {"centre": (np.array(table["centre"]) - advance).tolist()})
    clear = all(clear_of_clamp(finger, table, DISTANCE) for table in both)
    return Pressed(pulled, both, DISTANCE) if clear else None


def wrapped(finger: Rod, random: np.random.Generator) -> Pressed:
    """A cylinder beside the straight finger, which is pulled around it."""
    radius, place = random.uniform(*RADII), random.uniform(*PLACES) * finger.rest[0]
    height = finger.half_lengths[1] + radius + random.uniform(0, CLEARANCE)
    table = {
        "shape": "cylinder",
        "centre": [float(place), float(height), float(random.uniform(-ASIDE, ASIDE))],
        "direction": [0.0, 1.0, 0.0],
        "radius": float(radius),
        "axis": [float(random.uniform(-LEANS, LEANS)), 0.0, 1.0],
        "distance": [0.0, 0.2],
        "method": "penalty",
    }
    return Pressed(np.array([random.uniform(*one) for one in PULLED]), [table], 0.0, "pull")


def measure(run: Run) -> dict:
    """Both, each in two halves."""
    finger, table = plans.rod(run, plans.LARGE), tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    pairs = [Question(draw=pair, seed=(31, k), count=10, most=MOST) for k in range(2)]
    around = [Question(draw=wrapped, seed=(41, k), count=15) for k in range(2)]
    found = on_cores(compared, [(finger, table, one) for one in (*pairs, *around)])
    return {"pairs": summary(found[:2]), "wrapped": summary(found[2:])}

"""Contact of an assembled finger against the full-order model: random objects at its plate."""

from __future__ import annotations

import tomllib
from functools import partial

from rom import Rod
from studies.parts import Run
from studies.rods import plans
from studies.rods.compared import Question, by_name, compared, summary
from studies.rods.full_order import Table
from studies.rods.random_objects import on_plate

COUNTS = {"plane": 60, "sphere": 30, "cylinder": 30, "box": 30}


def asked(shape: str, count: int, most: float) -> Question:
    """Objects of a shape that press on the plate alone, by at most a force [N]."""
    return Question(draw=partial(on_plate, shape=shape), seed=(9,), count=count, most=most, surface="plate")


def scattered(finger: Rod, table: Table, shape: str, count: int) -> dict:
    """Random objects of one shape, against the full-order model of a scene with a load."""
    return summary([compared(finger, table, asked(shape, count, table["load"]["force"]))])


def by_shape(run: Run, plan: plans.Plan) -> list[dict]:
    """Random objects of every shape."""
    questions = {shape: asked(shape, count, plan.force) for shape, count in COUNTS.items()}
    return by_name(plans.rod(run, plan), tomllib.loads(plans.scene(run, plan).read_text()), questions)


def measure(run: Run) -> list[dict]:
    """A row a shape."""
    return list(run.once("random objects", by_shape, run, plans.SMALL))

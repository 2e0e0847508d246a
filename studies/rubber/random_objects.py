"""Random objects on the rubber of the bundled finger, against a full-order model of order 2."""

from __future__ import annotations

from functools import partial

from studies.parts import Run
from studies.rods import plans
from studies.rods.compared import Question, by_name
from studies.rods.random_objects import SHAPES, on_surface

MESH = {"cells": [20, 5], "order": 2}  # the training's, of 24 x 6 cells, takes an hour
COUNT, MOST = 4, 10.0  # of objects of every shape; largest force that is compared [N]


def by_shape() -> list[dict]:
    """Objects of every shape."""
    questions = {
        shape: Question(draw=partial(on_surface, shape=shape), seed=(21,), count=COUNT, most=MOST, surface="rubber")
        for shape in SHAPES
    }
    finger, table = plans.bundled()
    return by_name(finger, table | {"mesh": MESH}, questions)


def measure(run: Run) -> list[dict]:
    """A row a shape."""
    return list(run.once("shapes", by_shape))

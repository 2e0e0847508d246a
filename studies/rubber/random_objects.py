"""Random objects on the rubber of the bundled finger, against the full-order model of its training's mesh."""

from __future__ import annotations

from functools import partial

from studies.parts import Run
from studies.rods import plans
from studies.rods.compared import Question, by_name
from studies.rods.random_objects import SHAPES, on_surface

COUNT, MOST = 6, 10.0  # of objects of every shape; largest force that is compared [N]


def by_shape() -> list[dict]:
    """Objects of every shape."""
    questions = {
        shape: Question(draw=partial(on_surface, shape=shape), seed=(21,), count=COUNT, most=MOST, surface="rubber")
        for shape in SHAPES
    }
    return by_name(*plans.bundled(), questions)


def measure(run: Run) -> list[dict]:
    """A row a shape."""
    return list(run.once("shapes", by_shape))

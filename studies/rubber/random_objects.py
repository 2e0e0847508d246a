"""Random objects on the rubber, against the full-order model of the elements' own mesh."""

from __future__ import annotations

import tomllib
from functools import partial

from studies.parts import Run
from studies.rods import plans
from studies.rods.compared import Question, by_name
from studies.rods.random_objects import SHAPES, on_surface

COUNT, MOST = 10, 10.0  # of objects of every shape; largest force that is compared [N]


def by_shape(run: Run) -> list[dict]:
    """Objects of every shape."""
    questions = {
        shape: Question(draw=partial(on_surface, shape=shape), seed=(21,), count=COUNT, most=MOST, surface="rubber")
        for shape in SHAPES
    }
    table = tomllib.loads(plans.scene(run, plans.LARGE).read_text())
    return by_name(plans.rod(run, plans.LARGE), table, questions)


def measure(run: Run) -> list[dict]:
    """A row a shape."""
    return list(run.once("shapes", by_shape, run))

"""Part `ours`: the bundled finger and a table of it, asked the same, one state at a time, as a controller asks."""

from __future__ import annotations

import numpy as np

from rom import SeparatedModel, TouchedSegment, specialise
from studies.control.models import DISTANCES, finger
from studies.parts import Run
from studies.peers.question import Ask, answers

REPEATS = 150  # of the whole question
NODES = 16  # of every axis of the table
LIMITS = "quasi-static, within the trained tensions and distances; it marks answers outside"


def evaluating(model: TouchedSegment | SeparatedModel) -> Ask:
    """A function that evaluates the model with F1 alone; free states have the plane at its farthest."""

    def ask(tension: float, distance: float | None) -> tuple[list[float], float]:
        answer = model.evaluate(np.array([tension, 0.0, DISTANCES[1] if distance is None else distance]))
        assert np.all(answer.inside), "a state of the question is outside the trained domain"
        return np.ravel(answer.tip).tolist(), float(np.ravel(answer.contact_force)[0])

    return ask


def measure(run: Run) -> list[dict]:
    """Both, with their settings."""
    rod = finger()
    settings = {"rod": "rom/finger.h5", "table": f"table of rom/finger.h5, {NODES} nodes of every axis"}
    return [
        answers(
            ask, "reduced model", REPEATS, name=f"fingerfem, {name}", settings=settings[name], limits=LIMITS
        ).as_json()
        for name, ask in (("rod", evaluating(rod)), ("table", evaluating(specialise(rod, NODES))))
    ]

"""Part `ours`: the bundled finger and a table of it, asked the same; the time of a query in Python."""

from __future__ import annotations

import time

import numpy as np

from rom import SeparatedModel, TouchedSegment, specialise
from studies.control.models import DISTANCES, finger
from studies.parts import Run
from studies.peers.question import CONTACT, FREE, Answers

CALLS = 2000  # that are timed
NODES = 16  # of every axis of the table
# Tensions of F1 and F2 [N], and distances [m]; FREE has no contact at the farthest.
POINTS = np.array(
    [[tension, 0.0, distance] for tension, distance in (*((one, DISTANCES[1]) for one in FREE), *CONTACT)]
)


def answers(name: str, model: TouchedSegment | SeparatedModel, settings: str) -> Answers:
    """One point at a time, as a controller asks."""
    found = model.evaluate(POINTS)
    assert np.all(found.inside), "a state of the question is outside the trained domain"
    begun = time.process_time()
    for call in range(CALLS):
        model.evaluate(POINTS[call % len(POINTS)])
    return Answers(
        name=name,
        kind="reduced model",
        free_tips=found.tip[: len(FREE)].tolist(),
        contact_tips=found.tip[len(FREE) :].tolist(),
        contact_forces=np.ravel(found.contact_force)[len(FREE) :].tolist(),
        seconds=(time.process_time() - begun) / CALLS,
        settings=settings,
        limits="quasi-static, within the trained tensions and distances; it marks answers outside",
    )


def measure(run: Run) -> list[dict]:
    """Both, with their settings."""
    rod = finger()
    table = specialise(rod, NODES)
    found = (
        answers("fingerfem, rod", rod, "rom/finger.h5"),
        answers("fingerfem, table", table, f"table of rom/finger.h5, {NODES} nodes of every axis"),
    )
    return [one.as_json() for one in found]

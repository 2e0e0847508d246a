"""Part `ours`: the two bundled models, asked the same; what a query costs in Python."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from rom import Surrogate, TouchedSegment
from studies.peers.question import CONTACT, FREE, Answers
from studies.runner import ROOT, Run

CALLS = 2000  # that are timed
ASIDE = 0.0  # tension of F2, which both models also have [N]
AFAR = 0.031  # where no state of FREE is touched [m]


def answers(name: str, ask: Callable[[np.ndarray], Any], size: int, settings: str) -> Answers:
    """One point at a time, as a controller asks."""
    points = [np.array([tension, ASIDE, AFAR]) for tension in FREE]
    points += [np.array([tension, ASIDE, distance]) for tension, distance in CONTACT]
    said = [ask(point) for point in points]
    assert all(np.all(answer.inside) for answer in said), "a state of the question is outside what was trained"
    begun = time.process_time()
    for call in range(CALLS):
        ask(points[call % len(points)])
    seconds = (time.process_time() - begun) / CALLS
    tips = [np.ravel(answer.tip).tolist() for answer in said]
    return Answers(
        name=name,
        kind="surrogate",
        free_tips=tips[: len(FREE)],
        contact_tips=tips[len(FREE) :],
        contact_forces=[float(np.ravel(answer.contact_force)[0]) for answer in said[len(FREE) :]],
        seconds=seconds,
        settings=f"{settings}, {size / 1000:.0f} kB",
        limits="quasi-static, within the tensions and distances it was trained for, and says where it is not",
    )


def measure(run: Run) -> list[dict]:
    """The surrogate of one plane, and the rod of elements with contact solved for at every query."""
    plane, finger = Surrogate.load(ROOT / "rom" / "plane.h5"), TouchedSegment.load()
    sizes = [(ROOT / "rom" / file).stat().st_size for file in ("plane.h5", "finger.h5")]
    return [
        answers("fingerfem, surrogate", plane.evaluate, sizes[0], "rom/plane.h5").as_json(),
        answers("fingerfem, rod", finger.evaluate, sizes[1], "rom/finger.h5").as_json(),
    ]

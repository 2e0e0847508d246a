"""Part `ours`: the bundled finger and a table of it, asked the same; what a query costs in Python."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from rom import SeparatedModel, TouchedSegment, specialise
from studies.control.models import finger
from studies.parts import Run
from studies.peers.question import CONTACT, FREE, Answers

CALLS = 2000  # that are timed
ASIDE = 0.0  # tension of F2, which both also have [N]
NODES = 16  # of every axis of the table
ROD, TABLE = "fingerfem, rod", "fingerfem, table"
AFAR = 0.031  # where no state of FREE is touched [m]


def answers(name: str, ask: Callable[[np.ndarray], Any], settings: str) -> Answers:
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
        kind="reduced model",
        free_tips=tips[: len(FREE)],
        contact_tips=tips[len(FREE) :],
        contact_forces=[float(np.ravel(answer.contact_force)[0]) for answer in said[len(FREE) :]],
        seconds=seconds,
        settings=settings,
        limits="quasi-static, within the tensions and distances it was trained for, and says where it is not",
    )


def within(model: TouchedSegment | SeparatedModel, reference: dict[str, Any]) -> dict[str, Any]:
    """How many errors of contact states are within a model's estimates, and how large these are."""
    found = [model.evaluate(np.array([tension, ASIDE, distance])) for tension, distance in CONTACT]
    tips, forces = np.array(reference["contact_tips"]), np.array(reference["contact_forces"])
    estimated = np.array([float(np.ravel(answer.error["contact_force"])[0]) for answer in found])
    off = [abs(float(np.ravel(answer.contact_force)[0]) - force) for answer, force in zip(found, forces, strict=True)]
    away = [np.linalg.norm(np.ravel(answer.tip) - tip) for answer, tip in zip(found, tips, strict=True)]
    return {
        "forces": int(np.sum(off <= estimated)),
        "tips": int(sum(far <= answer.error["tip"] for far, answer in zip(away, found, strict=True))),
        "median": float(np.median(estimated / forces)),
        "max": float(np.max(estimated / forces)),
    }


def trained() -> dict[str, TouchedSegment | SeparatedModel]:
    """The finger of rod elements, with contact solved for at every query, and its table before the paper's plane."""
    rod = finger()
    return {ROD: rod, TABLE: specialise(rod, NODES)}


def measure(run: Run) -> list[dict]:
    """Both, with their settings."""
    words = {TABLE: f"table of rom/finger.h5, {NODES} nodes of every axis", ROD: "rom/finger.h5"}
    return [answers(name, model.evaluate, words[name]).as_json() for name, model in trained().items()]

"""How far answers are from the reference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

QUANTITIES = "free_tips", "contact_tips", "contact_forces"
POWERS = -5.0, 9.0  # of the number of nodes, between which a rate of convergence is looked for [-]


def errors(answers: dict[str, Any], reference: dict[str, Any]) -> dict[str, Any]:
    """Median and largest relative errors of one alternative [-], and in how many states it has no answer.

    Tips over the way of the reference's tip, contact forces over the reference's; states without an answer are left out
    of the numbers and counted as missing. A quantity that an alternative never answers is None and misses nothing: it
    is not of its kind, as the contact force of a grid of free states.
    """
    found: dict[str, Any] = {}
    missing = 0
    for quantity in QUANTITIES:
        told, truth = answers[quantity], reference[quantity]
        off = [relative(one, true) for one, true in zip(told, truth, strict=True) if one is not None]
        missing += len(truth) - len(off) if off else 0
        found[quantity] = {"median": float(np.median(off)), "max": max(off)} if off else None
    return found | {"missing": missing}


def relative(told: float | Sequence[float], truth: float | Sequence[float]) -> float:
    """Distance over the true one's length [-]."""
    return float(np.linalg.norm(np.subtract(told, truth)) / np.linalg.norm(truth))


def compared(every: list[dict[str, Any]], reference: dict[str, Any]) -> list[dict[str, Any]]:
    """Every alternative with its errors and its time as a multiple of the fastest one's."""
    fastest = min(row["seconds"] for row in every)
    return [row | {"errors": errors(row, reference), "times": row["seconds"] / fastest} for row in every]


def nodes(mesh: dict[str, Any]) -> int:
    """About how many a mesh has: cells along and across its refinement names, and their order."""
    along, across = (count * mesh["order"] for count in mesh["cells"])
    return int(along * across**2)


def apart(one: dict[str, Any], other: dict[str, Any]) -> dict[str, float]:
    """Largest relative differences of two meshes' tips and contact forces [-]."""
    found = errors(one, other)
    tips = max(found[quantity]["max"] for quantity in ("free_tips", "contact_tips"))
    return {"tip": tips, "contact_force": found["contact_forces"]["max"]}


def orders(meshes: list[dict[str, Any]]) -> dict[str, float]:
    """The power of the cells' size with which answers of three meshes converge, median of the states [-].

    Cells shrink as the number of nodes to the power -1/3: with errors c n^-q the order is 3 q.
    """
    sizes = [float(nodes(mesh["refinement"][0])) for mesh in meshes]
    found = {}
    for quantity in QUANTITIES:
        coarse, finer, finest = (np.array([np.ravel(one) for one in mesh[quantity]]) for mesh in meshes)
        shares = np.linalg.norm(finer - finest, axis=1) / np.linalg.norm(coarse - finest, axis=1)
        found[quantity] = 3 * float(brentq(lambda q, share: _left(sizes, q) - share, *POWERS, np.median(shares)))
    return found


def rest(finer: dict[str, Any], finest: dict[str, Any], order: float) -> dict[str, float]:
    """What the finest mesh errs by itself, at most, extrapolated from how far the finer one differs from it [-]."""
    share = (nodes(finer["refinement"][0]) / nodes(finest["refinement"][0])) ** (order / 3)
    return {quantity: share / (1 - share) * difference for quantity, difference in apart(finer, finest).items()}


def _left(sizes: list[float], q: float) -> float:
    """Of the coarse mesh's difference from the finest, what the finer one's is with errors c n^-q [-]."""
    coarse, finer, finest = (size**-q for size in sizes)
    return (finer - finest) / (coarse - finest)

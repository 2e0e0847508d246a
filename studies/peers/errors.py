"""How far answers are from the reference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

FREE, PRESSED = "free_tips", ("contact_tips", "contact_forces")


def errors(answers: dict[str, Any], reference: dict[str, Any]) -> dict[str, Any]:
    """Median and largest relative errors of one alternative [-], and the states that it has no answer for.

    Tips over the way of the reference's tip, contact forces over the reference's; states without an answer are left out
    of the numbers and listed by their places: `missing_free`, `missing_contact`. A quantity that an alternative never
    answers is None and misses nothing: it is not of its kind, as the contact force of a grid of free states.
    """
    found: dict[str, Any] = {}
    missing: dict[str, list[int]] = {}
    for quantity in (FREE, *PRESSED):
        answered, truth = answers[quantity], reference[quantity]
        off = [relative(one, true) for one, true in zip(answered, truth, strict=True) if one is not None]
        found[quantity] = {"median": float(np.median(off)), "max": max(off)} if off else None
        missing[quantity] = [k for k, one in enumerate(answered) if one is None] if off else []
    pressed = sorted({k for quantity in PRESSED for k in missing[quantity]})
    return found | {"missing_free": missing[FREE], "missing_contact": pressed}


def relative(answered: float | Sequence[float], truth: float | Sequence[float]) -> float:
    """Distance over the true one's length [-]."""
    return float(np.linalg.norm(np.subtract(answered, truth)) / np.linalg.norm(truth))


def compared(every: list[dict[str, Any]], reference: dict[str, Any]) -> list[dict[str, Any]]:
    """Every alternative with its errors and its time as a multiple of the fastest one's."""
    fastest = min(row["seconds"] for row in every)
    return [row | {"errors": errors(row, reference), "times": row["seconds"] / fastest} for row in every]

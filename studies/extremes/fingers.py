"""Fingers at the ends of ranges: the draft scene changed, solved, compared, and the verdicts on them."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.state import State
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import one_line

Table = dict[str, Any]
ACCURATE, REFUSED, INACCURATE = "accurate", "refused", "INACCURATE"


class Refused(Exception):
    """A result that reports why it is none."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """The verdict on one extreme.

    Attributes:
        extreme: which range is at its end.
        case: how far.
        outcome: accurate, refused or INACCURATE.
        error: against the reference, relative [-]; None if it was refused.
        bound: that the error must keep [-].
        reference: what the answer is compared with; or the reason of a refusal.
    """

    extreme: str
    case: str
    outcome: str
    error: float | None
    bound: float
    reference: str


def judged(extreme: str, case: str, reference: str, bound: float, error: Callable[[], float]) -> Row:
    """One row: `error` computes the relative error, or raises what refuses with a reason."""
    try:
        found = float(error())
    except (ValueError, LoadNotReached, Refused) as refusal:
        reason = str(refusal).strip()
        outcome = REFUSED if reason and "\n" not in reason else INACCURATE
        return Row(extreme=extreme, case=case, outcome=outcome, error=None, bound=bound, reference=reason)
    outcome = ACCURATE if found <= bound else INACCURATE
    return Row(extreme=extreme, case=case, outcome=outcome, error=found, bound=bound, reference=reference)


def changed(table: Table, **parts: Any) -> Table:
    """A scene with some entries replaced: geometry=dict(side=...), obstacle=None, ..."""
    table = copy.deepcopy(table)
    for name, value in parts.items():
        if value is None:
            table.pop(name, None)
        elif isinstance(value, dict):
            table[name] = table.get(name, {}) | value
        else:
            table[name] = value
    return table


def model(table: Table) -> FingerModel:
    """A model, or the one line that refuses its scene."""
    try:
        return FingerModel(Scene.model_validate(table))
    except ValidationError as error:
        raise Refused(one_line(error)) from None


def solved(finger: FingerModel, tensions: list[float], distance: float | None = None) -> State:
    """A state that is stable and does not intersect itself."""
    state = finger.solve(tensions, distance)
    if state.self_intersecting:
        raise Refused("marked: the finger passes through itself")
    if not state.stable:
        raise Refused("marked: the equilibrium is not stable")
    return state


def force(state: State) -> float:
    """The contact force of a state before an obstacle [N]."""
    assert state.contact_force is not None
    return float(state.contact_force)


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Relative distance of two vectors [-]."""
    return float(np.linalg.norm(np.subtract(one, other)) / np.linalg.norm(other))


def against_finer(table: Table, tensions: list[float], distance: float | None = None) -> float:
    """Error of tip and contact force, the larger, against a finer mesh of order 2."""
    along, across = table["mesh"]["cells"]
    slender = int(1.2 * max(table["geometry"]["segments"]) / table["geometry"]["side"])  # cells no longer than the side
    cells = [max(min(max(along, 16), 30), slender), max(across, 5) if across < 8 else 8]
    fine = changed(table, mesh={"cells": cells, "order": 2})
    own, true = (solved(model(one), tensions, distance) for one in (table, fine))
    error = apart(own.tip, true.tip)
    return error if distance is None else max(error, abs(force(own) / force(true) - 1))

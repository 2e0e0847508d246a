"""Fingers at the ends of ranges: the draft scene changed, solved, compared with a finer mesh."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.equilibrium.state import State
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import one_line
from studies.extremes.verdicts import Refused

ROOT = Path(__file__).resolve().parents[2]
Table = dict[str, Any]


def draft() -> Table:
    """The draft scene as plain data."""
    return tomllib.loads((ROOT / "scenes" / "draft.toml").read_text())


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


def planar(table: Table) -> Table:
    """The same with the first tendon alone, so that half the finger is modelled."""
    return changed(table, tendons=table["tendons"][:1])


def model(table: Table) -> FingerModel:
    """A model, or the one line that refuses its scene."""
    try:
        return FingerModel(Scene.model_validate(table))
    except ValidationError as error:
        raise Refused(one_line(error)) from None


def solved(of: FingerModel, tensions: list[float], distance: float | None = None) -> State:
    """A state that says nothing against itself."""
    state = of.solve(tensions, distance)
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


def finer(table: Table) -> Table:
    """The scene on a finer mesh of order 2."""
    along, across = table["mesh"]["cells"]
    geometry = table["geometry"]
    slender = int(1.2 * max(geometry["segments"]) / geometry["side"])  # cells are not longer than the side
    cells = [max(min(max(along, 20), 40), slender), max(across, 5) if across < 8 else 8]
    return changed(table, mesh={"cells": cells, "order": 2})


def against_finer(table: Table, tensions: list[float], distance: float | None = None) -> float:
    """Error of tip and contact force, the larger, against a finer mesh."""
    ours, fine = (solved(model(one), tensions, distance) for one in (table, finer(table)))
    error = apart(ours.tip, fine.tip)
    if distance is None:
        return error
    return max(error, abs(force(ours) / force(fine) - 1))

"""Random fingers: each has a stable answer, a marked one, or a refusal with its reason.

There is no fourth outcome: an error of another kind, or a state that is not in balance, ends the study with code 3.
"""

from __future__ import annotations

import gc
import re
import time
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerfem import FingerModel
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.state import State
from fingerfem.scene.scene import Scene
from fingerfem.scene.toml_file import one_line
from studies.cores import on_cores
from studies.parts import Run
from studies.random_fingers import drawn

COUNT, KEPT, TOGETHER = 200, 40, 5  # fingers; of those that an interrupted run keeps at once; of a call
CELLS = 60, 15  # most cells along and across
BALANCE = 1e-6  # largest reaction of the clamp, but for weight and pressure there, over E A [-]


def row(number: int) -> dict[str, Any]:
    """Outcome of a finger."""
    table, loads = drawn.finger(number)
    found = {"number": number, "shape": table["section"]["shape"], "law": table["material"]["law"]}
    found |= {"nu": table["material"]["nu"], "outcome": "ERROR", "reason": None}
    found |= {"seconds": None, "iterations": None, "wasted": None}
    begun = time.perf_counter()
    try:
        model = FingerModel(_fitting(table))
        state = model.solve(loads)
    except ValidationError as error:
        return found | {"outcome": "refused", "reason": one_line(error)}
    except LoadNotReached as failure:
        return found | {"outcome": "not reached", "reason": str(failure).splitlines()[0]}
    except Exception as error:  # the study's question
        return found | {"reason": f"{type(error).__name__}: {error}".splitlines()[0]}
    found |= {"seconds": time.perf_counter() - begun, "iterations": state.newton_iterations}
    found |= {"wasted": model.continuation.wasted}
    if not _is_balanced(model, state):
        return found | {"reason": f"the clamp's reaction is {state.clamp_reaction} N"}
    return found | {"outcome": "marked" if state.marks else "solved", "reason": state.marks[0] if state.marks else None}


def _fitting(table: drawn.Table) -> Scene:
    """The scene on the fewest cells along and across that it fits, as the refusal of fewer says."""
    cells = table["mesh"]["cells"]
    while True:
        try:
            return Scene.model_validate(table)
        except ValidationError as error:
            reason = one_line(error)
            axis = 0 if "mesh.cells[0]" in reason else 1
            if "cells" not in reason or cells[axis] == CELLS[axis]:
                raise
            cells[axis] += 1


def _is_balanced(model: FingerModel, state: State) -> bool:
    """True if the clamp carries weight alone, all numbers are finite, and no cell is turned over."""
    weight = model.problem.comm.allreduce(_weight(model))
    unbalanced = float(np.abs(state.clamp_reaction + weight).max()) / model.problem.force_scale
    return unbalanced < BALANCE and state.smallest_volume_ratio > 0 and bool(np.isfinite(state.displacement).all())


def _weight(model: FingerModel) -> np.ndarray:
    """Weight of the whole finger, from its residual at rest without other loads, shape (3,) [N]."""
    model.continuation.start(np.zeros(len(model.scene.actuators)), None, np.zeros_like(model.problem.displacement))
    residual, reaction = model.problem.residual()
    forces = model.problem.copies * residual.array_r.reshape(-1, 3).sum(axis=0)
    residual.destroy()
    if model.scene.is_half:
        forces[2] = 0.0
    return np.asarray(-(forces + reaction))


def kind(reason: str | None) -> str | None:
    """A reason without its numbers."""
    return reason and re.sub(r"\[.*?\]|-?\d[\w.+-]*", "#", reason)


def rows(first: int) -> list[dict[str, Any]]:
    """Some fingers, one after the other; each is printed, and its memory is freed before the next."""
    found = []
    for number in range(first, first + TOGETHER):
        found.append(row(number))
        print(f"  {found[-1]}", flush=True)
        gc.collect()
    return found


def measure(run: Run) -> list[dict[str, Any]]:
    """A row a finger.

    Raises:
        SystemExit: a finger is neither solved, nor marked, nor refused.
    """
    found = []
    for begin in range(0, COUNT, KEPT):
        calls = [(first,) for first in range(begin, begin + KEPT, TOGETHER)]
        parts = run.once(f"fingers from {begin}", on_cores, rows, calls)
        found += [one | {"kind": kind(one["reason"])} for part in parts for one in part]
    for one in found:
        if one["outcome"] == "ERROR":
            print(f"  {one}", flush=True)
    if any(one["outcome"] == "ERROR" for one in found):
        raise SystemExit(3)
    return found

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

COUNT, TOGETHER = 100, 10  # fingers; of a call
CELLS = range(5, 16)  # across, tried in this order
BALANCE = 1e-6  # largest reaction of the clamp, but for weight and pressure there, over E A [-]


def row(number: int) -> dict[str, Any]:
    """What became of a finger."""
    table, loads = drawn.finger(number, CELLS[0])
    found = {"number": number, "shape": table["section"]["shape"], "law": table["material"]["law"]}
    found |= {"nu": table["material"]["nu"], "outcome": "ERROR", "reason": None, "seconds": None, "iterations": None}
    begun = time.perf_counter()
    try:
        model = FingerModel(_fitting(number))
        state = model.solve(loads)
    except ValidationError as error:
        return found | {"outcome": "refused", "reason": one_line(error)}
    except LoadNotReached as failure:
        return found | {"outcome": "not reached", "reason": str(failure).splitlines()[0]}
    except Exception as error:  # the study's question
        return found | {"reason": f"{type(error).__name__}: {error}".splitlines()[0]}
    found |= {"seconds": time.perf_counter() - begun, "iterations": state.newton_iterations}
    if not _is_balanced(model, state):
        return found | {"reason": f"the clamp's reaction is {state.clamp_reaction} N"}
    return found | {"outcome": "marked" if state.marks else "solved", "reason": state.marks[0] if state.marks else None}


def _fitting(number: int) -> Scene:
    """The scene on the fewest cells across that fit its channels, as the refusal of fewer says."""
    for across in CELLS:
        try:
            return Scene.model_validate(drawn.finger(number, across)[0])
        except ValidationError as error:
            if across == CELLS[-1] or "cells" not in one_line(error):
                raise
    raise AssertionError


def _is_balanced(model: FingerModel, state: State) -> bool:
    """Whether the clamp carries weight alone, all numbers are finite, and no cell is turned over."""
    weight = model.problem.comm.allreduce(_weight(model))
    unbalanced = float(np.abs(state.clamp_reaction + weight).max()) / model.problem.force_scale
    return unbalanced < BALANCE and state.smallest_volume_ratio > 0 and bool(np.isfinite(state.displacement).all())


def _weight(model: FingerModel) -> np.ndarray:
    """Of the whole finger, from its residual at rest without other loads, shape (3,) [N]."""
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
    calls = [(first,) for first in range(0, COUNT, TOGETHER)]
    found = [one | {"kind": kind(one["reason"])} for part in run.once("fingers", on_cores, rows, calls) for one in part]
    for one in found:
        if one["outcome"] == "ERROR":
            print(f"  {one}", flush=True)
    if any(one["outcome"] == "ERROR" for one in found):
        raise SystemExit(3)
    return found

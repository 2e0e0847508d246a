"""A line at tensions of its own: the free state, and states with a wrench on every plate.

These begin at the free one, so that none depends on another; or where they are known on another mesh (`--near`).
"""

import numpy as np

from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.dataset.description import Line
from rom.dataset.snapshot_set import read_task

ROOTS = 12  # lines whose free state is solved from rest; every other line begins at the nearest of these


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """The line whose free state this one begins at, the nearest of the roots; none where it begins otherwise."""
    description = setting.description
    if setting.known.near is not None or not description.has_field or line.index[0] < ROOTS:
        return []
    size = [parameter["upper"] - parameter["lower"] for parameter in description.parameters[: description.actuators]]
    away = (np.array(description.scattered[:ROOTS]) - line.tensions) / size
    return [f"pressed-{np.argmin(np.sum(away**2, axis=1))}"]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The free state and the pressed ones."""
    record, tensions, continuation = setting.recorder(), np.array(line.tensions), setting.model.continuation
    if not setting.begin_near(tensions):
        _begin(setting, needs(setting, task, line))
    record.state(tensions, None, 0)
    free = record.displacements[0]
    for wrenches in _wrenches(setting, line):
        if setting.begin_near(tensions, wrenches):
            record.restarted()
        elif not np.isnan(free).any():
            continuation.start(tensions, None, free)
            record.restarted()
        record.state(tensions, None, 0, wrenches)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def give_up(setting: Setting, task: str, line: Line, reason: str) -> Arrays:
    """The same without an answer."""
    record, tensions = setting.recorder(), np.array(line.tensions)
    for wrenches in (None, *_wrenches(setting, line)):
        record.failed(tensions, np.nan, reason, wrenches=wrenches)
    return record.arrays() | {"nodes": np.array(line.nodes)}


def _begin(setting: Setting, roots: list[str]) -> None:
    """Bring the model to a root's free state, or to rest where it has none."""
    setting.model.continuation.rest()
    for root in roots:
        known = read_task(setting.path, root, ("parameters", "converged", "displacement"))
        if known["converged"][0]:
            tensions = known["parameters"][0, : setting.description.actuators]
            setting.model.continuation.start(tensions, None, setting.numbering.scatter(known["displacement"][0]))


def _wrenches(setting: Setting, line: Line) -> np.ndarray:
    """Wrenches of a line's pressed states, shape (states, plates, 6) [N, N m]."""
    wrenches = np.array(setting.description.wrenches[line.index[0]])
    return wrenches.reshape(len(wrenches), -1, 6)

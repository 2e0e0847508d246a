"""A line at tensions of its own: the free state, and states with a wrench on every plate.

These begin at the free one, so that none depends on another; or where they are known on another mesh (`--near`).
"""

from __future__ import annotations

import numpy as np

from fingerfem.snapshots.lines import scattered
from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.snapshots.description import Line


def needs(setting: Setting, task: str, line: Line) -> list[str]:
    """The line whose free state this one begins at; none where it is known otherwise."""
    return scattered.needs(setting, task, line) if setting.known.near is None else []


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The free state and the pressed ones."""
    record, tensions, continuation = setting.recorder(), np.array(line.tensions), setting.model.continuation
    if not setting.begin_near(tensions):
        scattered.begin(setting, needs(setting, task, line))
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


def _wrenches(setting: Setting, line: Line) -> np.ndarray:
    """Of a line's pressed states, shape (states, plates, 6) [N, N m]."""
    found = np.array(setting.description.wrenches[line.index[0]])
    return found.reshape(len(found), -1, 6)

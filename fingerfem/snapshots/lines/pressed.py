"""A line at tensions of its own: the free state, and from there states with a wrench on every plate."""

from __future__ import annotations

import numpy as np

from fingerfem.snapshots.lines.scattered import begin, needs
from fingerfem.snapshots.lines.setting import Arrays, Setting
from rom.snapshots.description import Line

__all__ = ["give_up", "needs", "solve"]


def solve(setting: Setting, task: str, line: Line) -> Arrays:
    """The free state and the pressed ones; each of these begins at the free one, so that none depends on another."""
    record, tensions = setting.recorder(), np.array(line.tensions)
    begin(setting, needs(setting, task, line))
    record.state(tensions, None)
    free = record.displacements[0]
    for wrenches in _wrenches(setting, line):
        if not np.isnan(free).any():
            setting.model.continuation.start(tensions, None, free)
            record.restarted()
        record.state(tensions, None, wrenches=wrenches)
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

"""Solves the tasks of a set on one model, each by its line's kind."""

import time
from pathlib import Path
from typing import Protocol

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.model import FingerModel
from fingerfem.snapshots.lines import contact, free, held_out, pressed
from fingerfem.snapshots.lines.setting import NOTHING_KNOWN, Arrays, Known, Setting
from rom.dataset.description import Description, Line
from rom.dataset.plan import Plan
from rom.dataset.snapshot_set import task_file


class LineKind(Protocol):
    """Interface of a kind of lines."""

    def needs(self, setting: Setting, task: str, line: Line) -> list[str]:
        """Tasks that must be done before."""

    def solve(self, setting: Setting, task: str, line: Line) -> Arrays:
        """The arrays of a task's file; states without an answer are marked."""

    def give_up(self, setting: Setting, task: str, line: Line, reason: str) -> Arrays:
        """The same of a task that nobody shall try again."""


KINDS: dict[str, LineKind] = {
    "free": free,
    "contact": contact,
    "pressed": pressed,
    "random": held_out,
}


class LineSolver:
    """Solves one task at a time; every rank of its model takes part."""

    def __init__(self, description: Description, model: FingerModel, path: str | Path, known: Known = NOTHING_KNOWN):
        self.numbering = NodeOrder(model.problem)
        self._setting = Setting(
            description=description,
            model=model,
            path=Path(path),
            numbering=self.numbering,
            plan=Plan(path, description),
            known=known,
        )

    def ready(self, task: str) -> bool:
        """True if the files of all tasks that this one needs exist."""
        line = self._setting.line(task)
        needed = KINDS[line.kind].needs(self._setting, task, line)
        return all(task_file(self._setting.path, name).exists() for name in needed)

    def solve(self, task: str) -> Arrays:
        """The arrays of a task's file, whole on the model's first rank; states without an answer are marked."""
        begun, line = time.process_time(), self._setting.line(task)  # of a core: what else runs does not count
        arrays = KINDS[line.kind].solve(self._setting, task, line)
        return arrays | {"seconds": np.array(time.process_time() - begun)}

    def give_up(self, task: str, reason: str) -> Arrays:
        """The arrays of a task that nobody shall try again."""
        line = self._setting.line(task)
        return KINDS[line.kind].give_up(self._setting, task, line, reason) | {"seconds": np.array(0.0)}

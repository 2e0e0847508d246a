"""Lines of states: what one task of a set is, solved on one model.

What a task computes depends on the set's description and on the files of tasks before it alone.
"""

from __future__ import annotations

import logging
import time
from pathlib import Path

import numpy as np

from fingerfem.convergence import LoadNotReached
from fingerfem.model import FingerModel
from fingerfem.numbering import Numbering
from fingerfem.record import Record
from rom.snapshots import Description, read_task, task_file

logger = logging.getLogger(__name__)
Arrays = dict[str, np.ndarray]


class LineSolver:
    """Solves one task at a time; every rank of its model takes part."""

    def __init__(self, description: Description, model: FingerModel, path: str | Path):
        self.description, self.model, self.path = description, model, Path(path)
        self.numbering = Numbering(model)
        self._nearest: float = description.parameters[-1]["lower"] if description.has_obstacle else np.nan

    def ready(self, task: str) -> bool:
        """Whether all that the task needs is there."""
        kind, *index = task.split("-")
        return kind != "contact" or task_file(self.path, f"free-{index[0]}").exists()

    def solve(self, task: str) -> Arrays:
        """The arrays of a task's file, whole on the model's first rank; states without an answer are marked."""
        begun = time.perf_counter()
        kind, *index = task.split("-")
        if kind == "free":
            arrays = self._free(int(index[0]))
        else:
            arrays = self._contact(int(index[0]), int(index[1])) if kind == "contact" else self._random(int(index[0]))
        return arrays | {"seconds": np.array(time.perf_counter() - begun)}

    def give_up(self, task: str, reason: str) -> Arrays:
        """The arrays of a task that nobody shall try again."""
        description, record = self.description, Record(self.model, self.numbering)
        kind, *index = task.split("-")
        if kind == "random":
            point = np.array(description.random[int(index[0])])
            record.failed(point[: description.tensions], point[-1], reason)
        elif kind == "free":
            for tension in description.tension_nodes[description.lead]:
                record.failed(description.insert_lead(description.others[int(index[0])], tension), np.nan, reason)
        else:
            self._no_contact(record, int(index[0]), int(index[1]), reason)
        return record.arrays() | {"seconds": np.array(0.0)} | ({"onset": np.array(np.nan)} if kind == "free" else {})

    def _free(self, j: int) -> Arrays:
        others, lead = self.description.others[j], self.description.tension_nodes[self.description.lead]
        record = Record(self.model, self.numbering)
        self.model.stepper.rest()
        for tension in lead:
            record.state(self.description.insert_lead(others, tension), None)
        onset = self._onset(others, record) if self.description.has_obstacle else np.nan
        return record.arrays() | {"onset": np.array(onset)}

    def _onset(self, others: tuple[float, ...], record: Record) -> float:
        """Lead tension at which the free finger reaches the nearest plane [N]; nan if it never does."""
        lead = np.array(self.description.tension_nodes[self.description.lead])
        reach = np.array(record.reaches)
        beyond = np.flatnonzero(reach >= self._nearest)
        if not beyond.size or np.isnan(reach[: beyond[0] + 1]).any():
            return np.nan
        if beyond[0] == 0:
            return float(lead[0])
        k = int(beyond[0]) - 1
        a, b, fa, fb = lead[k], lead[k + 1], reach[k] - self._nearest, reach[k + 1] - self._nearest
        self.model.stepper.start(self.description.insert_lead(others, a), None, record.displacements[k])
        for _ in range(40):  # regula falsi, Illinois variant: the bracket never leaves equilibria known to exist
            tension = (a * fb - b * fa) / (fb - fa)
            try:
                self.model.stepper.advance(self.description.insert_lead(others, tension), None)
            except LoadNotReached:
                return np.nan
            f = self.model.reach() - self._nearest
            if abs(f) < 1e-9:
                return float(tension)
            if f * fb < 0:
                a, fa = b, fb
            else:
                fa /= 2
            b, fb = tension, f
        return np.nan

    def _contact_tensions(self, j: int, i: int, onset: float) -> np.ndarray:
        description = self.description
        tension = onset + description.onset_nodes[i] * (description.parameters[description.lead]["upper"] - onset)
        return description.insert_lead(description.others[j], tension)

    def _no_contact(self, record: Record, j: int, i: int, reason: str) -> None:
        onset = float(read_task(self.path, f"free-{j}", ("onset",))["onset"])
        tensions = self._contact_tensions(j, i, onset)
        record.failed(tensions, np.nan, reason, len(self.description.contact_nodes))

    def _contact(self, j: int, i: int) -> Arrays:
        description, record = self.description, Record(self.model, self.numbering)
        free = read_task(self.path, f"free-{j}")
        if np.isnan(free["onset"]):
            unsolved = f"free-{j} has states without an answer"
            reason = unsolved if not free["converged"].all() else "the free finger does not reach the nearest plane"
            self._no_contact(record, j, i, reason)
            return record.arrays()
        tensions = self._contact_tensions(j, i, float(free["onset"]))
        lead = description.tension_nodes[description.lead]
        below = int(np.searchsorted(lead, tensions[description.lead], side="right")) - 1
        if "displacement" in free and free["converged"][below]:
            start = self.numbering.scatter(free["displacement"][below])
            self.model.stepper.start(free["parameters"][below, : len(tensions)], None, start)
        else:
            self.model.stepper.rest()
        record.state(tensions, None)
        reach = record.reaches[0]
        for s in description.contact_nodes[1:]:
            record.state(tensions, reach - s * (reach - self._nearest))
        return record.arrays()

    def _random(self, k: int) -> Arrays:
        point = np.array(self.description.random[k])
        tensions = point[: self.description.tensions]
        record = Record(self.model, self.numbering)
        self.model.stepper.rest()
        if not self.description.has_obstacle:
            record.state(tensions, None)
            return record.arrays()
        try:
            self.model.stepper.advance(tensions, None)
        except LoadNotReached as failure:
            record.failed(tensions, point[-1], failure.reason, last_good=(failure.tensions, np.nan))
        else:
            record.touch()
            record.state(tensions, float(point[-1]), iterations_before=0)
        return record.arrays()

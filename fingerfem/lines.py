"""Lines of states: what one task of a set is, solved on one model.

What a task computes depends on the set's description and on the files of tasks before it alone.
"""

from __future__ import annotations

import logging
import time
from pathlib import Path
from typing import Any

import numpy as np

from fingerfem.convergence import LoadNotReached
from fingerfem.model import FingerModel
from fingerfem.numbering import Numbering
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
        description, record = self.description, Record(self)
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
        record = Record(self)
        self.model.stepper.rest()
        for tension in lead:
            record.state(self.description.insert_lead(others, tension), None)
        onset = self._onset(others, record) if self.description.has_obstacle else np.nan
        return record.arrays() | {"onset": np.array(onset)}

    def _onset(self, others: tuple[float, ...], record: Record) -> float:
        """Lead tension at which the free finger reaches the nearest plane [N]; nan if it never does."""
        lead = np.array(self.description.tension_nodes[self.description.lead])
        reach = record.arrays()["touch_distance"]
        if not np.isfinite(reach).all() or reach[-1] <= self._nearest:
            return np.nan
        if reach[0] >= self._nearest:
            return float(lead[0])
        k = int(np.flatnonzero(reach < self._nearest)[-1])
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
                break
            if f * fb < 0:
                a, fa = b, fb
            else:
                fa /= 2
            b, fb = tension, f
        return float(tension)

    def _contact_tensions(self, j: int, i: int, onset: float) -> np.ndarray:
        description = self.description
        tension = onset + description.onset_nodes[i] * (description.parameters[description.lead]["upper"] - onset)
        return description.insert_lead(description.others[j], tension)

    def _no_contact(self, record: Record, j: int, i: int, reason: str) -> None:
        onset = float(read_task(self.path, f"free-{j}", ("onset",))["onset"])
        tensions = self._contact_tensions(j, i, onset)
        record.failed(tensions, np.nan, reason, len(self.description.contact_nodes))

    def _contact(self, j: int, i: int) -> Arrays:
        description, record = self.description, Record(self)
        free = read_task(self.path, f"free-{j}")
        if np.isnan(free["onset"]):
            unsolved = f"free-{j} has states without an answer"
            reason = unsolved if not free["converged"].all() else "the free finger does not reach the nearest plane"
            self._no_contact(record, j, i, reason)
            return record.arrays()
        tensions = self._contact_tensions(j, i, float(free["onset"]))
        lead = description.tension_nodes[description.lead]
        below = int(np.searchsorted(lead, tensions[description.lead], side="right")) - 1
        self.model.stepper.start(
            free["parameters"][below, : len(tensions)], None, self.numbering.scatter(free["displacement"][below])
        )
        record.state(tensions, None)
        reach = self.model.reach()
        for s in description.contact_nodes[1:]:
            record.state(tensions, reach - s * (reach - self._nearest), reach)
        return record.arrays()

    def _random(self, k: int) -> Arrays:
        point = np.array(self.description.random[k])
        tensions = point[: self.description.tensions]
        record = Record(self)
        self.model.stepper.rest()
        if not self.description.has_obstacle:
            record.state(tensions, None)
            return record.arrays()
        try:
            self.model.stepper.advance(tensions, None)
        except LoadNotReached as failure:
            record.failed(tensions, point[-1], failure.reason, last_good=(failure.tensions, np.nan))
        else:
            record.state(tensions, float(point[-1]), self.model.reach(), iterations_before=0)
        return record.arrays()


class Record:
    """Collects the states of one line; after a load that was not reached the line's further states are failed too.

    Attributes:
        displacements: of this rank's nodes, state by state, as the model has them.
    """

    def __init__(self, solver: LineSolver):
        self._solver, self._broken = solver, ""
        self._last_good: tuple[np.ndarray, float] | None = None
        self._rows: list[dict[str, Any]] = []
        self.displacements: list[np.ndarray] = []

    def state(
        self,
        tensions: np.ndarray,
        distance: float | None,
        reach: float | None = None,
        iterations_before: int | None = None,
    ) -> None:
        """Solve and note one state; `reach` is the free finger's, None in a free state.

        Its iterations are counted from `iterations_before`, from now if that is None.
        """
        model = self._solver.model
        d = np.nan if distance is None else distance
        if self._broken:
            self.failed(tensions, d, self._broken, last_good=self._last_good)
            return
        before = model.stepper.iterations if iterations_before is None else iterations_before
        try:
            model.stepper.advance(tensions, distance)
        except LoadNotReached as failure:
            self._broken = failure.reason
            self._last_good = failure.tensions, np.nan if failure.distance is None else failure.distance
            self.failed(tensions, d, failure.reason, last_good=self._last_good)
            return
        if not model.stability.stable():
            self.failed(tensions, d, "the equilibrium is not stable")
            return
        if model.passes_through_itself():
            self.failed(tensions, d, "the finger passes through itself")
            return
        self.displacements.append(model.displacement.copy())
        row = {
            "parameters": self._parameters(tensions, d),
            "displacement": self._solver.numbering.gather(model.displacement),
            "tip": model.tip(),
            "iterations": model.stepper.iterations - before,
            "converged": True,
            "reason": "",
            "last_good": self._parameters(np.full_like(tensions, np.nan), np.nan),
        }
        if model.forms.contact is not None:
            row["touch_distance"] = model.reach() if reach is None else reach
            row["contact_force"] = model.scalar(model.forms.contact.force)
        self._rows.append(row)

    def failed(
        self,
        tensions: np.ndarray,
        distance: float,
        reason: str,
        count: int = 1,
        last_good: tuple[np.ndarray, float] | None = None,
    ) -> None:
        """Note states that have no answer, and the last load with an equilibrium on the way to them."""
        logger.warning("no state at %s: %s", self._parameters(tensions, distance).tolist(), reason)
        nodes = self._solver.numbering.nodes
        row = {
            "parameters": self._parameters(tensions, distance),
            "displacement": np.full(nodes.shape, np.nan),
            "tip": np.full(3, np.nan),
            "iterations": 0,
            "converged": False,
            "reason": reason,
            "last_good": self._parameters(*(last_good or (np.full_like(tensions, np.nan), np.nan))),
        }
        if self._solver.model.forms.contact is not None:
            row |= {"touch_distance": np.nan, "contact_force": np.nan}
        self._rows += [row] * count
        self.displacements += [np.full_like(self._solver.model.displacement, np.nan)] * count

    def _parameters(self, tensions: np.ndarray, distance: float) -> np.ndarray:
        return np.append(tensions, distance) if self._solver.description.has_obstacle else np.array(tensions)

    def arrays(self) -> Arrays:
        """The states collected, quantity by quantity."""
        return {name: np.array([row[name] for row in self._rows]) for name in self._rows[0] if self._whole(name)}

    def _whole(self, name: str) -> bool:
        """Fields are whole on the first rank only."""
        return name != "displacement" or self._solver.model.comm.rank == 0

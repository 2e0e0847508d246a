"""The farm: ranks that solve a set's tasks without a master and without messages, and never lose one.

Every rank claims task i with an advisory lock on byte i of one file. The kernel frees a dead process's claim, so what a
killed rank left undone another one does, in this job or the next. What a task computes depends on the set's description
and on the files of tasks before it alone, so the numbers do not depend on who solved it or in which order.
"""

from __future__ import annotations

import fcntl
import logging
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fingerfem.convergence import LoadNotReached
from fingerfem.model import FingerModel
from rom.snapshots import Description, create, drop_broken, missing, read_task, task_file, write_task

logger = logging.getLogger(__name__)


def run(description: Description, model: FingerModel, path: str | Path, progress: Callable[[int], None]) -> int:
    """Work on a set until none of its tasks is missing; every rank of a job calls this, and none waits for another.

    Args:
        description: what the set holds.
        model: this rank's model.
        path: the set's folder.
        progress: called with the number of finished tasks, of all jobs.

    Returns:
        Number of tasks this rank solved.

    Raises:
        SnapshotError: the folder holds something else or cannot be written.
    """
    solver = TaskSolver(description, model, path)
    create(path, description, solver.nodes)
    for file in drop_broken(path):
        logger.warning("%s was not whole; it is solved again", file)
    tasks = description.tasks
    pending = list(range(len(tasks)))
    solved = 0
    with open(Path(path) / "claims", "a+b") as claims:
        while pending:
            present = len(tasks) - len(missing(path, description))
            progress(present)
            before = solved
            for i in list(pending):
                if task_file(path, tasks[i]).exists():
                    pending.remove(i)
                elif solver.ready(tasks[i]) and _claim(claims, i):
                    if not task_file(path, tasks[i]).exists():
                        write_task(path, tasks[i], solver.solve(tasks[i]))
                        solved += 1
                    fcntl.lockf(claims, fcntl.LOCK_UN, 1, i)
                    pending.remove(i)
                    break
            if solved == before and pending:
                time.sleep(0.05)  # others hold what is left, or what it needs
        progress(len(tasks))
    return solved


def _claim(claims, i: int) -> bool:
    try:
        fcntl.lockf(claims, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, i)
    except BlockingIOError:
        return False
    return True


class TaskSolver:
    """Solves one task at a time on one model."""

    def __init__(self, description: Description, model: FingerModel, path: str | Path):
        self.description, self.model, self.path = description, model, Path(path)
        points = model.space.tabulate_dof_coordinates()
        self._order = np.lexsort(np.round(points, 9).T[::-1])  # the mesh's own numbering is nobody else's business
        self.nodes = points[self._order]
        self._nearest: float = description.parameters[-1]["lower"] if description.has_obstacle else np.nan

    def ready(self, task: str) -> bool:
        """Whether all that the task needs is there."""
        kind, *index = task.split("-")
        return kind != "contact" or task_file(self.path, f"free-{index[0]}").exists()

    def solve(self, task: str) -> dict[str, np.ndarray]:
        """The arrays of a task's file; states that do not converge are marked, and end a line."""
        kind, *index = task.split("-")
        if kind == "free":
            return self._free(int(index[0]))
        return self._contact(int(index[0]), int(index[1])) if kind == "contact" else self._random(int(index[0]))

    def _free(self, j: int) -> dict[str, np.ndarray]:
        others, lead = self.description.others[j], self.description.tension_nodes[self.description.lead]
        record = Record(self)
        self.model.stepper.rest()
        for tension in lead:
            record.state(self.description.insert_lead(others, tension), None)
        arrays = record.arrays()
        arrays["onset"] = np.array(self._onset(others, arrays) if self.description.has_obstacle else np.nan)
        return arrays

    def _onset(self, others: tuple[float, ...], line: dict[str, np.ndarray]) -> float:
        """Lead tension at which the free finger reaches the nearest plane [N]; nan if it never does."""
        lead = np.array(self.description.tension_nodes[self.description.lead])
        reach = line["touch_distance"]
        if not line["converged"].all() or reach[-1] <= self._nearest:
            return np.nan
        if reach[0] >= self._nearest:
            return float(lead[0])
        k = int(np.flatnonzero(reach < self._nearest)[-1])
        a, b, fa, fb = lead[k], lead[k + 1], reach[k] - self._nearest, reach[k + 1] - self._nearest
        self.model.stepper.start(self.description.insert_lead(others, a), None, self._unsorted(line["displacement"][k]))
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

    def _contact(self, j: int, i: int) -> dict[str, np.ndarray]:
        description, record = self.description, Record(self)
        free = read_task(self.path, f"free-{j}")
        onset, highest = float(free["onset"]), description.parameters[description.lead]["upper"]
        tension = onset + description.onset_nodes[i] * (highest - onset)
        tensions = description.insert_lead(description.others[j], tension)
        if np.isnan(onset):
            record.failed(
                tensions, np.nan, "the free finger does not reach the nearest plane", len(description.contact_nodes)
            )
            return record.arrays()
        below = int(np.searchsorted(description.tension_nodes[description.lead], tension, side="right")) - 1
        self.model.stepper.start(
            free["parameters"][below, : len(tensions)], None, self._unsorted(free["displacement"][below])
        )
        record.state(tensions, None)
        reach = self.model.reach()
        for s in description.contact_nodes[1:]:
            record.state(tensions, reach - s * (reach - self._nearest), reach)
        return record.arrays()

    def _random(self, k: int) -> dict[str, np.ndarray]:
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
            record.failed(tensions, point[-1], failure.reason)
        else:
            record.state(tensions, float(point[-1]), self.model.reach(), iterations_before=0)
        return record.arrays()

    def sorted(self) -> np.ndarray:
        """The model's displacement in the set's order, shape (nodes, 3) [m]."""
        return self.model.displacement.reshape(-1, 3)[self._order]

    def _unsorted(self, displacement: np.ndarray) -> np.ndarray:
        mine = np.empty_like(displacement)
        mine[self._order] = displacement
        return mine.ravel()


class Record:
    """Collects the states of one line; after a failure the line's further states are failed too."""

    def __init__(self, solver: TaskSolver):
        self._solver, self._broken = solver, ""
        self._rows: list[dict[str, Any]] = []

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
            self.failed(tensions, d, self._broken)
            return
        before = model.stepper.iterations if iterations_before is None else iterations_before
        try:
            model.stepper.advance(tensions, distance)
        except LoadNotReached as failure:
            logger.warning("%s", failure)
            self._broken = failure.reason
            self.failed(tensions, d, failure.reason)
            return
        if not model.stability.stable():
            self.failed(tensions, d, "the equilibrium is not stable")
            return
        if model.passes_through_itself():
            self.failed(tensions, d, "the finger passes through itself")
            return
        row = {
            "parameters": self._parameters(tensions, d),
            "displacement": self._solver.sorted(),
            "tip": model.tip(),
            "iterations": model.stepper.iterations - before,
            "converged": True,
            "reason": "",
        }
        if model.forms.contact is not None:
            row["touch_distance"] = model.reach() if reach is None else reach
            row["contact_force"] = model.scalar(model.forms.contact.force)
        self._rows.append(row)

    def failed(self, tensions: np.ndarray, distance: float, reason: str, count: int = 1) -> None:
        """Note states that have no answer."""
        row = {
            "parameters": self._parameters(tensions, distance),
            "displacement": np.full_like(self._solver.nodes, np.nan),
            "tip": np.full(3, np.nan),
            "iterations": 0,
            "converged": False,
            "reason": reason,
        }
        if self._solver.model.forms.contact is not None:
            row |= {"touch_distance": np.nan, "contact_force": np.nan}
        self._rows += [row] * count

    def _parameters(self, tensions: np.ndarray, distance: float) -> np.ndarray:
        return np.append(tensions, distance) if self._solver.description.has_obstacle else np.array(tensions)

    def arrays(self) -> dict[str, np.ndarray]:
        """The states collected, quantity by quantity."""
        return {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}

"""The snapshot set and its files: the one owner of the format.

A set is a folder:

    set.json            what was asked for: scene, parameters, sampling nodes, tasks, versions
    body.npz            the finger at rest, see rom.dataset.body
    rounds/NNNN.json    lines that are added to the set, see rom.dataset.plan
    tasks/NAME.npz      one file per task, a line of states solved in a fixed order, see rom.dataset.schema

Names of tasks: `free-J` is a line along the lead tension, which bends the finger most towards the plane; `contact-J-I`
brings the plane from touch to its nearest, without a state where the finger does not reach it; `pressed-K` has
tensions of its own, and wrenches on the plates; `random-K` is held out. See rom.dataset.description.Line.
"""

from __future__ import annotations

import json
from collections.abc import Collection
from copy import copy
from functools import cached_property
from pathlib import Path

import numpy as np

from rom.dataset.body import RestBody, body_file
from rom.dataset.description import FORMAT, FORMER, Description, Line
from rom.dataset.plan import Plan
from rom.dataset.schema import FIELDS, not_finite
from rom.files.atomic_file import write_whole
from rom.files.file_kinds import uses_of


class SnapshotError(ValueError):
    """A folder that is not the set it should be: one line naming it and what is wrong."""


def read_description(path: str | Path) -> Description:
    """Reads the description of a set.

    Raises:
        SnapshotError: it is no snapshot set, or one of another format.
    """
    try:
        table = json.loads((Path(path) / "set.json").read_text())
        if table["format"] == FORMER and (table["random"] or table["wrenches"]):
            table |= {"format": FORMAT}
            del table["onset_nodes"]
        if table["format"] != FORMAT:
            rule = f"must be a set of format {FORMAT}, got {table['format']}"
            raise SnapshotError(f"{path}: {rule}; fingerfem snapshots solves it in another folder")
        return Description(**table)
    except (OSError, ValueError, TypeError, KeyError) as error:
        if isinstance(error, SnapshotError):
            raise
        raise SnapshotError(f"{path}: is not a snapshot set (no readable set.json){uses_of(path)}") from None


def task_file(path: str | Path, task: str) -> Path:
    """File of a task; it need not exist yet."""
    return Path(path) / "tasks" / f"{task}.npz"


def write_task(path: str | Path, task: str, fingerprint: str, arrays: dict[str, np.ndarray]) -> None:
    """Write a task's file, arrays of shapes (states, ...), see schema; it appears whole or not at all."""
    stored = arrays | {"task": np.array(task), "fingerprint": np.array(fingerprint)}
    write_whole(task_file(path, task), lambda stream: np.savez(stream, **stored))  # type: ignore[arg-type]


def read_task(
    path: str | Path, task: str, names: tuple[str, ...] = (), without: tuple[str, ...] = ()
) -> dict[str, np.ndarray]:
    """The arrays of a task, shapes (states, ...), see schema: those named, or all, without some.

    Raises:
        SnapshotError: the file is missing or not this task's, or a converged state has a number that is not finite.
    """
    file = task_file(path, task)
    try:
        with np.load(file, allow_pickle=False) as stored:
            if stored["task"] != task:
                raise SnapshotError(f"{file}: must hold {task}, got {stored['task']}")
            arrays = {name: stored[name] for name in names or stored.files if name not in without}
            wrong = not_finite(arrays, stored["converged"])
        if wrong:
            raise SnapshotError(f"{file}: {wrong}; delete this file and run snapshots again")
        return arrays
    except SnapshotError:
        raise
    except Exception as error:  # numpy and zipfile raise many kinds for a broken file
        reason = f"is missing or not readable ({type(error).__name__})"
        raise SnapshotError(f"{file}: {reason}; run snapshots again") from None


class SnapshotSet:
    """A set, read. Its first lines are complete; of those that were added, some may still be missing."""

    def __init__(self, path: str | Path):
        self.path, self.description = Path(path), read_description(path)
        self.plan = Plan(path, self.description)
        self.missing = self.plan.missing()
        absent = [task for task in self.missing if task in self.description.lines]
        if absent:
            raise SnapshotError(f"{path}: {len(absent)} of {len(self.description.lines)} tasks are not solved yet")
        file = body_file(path)
        try:
            self.body = RestBody.read(file)
        except Exception as error:  # numpy raises many kinds for a broken file
            raise SnapshotError(f"{file}: is missing or not readable ({type(error).__name__})") from None

    @property
    def nodes(self) -> np.ndarray:
        """The finger's nodes at rest, shape (nodes, 3) [m]."""
        return self.body.nodes

    @cached_property
    def _tasks(self) -> dict[str, dict[str, np.ndarray]]:
        """All but the fields, which are many times larger than the rest."""
        solved = [task for task in self.plan.lines if task not in self.missing]
        return {task: read_task(self.path, task, without=FIELDS) for task in solved}

    def only(self, tasks: Collection[str]) -> SnapshotSet:
        """The same set with the states of some of its tasks alone."""
        fewer = copy(self)
        for cached in ("_tasks", "failures"):
            fewer.__dict__.pop(cached, None)
        fewer.__dict__["_tasks"] = {name: arrays for name, arrays in self._tasks.items() if name in tasks}
        return fewer

    @property
    def tasks(self) -> list[str]:
        """Names of the tasks that are solved, in the order they were planned in."""
        return list(self._tasks)

    def task(self, name: str) -> dict[str, np.ndarray]:
        """The arrays of a task that is solved, shapes (states, ...), without the fields."""
        return self._tasks[name]

    def _values(self, task: str, name: str) -> np.ndarray:
        return read_task(self.path, task, (name,))[name] if name in FIELDS else self._tasks[task][name]

    @cached_property
    def failures(self) -> list[tuple[str, np.ndarray, str]]:
        """Task, parameters, shape (p,) [N, m], and reason of every state that did not converge."""
        return [
            (name, task["parameters"][k], str(task["reason"][k]))
            for name, task in self._tasks.items()
            for k in np.flatnonzero(~task["converged"])
        ]

    @property
    def states(self) -> int:
        """Number of states, failed ones included."""
        return sum(len(task["converged"]) for task in self._tasks.values())

    @property
    def iterations(self) -> int:
        """Newton iterations in all."""
        return int(sum(task["iterations"].sum() for task in self._tasks.values()))

    @property
    def core_seconds(self) -> float:
        """Core time that solving took [s]."""
        return float(sum(task["seconds"] for task in self._tasks.values()))

    def states_of(self, kind: str, name: str) -> np.ndarray:
        """A quantity of every free or contact state that has an answer, each once, shape (states, *quantity)."""
        tasks = [task for task, line in self.plan.lines.items() if line.kind == kind and task in self._tasks]
        return np.concatenate([self._values(task, name)[self._tasks[task]["converged"]] for task in tasks])

    def _on_grid(self, line: Line) -> np.ndarray:
        """Positions on the grid of a line's nodes, shape (nodes, axes)."""
        shape = [len(self.description.tension_nodes[k]) for k in self.description.other_axes]
        others, count = np.unravel_index(line.index[0], shape) if shape else (), len(line.nodes)
        lead, contact = (line.nodes, ()) if line.kind == "free" else ([line.index[1]] * count, (line.nodes,))
        columns = [np.full(count, k) for k in others]
        columns.insert(self.description.lead, np.array(lead))
        return np.column_stack([*columns, *contact])

    def free(self, name: str) -> np.ndarray:
        """A quantity of the free states on the grid, shape (tension 1, tension 2, ..., *quantity); nan if missing."""
        return self._grid("free", name, [len(axis) for axis in self.description.tension_nodes])

    def contact(self, name: str) -> np.ndarray:
        """A quantity of the contact states on the grid, shape (tension 1, ..., contact path, *quantity)."""
        description = self.description
        return self._grid("contact", name, [*map(len, description.tension_nodes), len(description.contact_nodes)])

    def _grid(self, kind: str, name: str, shape: list[int]) -> np.ndarray:
        places, values = [], []
        for task, line in self.plan.lines.items():
            if line.kind == kind and task in self._tasks:
                answered = self._tasks[task]["converged"]
                places.append(self._on_grid(line)[: len(answered)][answered])
                values.append(self._values(task, name)[answered])
        solved = np.concatenate(values)
        grid = np.full((*shape, *solved.shape[1:]), np.nan if solved.dtype.kind == "f" else 0, solved.dtype)
        grid[tuple(np.concatenate(places).T)] = solved
        return grid

    def random(self, name: str) -> np.ndarray:
        """A quantity of the converged held-out states, shape (count, *quantity)."""
        if not self.description.random:
            raise SnapshotError(f"{self.path}: must be a held-out set (made with --random){uses_of(self.path)}")
        return self.answered(name)

    def answered(self, name: str) -> np.ndarray:
        """A quantity of all states that have an answer, whatever the set, shape (states, *quantity)."""
        return np.concatenate([self._values(task, name)[arrays["converged"]] for task, arrays in self._tasks.items()])

    def points(self) -> np.ndarray:
        """Parameters of all states that have an answer, shape (states, p); d of a free state is infinite."""
        parameters = self.answered("parameters")
        return np.where(np.isnan(parameters), np.inf, parameters)

"""The snapshot set and its files: the one owner of the format.

A set is a folder:

    set.json            what was asked for: scene, parameters, sampling nodes, tasks, versions
    body.npz            the finger at rest, see rom.snapshots.body
    rounds/NNNN.json    lines that refine the set, see rom.snapshots.plan
    tasks/NAME.npz      one file per task, a line of states solved in a fixed order, see rom.snapshots.schema

Names of tasks: `free-J` is a line along the lead tension, which bends the finger most towards the plane; `contact-J-I`
brings the plane from touch to its nearest, where one state stands for the line if both are the same; `scattered-K` has
tensions of its own; `random-K` is held out; `-rN` adds states to a line in round N. See rom.snapshots.description.Line.
"""

from __future__ import annotations

import json
from collections.abc import Collection
from copy import copy
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from rom.file_kinds import uses_of
from rom.snapshots.body import Body, body_file
from rom.snapshots.description import FORMAT, Description, Line
from rom.snapshots.plan import Plan
from rom.snapshots.schema import FIELDS, not_finite
from rom.whole_file import write_whole

SAME_PLACE = 1e-9  # share of a parameter's range within which states are at one place [-]


class SnapshotError(ValueError):
    """A folder that is not the set it should be: one line naming it and what is wrong."""


def read_description(path: str | Path) -> Description:
    """What a set holds.

    Raises:
        SnapshotError: it is no snapshot set, or one of another format.
    """
    try:
        table = json.loads((Path(path) / "set.json").read_text())
        if table["format"] != FORMAT:
            told = f"must be a set of format {FORMAT}, got {table['format']}"
            raise SnapshotError(f"{path}: {told}; fingerfem snapshots solves it in another folder")
        return Description(**table)
    except (OSError, ValueError, TypeError, KeyError) as error:
        if isinstance(error, SnapshotError):
            raise
        raise SnapshotError(f"{path}: is not a snapshot set (no readable set.json){uses_of(path)}") from None


def task_file(path: str | Path, task: str) -> Path:
    """Where a task's file is, or will be."""
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
    """A set, read. Its first grid is complete; of the lines that refine it, some may still be missing."""

    def __init__(self, path: str | Path):
        self.path, self.description = Path(path), read_description(path)
        self.plan = Plan(path, self.description)
        self.missing = self.plan.missing()
        absent = [task for task in self.missing if task in self.description.lines]
        if absent:
            raise SnapshotError(f"{path}: {len(absent)} of {len(self.description.lines)} tasks are not solved yet")
        file = body_file(path)
        try:
            self.body = Body.read(file)
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

    def positions(self, kind: str) -> np.ndarray:
        """Positions on the grid of the free or the contact states that have an answer, shape (states, axes)."""
        return np.concatenate([self.on_grid(line)[rows] for _, line, rows in self._lines(kind)])

    def values(self, kind: str, name: str) -> np.ndarray:
        """A quantity of the same states, shape (states, *quantity)."""
        parts = [self._values(task, name)[self._stored(task, line)[rows]] for task, line, rows in self._lines(kind)]
        return np.concatenate(parts)

    def states_of(self, kind: str, name: str) -> np.ndarray:
        """A quantity of every free or contact state that has an answer, each once, wherever it lies.

        Shape (states, *quantity).
        """
        return np.concatenate([self._values(task, name)[rows] for task, rows in self._rows(kind)])

    def count(self, kind: str) -> int:
        """Number of free states that have an answer, or of contact states that touch."""
        found = self._rows(kind)
        if kind == "free":
            return sum(len(rows) for _, rows in found)
        return sum(int((self._tasks[task]["contact_force"][rows] > 0).sum()) for task, rows in found)

    def _rows(self, kind: str) -> list[tuple[str, np.ndarray]]:
        """Tasks that hold states of a kind, and which of their states these are; a scattered line's first is free.

        States at one place count once: a fit that is judged by states left out would find each in its twin.
        """
        size = np.array([parameter["upper"] - parameter["lower"] for parameter in self.description.parameters])
        listed: list[tuple[str, np.ndarray]] = []
        for task, line in self.plan.lines.items():
            if task not in self._tasks or line.kind not in (kind, "scattered"):
                continue
            rows = np.flatnonzero(self._tasks[task]["converged"])
            if line.kind == "scattered":
                rows = rows[(rows == 0) == (kind == "free")]
            listed.append((task, rows))
        if not listed:
            return listed
        places = [np.nan_to_num(self._tasks[task]["parameters"][rows] / size) for task, rows in listed]
        twins = cKDTree(np.concatenate(places)).query_pairs(SAME_PLACE, p=np.inf, output_type="ndarray")
        first = ~np.isin(np.arange(sum(map(len, places))), twins[:, 1])  # not the later of a pair
        kept = np.split(first, np.cumsum([len(rows) for _, rows in listed])[:-1])
        return [(task, rows[own]) for (task, rows), own in zip(listed, kept, strict=True) if own.any()]

    def projected(self, kind: str, basis: np.ndarray) -> np.ndarray:
        """The displacement's derivatives of the same states in a basis, shape (states, k, p); read task by task.

        The basis has k columns of 3 nodes.
        """
        basis, found = basis.astype(np.float32), []
        for task, rows in self._rows(kind):
            slopes = self._values(task, "displacement_jacobian")[rows]
            found.append((slopes.reshape(*slopes.shape[:2], -1) @ basis).transpose(0, 2, 1).astype(float))
        return np.concatenate(found)

    def _lines(self, kind: str) -> list[tuple[str, Line, np.ndarray]]:
        """Tasks of a kind, their lines, and which states of these have an answer."""
        return [
            (task, line, np.flatnonzero(self._tasks[task]["converged"][self._stored(task, line)]))
            for task, line in self.lines.items()
            if line.kind == kind and task in self._tasks
        ]

    @property
    def lines(self) -> dict[str, Line]:
        """The lines planned; one of a single state, where the plane cannot move, has all nodes of the contact path."""
        path, found = tuple(range(len(self.description.contact_nodes))), dict(self.plan.lines)
        for task, stored in self._tasks.items():
            line = found.get(task)
            if line is not None and line.kind == "contact" and (stored["nodes"] >= 0).sum() < len(line.nodes):
                found[task] = Line(line.kind, line.index, path if self.description.refines else line.nodes)
        return found

    def _stored(self, task: str, line: Line) -> np.ndarray:
        """Where the states of a line stand in its task: one that stands for all is read for all."""
        rows = np.flatnonzero(self._tasks[task]["nodes"] >= 0)
        return rows if len(rows) == len(line.nodes) else np.zeros(len(line.nodes), int)

    def on_grid(self, line: Line) -> np.ndarray:
        """Positions on the grid of a line's nodes, shape (nodes, axes); of contact lines the onset node leads."""
        shape = self._other_shape
        others = [int(k) for k in np.unravel_index(line.index[0], shape)] if shape else []
        if line.kind == "free":
            return np.insert(np.tile(np.array(others, int), (len(line.nodes), 1)), self.description.lead, line.nodes, 1)
        others.insert(self.description.lead, line.index[1])
        return np.column_stack([np.tile(others, (len(line.nodes), 1)), line.nodes])

    def onset(self, name: str = "onset") -> np.ndarray:
        """Onset tension [N], or its derivatives, on the grid of the other tensions; nan where it is not known."""
        found = {
            line.index[0]: self._tasks[task][name]
            for task, line in self.plan.lines.items()
            if line.kind == "free" and task in self._tasks and name in self._tasks[task]
        }
        grid = np.full((len(self.description.others), *np.shape(next(iter(found.values())))), np.nan)
        for j, value in found.items():
            grid[j] = value
        return grid.reshape((*self._other_shape, *grid.shape[1:]))

    def free(self, name: str) -> np.ndarray:
        """A quantity of the free states on the grid, shape (tension 1, tension 2, ..., *quantity); 0 if not known."""
        return self._grid("free", name, [len(axis) for axis in self.description.tension_nodes])

    def contact(self, name: str) -> np.ndarray:
        """A quantity of the contact states on the grid, shape (tension 1, ..., contact path, *quantity).

        The lead axis runs over `onset_nodes`, the last over `contact_nodes`. 0 if not known.
        """
        description = self.description
        shape = [len(axis) for axis in description.tension_nodes]
        shape[description.lead] = len(description.onset_nodes)
        return self._grid("contact", name, [*shape, len(description.contact_nodes)])

    def _grid(self, kind: str, name: str, shape: list[int]) -> np.ndarray:
        values = self.values(kind, name)
        grid = np.zeros((*shape, *values.shape[1:]), values.dtype)
        grid[tuple(self.positions(kind).T)] = values
        return grid

    def random(self, name: str) -> np.ndarray:
        """A quantity of the converged held-out states, shape (count, *quantity)."""
        if not self.description.random:
            raise SnapshotError(f"{self.path}: must be a held-out set (made with --random){uses_of(self.path)}")
        return self.answered(name)

    def answered(self, name: str) -> np.ndarray:
        """A quantity of all states that have an answer, whatever the set, shape (states, *quantity)."""
        if not self.description.random and not self.description.has_load:
            kinds = ("free", "contact") if self.description.has_obstacle else ("free",)
            return np.concatenate([self.states_of(kind, name) for kind in kinds])
        return np.concatenate([self._values(task, name)[arrays["converged"]] for task, arrays in self._tasks.items()])

    def points(self) -> np.ndarray:
        """Parameters of all states that have an answer, shape (states, p); d of a free state is infinite."""
        parameters = self.answered("parameters")
        return np.where(np.isnan(parameters), np.inf, parameters)

    @property
    def _other_shape(self) -> tuple[int, ...]:
        return tuple(len(self.description.tension_nodes[k]) for k in self.description.other_axes)

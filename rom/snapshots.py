"""The snapshot set and its files: the one owner of the format.

A set is a folder:

    set.json            what was asked for: scene, parameters, sampling nodes, tasks, versions
    nodes.npy           the finger's nodes at rest, shape (nodes, 3) [m], sorted by x, then y, then z
    tasks/NAME.npz      one file per task, written beside and renamed, so it is whole or absent

A task is a line of states solved in a fixed order. Its file holds, state by state (n of them):

    parameters          (n, p)          tensions [N], then d [m] (nan in a free state)
    displacement        (n, nodes, 3)   [m]
    tip                 (n, 3)          [m]
    touch_distance      (n,)            [m] free reach at these tensions; scenes with an obstacle
    contact_force       (n,)            [N] scenes with an obstacle
    iterations          (n,)            Newton iterations
    converged           (n,)            bool; a state that is not is nan everywhere
    reason              (n,)            why not, empty if converged
    onset               ()              free tasks: lead tension that first reaches the nearest plane [N]

Tasks come in three kinds. `free-J` is a line along the lead tension (the tendon that bends the finger most towards the
plane) at the J-th combination of the others. `contact-J-I` holds the tensions (I-th node of the lead between onset and
its highest) and brings the plane from where it touches to its nearest. `random-K` is one held-out state.
"""

from __future__ import annotations

import fcntl
import json
import os
import tempfile
import zipfile
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

FORMAT = 1


class SnapshotError(ValueError):
    """A folder that is not the set it should be: one line naming it and what is wrong."""


@dataclass(frozen=True, kw_only=True)
class Description:
    """What a set holds; equal descriptions hold equal numbers.

    Attributes:
        scene: the scene as plain data, with its fingerprint.
        parameters: name, unit, lower and upper of each, tensions first, then d.
        lead: index of the lead tension.
        tension_nodes: nodes of every tension [N].
        onset_nodes: nodes of the lead tension between onset (0) and its highest (1) [-].
        contact_nodes: nodes of the plane's way between touch (0) and its nearest (1) [-].
        random: held-out parameters, shape (count, p); empty for a training set.
    """

    scene: dict[str, Any]
    fingerprint: str
    parameters: list[dict[str, Any]]
    lead: int
    tension_nodes: list[list[float]]
    onset_nodes: list[float]
    contact_nodes: list[float]
    random: list[list[float]]
    versions: dict[str, str]
    format: int = FORMAT

    @property
    def has_obstacle(self) -> bool:
        """Whether the scene has a plane."""
        return self.parameters[-1]["name"] == "d"

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return len(self.parameters) - self.has_obstacle

    @cached_property
    def others(self) -> list[tuple[float, ...]]:
        """Every combination of nodes of the tensions that do not lead [N]."""
        return list(product(*[nodes for k, nodes in enumerate(self.tension_nodes) if k != self.lead]))

    @cached_property
    def tasks(self) -> list[str]:
        """Names of all tasks; a task only ever needs tasks before it."""
        if self.random:
            return [f"random-{k}" for k in range(len(self.random))]
        free = [f"free-{j}" for j in range(len(self.others))]
        if not self.has_obstacle:
            return free
        return free + [f"contact-{j}-{i}" for j in range(len(self.others)) for i in range(len(self.onset_nodes))]

    def insert_lead(self, others: tuple[float, ...], lead: float) -> np.ndarray:
        """Tensions [N] from the others and the lead."""
        return np.insert(np.array(others, float), self.lead, lead)


def create(path: str | Path, description: Description, nodes: np.ndarray) -> None:
    """Begin a set, or find that it was begun with the same description.

    Raises:
        SnapshotError: the folder holds something else.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        names = {file.name for file in path.iterdir()}
        ours = (".begin", "tasks", "nodes.npy", ".nodes.npy.", ".set.json.")  # what a job that begins it may have made
        if "set.json" not in names and not all(name.startswith(ours) for name in names):
            raise SnapshotError(f"{path}: must be a snapshot set or an empty folder")
        with open(path / ".begin", "a+b") as turn:  # two jobs that begin one set at once take turns
            fcntl.lockf(turn, fcntl.LOCK_EX)
            _create(path, description, nodes)
    except OSError as error:
        raise SnapshotError(f"{path}: must be a folder that can be written to, got {error.strerror}") from None


def _create(path: Path, description: Description, nodes: np.ndarray) -> None:
    if (path / "set.json").exists():
        present = read_description(path)
        for name in ("fingerprint", "format", "tension_nodes", "onset_nodes", "contact_nodes", "random", "versions"):
            if getattr(present, name) != getattr(description, name):
                named = {"fingerprint": "another scene", "random": "other held-out points"}
                what = named.get(name, f"other {name.replace('_', ' ')}")
                raise SnapshotError(f"{path}: holds a set of {what}; choose a new folder")
        return
    (path / "tasks").mkdir(exist_ok=True)
    _write(path / "nodes.npy", lambda stream: np.save(stream, nodes))
    text = json.dumps(asdict(description), indent=1)
    _write(path / "set.json", lambda stream: stream.write(text.encode()))


def read_description(path: str | Path) -> Description:
    """What a set holds.

    Raises:
        SnapshotError: it is no snapshot set, or one of another format.
    """
    try:
        table = json.loads((Path(path) / "set.json").read_text())
        if table["format"] != FORMAT:
            raise SnapshotError(f"{path}: must be a set of format {FORMAT}, got {table['format']}")
        return Description(**table)
    except (OSError, ValueError, TypeError, KeyError) as error:
        if isinstance(error, SnapshotError):
            raise
        raise SnapshotError(f"{path}: is not a snapshot set (no readable set.json)") from None


def task_file(path: str | Path, task: str) -> Path:
    """Where a task's file is, or will be."""
    return Path(path) / "tasks" / f"{task}.npz"


def write_task(path: str | Path, task: str, arrays: dict[str, np.ndarray]) -> None:
    """Write a task's file; it appears whole or not at all."""
    _write(task_file(path, task), lambda stream: np.savez(stream, **arrays))  # type: ignore[arg-type]


def read_task(path: str | Path, task: str) -> dict[str, np.ndarray]:
    """The arrays of a task.

    Raises:
        SnapshotError: the file is missing or no task's.
    """
    file = task_file(path, task)
    try:
        with np.load(file, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except Exception as error:  # numpy and zipfile raise many kinds for a broken file
        raise SnapshotError(
            f"{file}: is missing or not readable ({type(error).__name__}); run snapshots again"
        ) from None


def drop_broken(path: str | Path) -> list[Path]:
    """Remove task files that are not whole, which a failing disk leaves or somebody's editor."""
    broken = [file for file in (Path(path) / "tasks").glob("*.npz") if not zipfile.is_zipfile(file)]
    for file in broken:
        file.unlink(missing_ok=True)
    return broken


def missing(path: str | Path, description: Description) -> list[str]:
    """Tasks without a file."""
    present = {file.stem for file in (Path(path) / "tasks").glob("*.npz")}
    return [task for task in description.tasks if task not in present]


def _write(file: Path, write) -> None:
    """Write beside and rename; nothing half written is ever found under the name."""
    handle, beside = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "wb") as stream:
            write(stream)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(beside, file)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


class SnapshotSet:
    """A complete set, read."""

    def __init__(self, path: str | Path):
        self.path, self.description = Path(path), read_description(path)
        absent = missing(path, self.description)
        if absent:
            raise SnapshotError(f"{path}: {len(absent)} of {len(self.description.tasks)} tasks are not solved yet")
        try:
            self.nodes = np.load(self.path / "nodes.npy")
        except Exception as error:  # numpy raises many kinds for a broken file
            raise SnapshotError(
                f"{self.path / 'nodes.npy'}: is missing or not readable ({type(error).__name__})"
            ) from None

    @cached_property
    def _tasks(self) -> dict[str, dict[str, np.ndarray]]:
        return {task: read_task(self.path, task) for task in self.description.tasks}

    @cached_property
    def failures(self) -> list[tuple[str, np.ndarray, str]]:
        """Task, parameters and reason of every state that did not converge."""
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

    def onset(self) -> np.ndarray:
        """Onset tension [N] on the grid of the other tensions, shape of that grid."""
        values = [self._tasks[f"free-{j}"]["onset"] for j in range(len(self.description.others))]
        return np.array(values, float).reshape(self._other_shape)

    def free(self, name: str) -> np.ndarray:
        """A quantity of the free states, shape (tension 1, tension 2, ..., *quantity)."""
        lines = np.array([self._tasks[f"free-{j}"][name] for j in range(len(self.description.others))])
        grid = lines.reshape(*self._other_shape, *lines.shape[1:])
        return np.moveaxis(grid, len(self._other_shape), self.description.lead)

    def contact(self, name: str) -> np.ndarray:
        """A quantity of the contact states, shape (tension 1, ..., way of the plane, *quantity).

        The lead axis runs over `onset_nodes`, the last over `contact_nodes`.
        """
        count = len(self.description.onset_nodes)
        lines = np.array(
            [[self._tasks[f"contact-{j}-{i}"][name] for i in range(count)] for j in range(len(self.description.others))]
        )
        grid = lines.reshape(*self._other_shape, *lines.shape[1:])
        return np.moveaxis(grid, len(self._other_shape), self.description.lead)

    def random(self, name: str) -> np.ndarray:
        """A quantity of the converged held-out states, shape (count, *quantity)."""
        if not self.description.random:
            raise SnapshotError(f"{self.path}: must be a held-out set (made with --random), got a training set")
        tasks = self._tasks.values()
        return np.concatenate([task[name][task["converged"]] for task in tasks])

    @property
    def _other_shape(self) -> tuple[int, ...]:
        nodes = self.description.tension_nodes
        return tuple(len(axis) for k, axis in enumerate(nodes) if k != self.description.lead)

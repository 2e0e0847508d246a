"""The snapshot set and its files: the one owner of the format.

A set is a folder:

    set.json            what was asked for: scene, parameters, sampling nodes, tasks, versions
    nodes.npy           the finger's nodes at rest, shape (nodes, 3) [m], sorted by x, then y, then z
    tasks/NAME.npz      one file per task, written beside and renamed, so it is whole or absent

A task is a line of states solved in a fixed order. Its file holds, state by state (n of them):

    parameters          (n, p)          tensions [N], then d [m] (nan in a free state)
    tip                 (n, 3)          [m]
    edge_heights        (n, edge nodes) of the long edges over the rest position of the face towards the plane [m]
    touch_distance      (n,)            [m] free reach at these tensions; scenes with an obstacle
    contact_force       (n,)            [N] scenes with an obstacle
    X_jacobian          (n, *X, p)      derivatives of tip, touch_distance and contact_force by the parameters
    displacement        (n, nodes, 3)   [m], if sampling.store asks for it, as for the next three
    displacement_jacobian (n, p, nodes, 3) derivatives of the displacement, in single precision
    pad_pressure        (n,)            [Pa]
    channel_shortening  (n, tendons)    [m], and its jacobian
    iterations          (n,)            Newton iterations
    converged           (n,)            bool; a state that is not is nan everywhere
    reason              (n,)            why not, empty if converged
    last_good           (n, p)          last load with an equilibrium on the way to a state that did not converge
    seconds             ()              that solving the line took
    task, fingerprint   ()              whose states these are
    onset               ()              free tasks: lead tension that first reaches the nearest plane [N]

Tasks come in three kinds. `free-J` is a line along the lead tension (the tendon that bends the finger most towards the
plane) at the J-th combination of the others. `contact-J-I` holds the tensions (I-th node of the lead between onset and
its highest) and brings the plane from where it touches to its nearest. `random-K` is one held-out state.
"""

from __future__ import annotations

import contextlib
import json
import os
from dataclasses import asdict
from functools import cached_property
from pathlib import Path
from uuid import uuid4

import numpy as np

from rom.description import FORMAT, Description


class SnapshotError(ValueError):
    """A folder that is not the set it should be: one line naming it and what is wrong."""


OURS = ("tasks", "claim", "attempts", "set-aside", "progress.log", ".set.json.")  # may be there before set.json


def create(path: str | Path, description: Description) -> None:
    """Begin a set, or find that it was begun with the same description.

    Raises:
        SnapshotError: the folder holds something else.
    """
    path = Path(path)
    file = path / "set.json"
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not file.exists() and not all(there.name.startswith(OURS) for there in path.iterdir()):
            raise SnapshotError(f"{path}: must be a snapshot set or an empty folder")
        (path / "tasks").mkdir(exist_ok=True)
        if not file.exists():
            text = json.dumps(asdict(description), indent=1)
            _write(file, lambda stream: stream.write(text.encode()), once=True)
    except OSError as error:
        raise SnapshotError(f"{path}: must be a folder that can be written to, got {error.strerror}") from None
    present = read_description(path)  # of several jobs that begin a set at once, one has begun it
    for name in ("fingerprint", "tension_nodes", "onset_nodes", "contact_nodes", "random", "versions", "stored"):
        if getattr(present, name) != getattr(description, name):
            named = {"fingerprint": "another scene", "random": "other held-out points", "stored": "other quantities"}
            what = named.get(name, f"other {name.replace('_', ' ')}")
            raise SnapshotError(f"{path}: holds a set of {what}; choose a new folder")


def write_nodes(path: str | Path, nodes: np.ndarray) -> None:
    """Write the finger's nodes at rest, shape (nodes, 3) [m]; everyone who does writes the same."""
    file = Path(path) / "nodes.npy"
    if not file.exists():
        _write(file, lambda stream: np.save(stream, nodes))


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


def write_task(path: str | Path, task: str, fingerprint: str, arrays: dict[str, np.ndarray]) -> None:
    """Write a task's file; it appears whole or not at all."""
    stored = arrays | {"task": np.array(task), "fingerprint": np.array(fingerprint)}
    _write(task_file(path, task), lambda stream: np.savez(stream, **stored))  # type: ignore[arg-type]


def read_task(path: str | Path, task: str, names: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """The arrays of a task: those named, or all.

    Raises:
        SnapshotError: the file is missing or not this task's.
    """
    file = task_file(path, task)
    try:
        with np.load(file, allow_pickle=False) as stored:
            if stored["task"] != task:
                raise SnapshotError(f"{file}: must hold {task}, got {stored['task']}")
            return {name: stored[name] for name in names or stored.files}
    except SnapshotError:
        raise
    except Exception as error:  # numpy and zipfile raise many kinds for a broken file
        raise SnapshotError(
            f"{file}: is missing or not readable ({type(error).__name__}); run snapshots again"
        ) from None


def set_aside_strangers(path: str | Path, description: Description) -> list[Path]:
    """Move task files that are not whole, or another set's, to `set-aside`; returns where they were.

    A failing disk leaves such, or somebody's editor.
    """
    tasks, files = set(description.tasks), sorted((Path(path) / "tasks").glob("*.npz"))
    strangers = [file for file in files if file.stem not in tasks or _is_strange(file, description)]
    for file in strangers:
        aside = Path(path) / "set-aside"
        aside.mkdir(exist_ok=True)
        os.replace(file, aside / file.name)
    return strangers


def _is_strange(file: Path, description: Description) -> bool:
    try:
        stored = read_task(file.parent.parent, file.stem, ("fingerprint", "converged"))
    except SnapshotError:
        return True
    return str(stored["fingerprint"]) != description.fingerprint


def missing(path: str | Path, description: Description) -> list[str]:
    """Tasks without a file."""
    present = {file.stem for file in (Path(path) / "tasks").glob("*.npz")}
    return [task for task in description.tasks if task not in present]


def _write(file: Path, write, once: bool = False) -> None:
    """Write beside and rename; nothing half written is ever found under the name.

    Once: whoever comes first writes it.
    """
    beside = file.with_name(f".{file.name}.{uuid4().hex}")
    try:
        with beside.open("xb") as stream:
            write(stream)
            stream.flush()
            os.fsync(stream.fileno())
        if once:
            with contextlib.suppress(FileExistsError):
                os.link(beside, file)
        else:
            os.replace(beside, file)
    finally:
        beside.unlink(missing_ok=True)


class SnapshotSet:
    """A complete set, read."""

    def __init__(self, path: str | Path):
        self.path, self.description = Path(path), read_description(path)
        absent = missing(path, self.description)
        if absent:
            raise SnapshotError(f"{path}: {len(absent)} of {len(self.description.tasks)} tasks are not solved yet")
        file = self.path / "nodes.npy"
        try:
            self.nodes = np.load(file)
        except Exception as error:  # numpy raises many kinds for a broken file
            raise SnapshotError(f"{file}: is missing or not readable ({type(error).__name__})") from None

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

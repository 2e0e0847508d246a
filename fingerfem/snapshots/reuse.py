"""States of another set of the same finger that are also states of this one: a finer grid holds a coarser one's nodes.

Nodes nest where the number of intervals is doubled: 9, 17, 33.
"""

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from rom.dataset.description import Description, Line, difference
from rom.dataset.plan import Plan
from rom.dataset.snapshot_set import SnapshotError, read_description, read_task, task_file
from rom.files.file_kinds import uses_of

NOT_OF_A_STATE = ("task", "fingerprint", "seconds", "nodes")


class Donor:
    """A set whose states are taken where they fit."""

    def __init__(self, path: str | Path, taker: Description):
        self._path, self._taker, self._own = Path(path), taker, read_description(path)
        for name in ("fingerprint", "versions", "stored", "lead"):
            if getattr(self._own, name) != getattr(taker, name):
                what = "scene" if name == "fingerprint" else name
                other = difference(taker.scene, self._own.scene) if name == "fingerprint" else ""
                raise SnapshotError(f"{path}: must be a set of the same {what} to be used again: {other}".rstrip(": "))
        if self._own.random:
            raise SnapshotError(f"{path}: must be a training set to be used again{uses_of(path)}")
        self._tasks: dict[tuple, list[str]] = defaultdict(list)
        for task, line in Plan(path, self._own).lines.items():
            if task_file(path, task).exists():
                self._tasks[(line.kind, *line.index)].append(task)

    def states(self, line: Line) -> dict[int, dict[str, Any]]:
        """The converged states it has of a line of the taker, by the taker's nodes; they cost no iterations."""
        own, taker = self._own, self._taker
        j = _place(own.others, taker.others[line.index[0]])
        index: tuple[int | None, ...]
        if line.kind == "free":
            index, ours, theirs = (j,), taker.tension_nodes[taker.lead], own.tension_nodes[own.lead]
        else:
            lead = own.tension_nodes[own.lead], taker.tension_nodes[taker.lead][line.index[1]]
            index = j, _place(*lead)
            ours, theirs = taker.contact_nodes, own.contact_nodes
        states = {}
        for task in self._tasks.get((line.kind, *index), []):
            stored = read_task(self._path, task)
            for k in np.flatnonzero(stored["converged"]):
                at = int(stored["nodes"][k])
                node = _place(ours, theirs[at])
                if node is not None:
                    row = {name: values[k] for name, values in stored.items() if name not in NOT_OF_A_STATE}
                    states[node] = row | {"iterations": 0}
        return states


def _place(nodes: list, value: Any) -> int | None:
    """Index of a value, or a tuple of values, among nodes; None if it is not there."""
    table = np.array(nodes, float).reshape(len(nodes), -1)
    same = np.isclose(table, np.reshape(value, -1), rtol=1e-12, atol=1e-12 * max(np.abs(table).max(initial=0), 1e-300))
    indices = np.flatnonzero(same.all(axis=1))
    return int(indices[0]) if indices.size else None

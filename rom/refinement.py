"""Where a set should be refined next: the surrogate's own doubt, before any state is solved.

The doubt of a node is the difference of two predictions from the states known (see rom.completion), as a share: of the
tip's largest displacement, and of the contact force, or of a hundredth of the largest force where it is smaller. A
touch distance in doubt counts with the contact force that such an error of the plane's place would make.

A round takes the coarsest nodes whose doubt is above a threshold, which falls as none are left. A line of states begun
for one of its nodes also takes those a tenth as doubtful: they cost little more.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from rom.completion import Completed, Known, complete
from rom.description import Line
from rom.plan import Round
from rom.responses import contact_outputs, contact_response, free_outputs, free_response
from rom.snapshots import SnapshotSet

THRESHOLDS = 0.3 * 10.0 ** (-0.25 * np.arange(32))  # of the doubt [-], in the order they are tried
ROUND = 0.01  # share of the states so far that a round shall have at least: ranks wait for each other between rounds
BESIDE = 0.1  # share of the threshold above which a line takes further nodes
SMALL = 0.01  # share of the largest contact force below which errors count as of that force
PERCENTILE = 95  # of the doubt over the box: the error that is estimated


def next_round(snapshots: SnapshotSet, tolerance: float) -> Round:
    """What to solve next for a relative error [-].

    Raises:
        SnapshotError: the first grid has states without an answer, or a finger that never reaches the plane.
    """
    snapshots.check_first_grid()
    parts = [_Free(snapshots), _Contact(snapshots)] if snapshots.description.has_obstacle else [_Free(snapshots)]
    error = max(part.error() for part in parts)
    if error <= tolerance:
        return Round(error=error, threshold=0.0, lines={})
    enough = ROUND * snapshots.states
    for threshold in THRESHOLDS:
        chosen = [part.choose(threshold) for part in parts]
        if sum(len(nodes) for part in chosen for nodes in part.values()) >= enough or threshold <= THRESHOLDS[-1]:
            lines = _lines(snapshots, {name: nodes for part in chosen for name, nodes in part.items()})
            return Round(error=error, threshold=float(threshold), lines=lines, finest=not lines)
    raise AssertionError("the last threshold ends every search")


def _lines(snapshots: SnapshotSet, chosen: dict[tuple, list[int]]) -> dict[str, Line]:
    """The lines of a round by the names of their tasks, those before others that begin from their states."""
    planned, number = snapshots.plan.lines, len(snapshots.plan.rounds)
    lines: dict[str, Line] = {}
    for (kind, j, *onset), nodes in sorted(chosen.items(), key=lambda item: (item[0][0] == "contact", item[0])):
        begun = f"free-{j}"
        if begun not in planned:
            lines[begun] = snapshots.description.free_line(j)
        if kind == "contact":
            lines[f"contact-{j}-{onset[0]}-r{number}"] = Line("contact", (j, onset[0]), tuple(nodes))
        elif begun in planned:
            lines[f"{begun}-r{number}"] = Line("free", (j,), tuple(nodes))
    return lines


class _Part:
    """Free or contact states: doubt, as a share, of all nodes of the grid, and what it suggests."""

    def __init__(self, snapshots: SnapshotSet, kind: str, function: Known, completed: Completed):
        self.snapshots, self.kind, self.function, self.completed = snapshots, kind, function, completed
        self.tip = float(np.linalg.norm(snapshots.values("free", "tip"), axis=1).max())
        self.tried = np.zeros(function.known.shape, bool)
        for line in snapshots.plan.lines.values():
            if line.kind == kind:
                self.tried[tuple(snapshots.on_grid(line).T)] = True

    def share(self, error: np.ndarray) -> np.ndarray:
        """Of errors of all quantities, shape (n_1, ..., n_k, m), the largest as a share, shape (n_1, ..., n_k) [-]."""
        raise NotImplementedError

    def volume(self) -> np.ndarray:
        """Share of the box that each node stands for, up to a factor, shape (n_1, ..., n_k)."""
        found = np.ones(())
        for axis in self.function.axes:
            found = found[..., None] * np.gradient(axis)
        return found

    def error(self) -> float:
        """Estimated relative error that 95 % of the box keep [-]."""
        error = self.share(self.completed.error).ravel()
        order = np.argsort(error)
        volume = np.cumsum(self.volume().ravel()[order])
        return float(error[order][np.searchsorted(volume, volume[-1] * PERCENTILE / 100)])

    def choose(self, threshold: float) -> dict[tuple, list[int]]:
        """Nodes to solve by line, (kind, j) or (kind, j, i); none if no doubt is above the threshold."""
        new = np.where(self.tried, 0.0, self.share(self.completed.doubt))
        above = new > threshold
        if not above.any():
            return {}
        stage = self.completed.stages[above].min()
        here = (self.completed.stages == stage) & ~self.tried
        description = self.snapshots.description
        along = description.lead if self.kind == "free" else new.ndim - 1
        new, here, tried = (np.moveaxis(array, along, -1) for array in (new, here, self.tried))
        found: dict[tuple, list[int]] = defaultdict(list)
        for fixed in np.argwhere((here & (new > BESIDE * threshold)).any(axis=-1)):
            at = tuple(fixed)
            begun = tried[at].any()
            if begun or (here[at] & (new[at] > threshold)).any():
                nodes = np.flatnonzero(here[at] & (new[at] > BESIDE * threshold)).tolist()
                found[self._name(at)] = nodes if begun or self.kind == "free" else sorted({0, *nodes})
        return found

    def _name(self, at: tuple[int, ...]) -> tuple:
        """Kind and index of the line through a node; the lead's place is the onset node of a contact line."""
        description, place = self.snapshots.description, list(at)
        index = [place.pop(description.lead)] if self.kind == "contact" else []
        shape = [len(description.tension_nodes[k]) for k in description.other_axes]
        j = int(np.ravel_multi_index(place, shape)) if shape else 0
        return (self.kind, j, *map(int, index))


class _Free(_Part):
    def __init__(self, snapshots: SnapshotSet):
        function = free_response(snapshots, *free_outputs(snapshots))
        super().__init__(snapshots, "free", function, complete(function))

    def share(self, error: np.ndarray) -> np.ndarray:
        share = np.linalg.norm(error[..., :3], axis=-1) / self.tip
        if not self.snapshots.description.has_obstacle:
            return share
        force = self.snapshots.values("contact", "contact_force")
        felt = force > SMALL * force.max()
        if not felt.any():
            return share
        stiffness = np.abs(self.snapshots.values("contact", "contact_force_jacobian")[:, -1])
        # In the middle of the box; where the finger is stiffer, there also is more force.
        return np.maximum(share, error[..., 3:].max(axis=-1) * np.median(stiffness[felt] / force[felt]))


class _Contact(_Part):
    def __init__(self, snapshots: SnapshotSet):
        function = contact_response(snapshots, *contact_outputs(snapshots))
        super().__init__(snapshots, "contact", function, complete(function))

    def share(self, error: np.ndarray) -> np.ndarray:
        force = np.abs(self.completed.values[..., 3])
        force = np.maximum(force, max(SMALL * force.max(), np.finfo(float).tiny))
        return np.maximum(np.linalg.norm(error[..., :3], axis=-1) / self.tip, error[..., 3] / force)

    def volume(self) -> np.ndarray:
        # The plane's way from touch to its nearest, the width of the box at a node, grows with the lead tension.
        shape = [1] * len(self.function.axes)
        shape[self.snapshots.description.lead] = -1
        return super().volume() * np.array(self.snapshots.description.onset_nodes).reshape(shape)

"""Lines of states: what one task of a set is, solved on one model.

What a task computes depends on the set's description and on the files of tasks before it alone.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.equilibrium.sensitivities import differentiate
from fingerfem.model import FingerModel
from fingerfem.snapshots.between import between
from fingerfem.snapshots.held_out import HeldOutSolver
from fingerfem.snapshots.neighbours import Neighbours
from fingerfem.snapshots.recorder import Recorder
from fingerfem.snapshots.reuse import Donor
from rom.snapshots.description import Description, Line
from rom.snapshots.plan import Plan
from rom.snapshots.snapshot_set import read_task, task_file

Arrays = dict[str, np.ndarray]


class Known(NamedTuple):
    """States of other sets that save work: a donor's are taken where they fit, held-out ones begin at neighbours."""

    donor: Donor | None = None
    neighbours: Neighbours | None = None


NOTHING_KNOWN = Known()
BETWEEN = -1  # in place of a node, of states between those of the grid
ROOTS = 12  # scattered lines whose free state is solved from rest; every other line begins at the nearest of these
SAME_PLACE = 1e-8  # [m]: a plane that has no more way than that from touch to its nearest does not move


class LineSolver:
    """Solves one task at a time; every rank of its model takes part."""

    def __init__(self, description: Description, model: FingerModel, path: str | Path, known: Known = NOTHING_KNOWN):
        self.description, self.model, self.path = description, model, Path(path)
        self.numbering, self.plan = NodeOrder(model.problem), Plan(path, description)
        self.donor, self.neighbours = known.donor, known.neighbours
        self._nearest: float = description.parameters[-1]["lower"] if description.has_obstacle else np.nan

    def ready(self, task: str) -> bool:
        """Whether all that the task needs is there."""
        line = self._line(task)
        root = self._root(line)
        if root is not None:
            return task_file(self.path, root).exists()
        if self._begins(task):
            return True
        if not task_file(self.path, f"free-{line.index[0]}").exists():
            return False
        return task in self.description.lines or all(task_file(self.path, name).exists() for name in self._before(task))

    def solve(self, task: str) -> Arrays:
        """The arrays of a task's file, whole on the model's first rank; states without an answer are marked."""
        begun, line = time.perf_counter(), self._line(task)
        if line.kind == "random":
            arrays = self._random(line)
        elif line.kind == "scattered":
            arrays = self._scattered(line)
        elif line.kind == "contact":
            arrays = self._contact(task, line)
        else:
            arrays = self._free(line, self._begins(task))
        return arrays | {"seconds": np.array(time.perf_counter() - begun)}

    def give_up(self, task: str, reason: str) -> Arrays:
        """The arrays of a task that nobody shall try again."""
        description, line = self.description, self._line(task)
        record = Recorder(self.model, self.numbering, edges=line.kind != "contact")
        if line.kind == "random":
            for tensions, distance in self._held_out(line):
                record.failed(tensions, distance, reason)
            return record.arrays() | {"seconds": np.array(0.0)}
        if line.kind == "contact":
            self._no_contact(record, line, reason)
            return record.arrays() | {"nodes": np.array(line.nodes), "seconds": np.array(0.0)}
        if line.kind == "scattered":
            record.failed(np.array(line.tensions), np.nan, reason, len(line.nodes))
            return record.arrays() | {"nodes": np.array(line.nodes), "seconds": np.array(0.0)}
        for node in line.nodes:
            record.failed(self._free_tensions(line.index[0], node), np.nan, reason)
        arrays = record.arrays() | {"nodes": np.array(line.nodes), "seconds": np.array(0.0)}
        unknown = {"onset": np.array(np.nan), "onset_jacobian": np.full(len(description.parameters), np.nan)}
        return arrays | (unknown if self._begins(task) else {})

    def _begins(self, task: str) -> bool:
        """Whether the task needs no other: a held-out state, or the first free states at its other tensions."""
        line = self._line(task)
        return line.kind == "scattered" or task in (f"free-{line.index[0]}", f"random-{line.index[0]}")

    def _before(self, task: str) -> list[str]:
        """Tasks that have states on the same line and were planned before."""
        line, names = self.plan.lines[task], list(self.plan.lines)
        same = [name for name in names[: names.index(task)] if self.plan.lines[name].index == line.index]
        return [name for name in same if self.plan.lines[name].kind == line.kind]

    def _line(self, task: str) -> Line:
        if task not in self.plan.lines:
            self.plan.refresh()
        return self.plan.lines[task]

    def _free_tensions(self, j: int, node: int) -> np.ndarray:
        description = self.description
        return description.insert_lead(description.others[j], description.tension_nodes[description.lead][node])

    def _free(self, line: Line, begins: bool) -> Arrays:
        j, record = line.index[0], Recorder(self.model, self.numbering, edges=True)
        given = self.donor.states(line) if self.donor else {}
        if begins:
            self.model.continuation.rest()
        for node in line.nodes:
            if node in given:
                self._take(record, given[node])
                continue
            if not begins:
                self._start_free(j, self._free_tensions(j, node))
                record.restarted()
            record.state(self._free_tensions(j, node), None)
        arrays = record.arrays() | {"nodes": np.array(line.nodes)}
        if not begins:
            return arrays
        slopes = np.full(len(self.description.parameters), np.nan)
        known = self.donor.onset(line) if self.donor else None
        if known is not None:
            return arrays | {"onset": np.array(known[0]), "onset_jacobian": known[1]}
        onset = self._onset(line, record, slopes) if self.description.has_obstacle else np.nan
        return arrays | {"onset": np.array(onset), "onset_jacobian": slopes}

    def _take(self, record: Recorder, row: dict[str, Any]) -> None:
        """Note a state of another set, and bring the model there if its displacement is known."""
        field = self.numbering.scatter(row["displacement"]) if self.description.has_field else None
        record.take(row, field)
        if field is not None:
            *tensions, distance = row["parameters"] if self.description.has_obstacle else (*row["parameters"], np.nan)
            self.model.continuation.start(tensions, None if np.isnan(distance) else distance, field)
            record.restarted()

    def _start_free(self, j: int, tensions: np.ndarray) -> None:
        """Bring the model to the last free state known before these tensions, or to rest."""
        stored = ("displacement",) if self.description.has_field else ()
        free, lead = read_task(self.path, f"free-{j}", ("parameters", "converged", *stored)), self.description.lead
        before = np.flatnonzero((free["parameters"][:, lead] <= tensions[lead]) & free["converged"])
        if "displacement" in free and before.size:
            start = self.numbering.scatter(free["displacement"][before[-1]])
            self.model.continuation.start(free["parameters"][before[-1], : len(tensions)], None, start)
        else:
            self.model.continuation.rest()

    def _onset(self, line: Line, record: Recorder, slopes: np.ndarray) -> float:
        """Lead tension at which the free finger reaches the nearest plane [N]; nan if it never does.

        Its derivatives by the other tensions [-] are written into `slopes`, shape (p,).
        """
        others, description = self.description.others[line.index[0]], self.description
        lead = np.array(description.tension_nodes[description.lead])[list(line.nodes)]
        reach = np.array(record.reaches)
        beyond = np.flatnonzero(reach >= self._nearest)
        if not beyond.size or np.isnan(reach[: beyond[0] + 1]).any():
            return np.nan
        if beyond[0] == 0:
            slopes[:] = 0.0
            return float(lead[0])
        k = int(beyond[0]) - 1
        a, b, fa, fb = lead[k], lead[k + 1], reach[k] - self._nearest, reach[k + 1] - self._nearest
        if np.isnan(record.displacements[k]).any():  # of another set that does not keep it
            self.model.continuation.rest()
        else:
            self.model.continuation.start(description.insert_lead(others, a), None, record.displacements[k])
        for _ in range(40):  # regula falsi, Illinois variant: the bracket never leaves equilibria known to exist
            tension = (a * fb - b * fa) / (fb - fa)
            try:
                self.model.continuation.advance(description.insert_lead(others, tension), None)
            except LoadNotReached:
                return np.nan
            f = self.model.problem.reach() - self._nearest
            if abs(f) < 1e-9:
                touch_jacobian = differentiate(self.model.problem, self.model.continuation.linearise()).touch_distance
                assert touch_jacobian is not None
                slopes[: len(touch_jacobian)] = -touch_jacobian / touch_jacobian[description.lead]  # along D0 = d_min
                slopes[[description.lead, -1]] = 0.0
                return float(tension)
            if f * fb < 0:
                a, fa = b, fb
            else:
                fa /= 2
            b, fb = tension, f
        return np.nan

    def _contact_tensions(self, line: Line, onset: float) -> np.ndarray:
        description, (j, i) = self.description, line.index
        tension = onset + description.onset_nodes[i] * (description.parameters[description.lead]["upper"] - onset)
        return description.insert_lead(description.others[j], tension)

    def _no_contact(self, record: Recorder, line: Line, reason: str) -> None:
        onset = float(read_task(self.path, f"free-{line.index[0]}", ("onset",))["onset"])
        record.failed(self._contact_tensions(line, onset), np.nan, reason, len(line.nodes))

    def _contact(self, task: str, line: Line) -> Arrays:
        description, record, nodes = self.description, Recorder(self.model, self.numbering), list(line.nodes)
        free = read_task(self.path, f"free-{line.index[0]}", ("onset", "converged"))
        if np.isnan(free["onset"]):
            unsolved = f"free-{line.index[0]} has states without an answer"
            reason = unsolved if not free["converged"].all() else "the free finger does not reach the nearest plane"
            self._no_contact(record, line, reason)
            return record.arrays() | {"nodes": np.array(nodes)}
        tensions = self._contact_tensions(line, float(free["onset"]))
        known, given = self._known(task), self.donor.states(line) if self.donor else {}
        if nodes[0] == 0 and 0 in given:
            self._take(record, given[0])
            reach = record.reaches[0]
            if not self.description.has_field:
                self._start_free(line.index[0], tensions)
        else:
            self._start_free(line.index[0], tensions)
            if 0 in known:
                self.model.continuation.start(tensions, None, self.numbering.scatter(known[0][1]))
            reach = self._touch(record, tensions, nodes)
        if reach - self._nearest < SAME_PLACE:
            if nodes[0] > 0:
                record.state(tensions, None)
            return record.arrays() | {"nodes": np.array(nodes[:1])}
        at, counted = 0, None if nodes[0] == 0 else 0
        for node in [node for node in nodes if node > 0]:
            if node in given:
                self._take(record, given[node])
                at = node
                continue
            before = max((other for other in known if other < node), default=0)
            if before > at:
                self.model.continuation.start(tensions, known[before][0], self.numbering.scatter(known[before][1]))
                record.restarted()
            record.state(tensions, reach - description.contact_nodes[node] * (reach - self._nearest), counted)
            at, counted = node, None
        own = task in description.lines
        added = between(self.model, record, tensions, reach, self._nearest) if own else 0
        return record.arrays() | {"nodes": np.array([*nodes, *[BETWEEN] * added])}

    def _root(self, line: Line) -> str | None:
        """The scattered line whose free state this one's begins at, the nearest of the roots; None for rest."""
        description = self.description
        if (
            line.kind != "scattered"
            or not description.has_field
            or not ROOTS <= line.index[0] < len(description.scattered)
        ):
            return None
        size = [parameter["upper"] - parameter["lower"] for parameter in description.parameters[: description.tensions]]
        away = (np.array(description.scattered[:ROOTS]) - line.tensions) / size
        return f"scattered-{np.argmin(np.sum(away**2, axis=1))}"

    def _start_at_root(self, root: str | None) -> None:
        """Bring the model to a root's free state, or to rest where it has none."""
        self.model.continuation.rest()
        if root is not None:
            known = read_task(self.path, root, ("parameters", "converged", "displacement"))
            if known["converged"][0]:
                tensions = known["parameters"][0, : self.description.tensions]
                self.model.continuation.start(tensions, None, self.numbering.scatter(known["displacement"][0]))

    def _scattered(self, line: Line) -> Arrays:
        """A free state at tensions of its own, and the plane's way from where it touches to its nearest."""
        description, record = self.description, Recorder(self.model, self.numbering, edges=True)
        tensions = np.array(line.tensions)
        self._start_at_root(self._root(line))
        record.state(tensions, None)
        reach, nodes = record.reaches[0], list(line.nodes)
        if not reach - self._nearest >= SAME_PLACE:  # there is no way, or no plane, or no answer
            return record.arrays() | {"nodes": np.array(nodes[:1])}
        for node in nodes[1:]:
            record.state(tensions, reach - description.contact_nodes[node] * (reach - self._nearest))
        added = between(self.model, record, tensions, reach, self._nearest)
        return record.arrays() | {"nodes": np.array([*nodes, *[BETWEEN] * added])}

    def _touch(self, record: Recorder, tensions: np.ndarray, nodes: list[int]) -> float:
        """Bring the model to where the plane would be touched and note that; returns the reach there [m].

        The state itself is noted if it is one of the line's.
        """
        if nodes[0] == 0:
            record.state(tensions, None)
            return record.reaches[0]
        try:
            self.model.continuation.advance(tensions, None)
        except LoadNotReached as failure:
            record.broken(failure)
            return np.nan
        record.touch()
        return self.model.problem.reach()

    def _known(self, task: str) -> dict[int, tuple[float, np.ndarray]]:
        """Distance [m] and displacement of the line's states that tasks before this one have, by their nodes."""
        found: dict[int, tuple[float, np.ndarray]] = {}
        for name in self._before(task) if self.description.has_field else []:
            stored = read_task(self.path, name, ("nodes", "parameters", "converged", "displacement"))
            for k in np.flatnonzero(stored["converged"]):
                found[int(stored["nodes"][k])] = (float(stored["parameters"][k, -1]), stored["displacement"][k])
        return found

    def _held_out(self, line: Line) -> list[tuple[np.ndarray, float]]:
        """Tensions [N] and distance [m] of a line of held-out states; nan without a plane."""
        description = self.description
        points = np.array([description.random[k] for k in line.nodes])
        distances = points[:, -1] if description.has_obstacle else np.full(len(points), np.nan)
        return list(zip(points[:, : description.tensions], distances.tolist(), strict=True))

    def _random(self, line: Line) -> Arrays:
        points = self._held_out(line)
        solver = HeldOutSolver(self.model, self.numbering, self.neighbours)
        return solver.solve(points[0][0], [distance for _, distance in points]).arrays()

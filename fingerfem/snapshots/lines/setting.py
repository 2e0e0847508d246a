"""Shared setting of lines of every kind: the model, the set they belong to, and states of other sets."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.model import FingerModel
from fingerfem.snapshots.neighbours import KnownSet
from fingerfem.snapshots.recorder import Recorder
from fingerfem.snapshots.reuse import Donor
from rom.dataset.description import Description, Line
from rom.dataset.plan import Plan
from rom.dataset.snapshot_set import read_task

Arrays = dict[str, np.ndarray]
SAME_PLACE = 1e-6  # of the side: a plane whose path from touch to its nearest is no longer does not move [-]


class Known(NamedTuple):
    """States of other sets that save work: a donor's are taken where they fit, others begin near what is known."""

    donor: Donor | None = None
    near: KnownSet | None = None


NOTHING_KNOWN = Known()


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A model and a set.

    Attributes:
        description: what the set holds.
        model: what solves; every rank of it takes part.
        path: the set's folder.
        numbering: of the nodes in the set's files.
        plan: the set's lines, refreshed as they appear.
        known: states of other sets.
    """

    description: Description
    model: FingerModel
    path: Path
    numbering: NodeOrder
    plan: Plan
    known: Known

    @property
    def nearest(self) -> float:
        """The plane's nearest distance [m]; nan without a plane."""
        return self.description.parameters[-1]["lower"] if self.description.has_obstacle else np.nan

    @property
    def shortest_path(self) -> float:
        """Least motion of a plane from touch to its nearest [m]; on a shorter path it does not move."""
        return SAME_PLACE * self.model.scene.geometry.side

    def recorder(self) -> Recorder:
        """New recorder of a line's states."""
        return Recorder(self.model, self.numbering)

    def line(self, task: str) -> Line:
        """A task's line."""
        if task not in self.plan.lines:
            self.plan.refresh()
        return self.plan.lines[task]

    def given(self, line: Line) -> dict[int, dict[str, Any]]:
        """The donor's states of a line, by node."""
        return self.known.donor.states(line) if self.known.donor else {}

    def take(self, record: Recorder, row: dict[str, Any]) -> None:
        """Note a state of another set, and bring the model there if its displacement is known."""
        field = self.numbering.scatter(row["displacement"]) if self.description.has_field else None
        record.take(row, field)
        if field is not None:
            *tensions, distance = row["parameters"] if self.description.has_obstacle else (*row["parameters"], np.nan)
            self.model.continuation.start(tensions, None if np.isnan(distance) else distance, field)
            record.restarted()

    def begin_near(self, tensions: np.ndarray, wrenches: np.ndarray | None = None) -> bool:
        """Bring the model to a known equilibrium near to tensions and wrenches; whether there is one."""
        if self.known.near is None:
            return False
        try:
            self.known.near.begin(self.model, self.numbering, tensions, wrenches=wrenches)
        except NotConverged:
            return False
        return True

    def start_free(self, j: int, tensions: np.ndarray) -> None:
        """Bring the model to the last free state of combination `j` known before these tensions [N], or to rest."""
        stored = ("displacement",) if self.description.has_field else ()
        free, lead = read_task(self.path, f"free-{j}", ("parameters", "converged", *stored)), self.description.lead
        before = np.flatnonzero((free["parameters"][:, lead] <= tensions[lead]) & free["converged"])
        if "displacement" in free and before.size:
            start = self.numbering.scatter(free["displacement"][before[-1]])
            self.model.continuation.start(free["parameters"][before[-1], : len(tensions)], None, start)
        else:
            self.model.continuation.rest()

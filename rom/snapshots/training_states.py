"""The states of a training set as two tables, read once."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from rom.brief import brief
from rom.file_kinds import uses_of
from rom.snapshots.body import Body
from rom.snapshots.contact_regimes import Code
from rom.snapshots.schema import FIELDS, QUANTITIES
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet

BULGE = 1e-6  # [m]: by how much a face may reach farther than its edges, which are what is fitted

FEWEST = 4  # different tensions of every tendon's states, from fewer of which a model's error cannot be estimated

Table = dict[str, np.ndarray]  # quantity by name, and its derivatives, shapes (states, *quantity)


@brief
@dataclass(frozen=True, kw_only=True)
class TrainingStates:
    """All states of a training set that have an answer, each once, wherever they lie.

    Attributes:
        free: the free states.
        contact: the states that touch the plane; empty without an obstacle.
        body: the finger at rest.
        lower, upper: ends of the parameters, shapes (p,).
        tensions: number of tensions.
    """

    free: Table
    contact: Table
    body: Body
    lower: np.ndarray
    upper: np.ndarray
    tensions: int
    _of: SnapshotSet = field(repr=False)
    _touching: np.ndarray = field(repr=False)

    @property
    def has_obstacle(self) -> bool:
        """Whether the last parameter is the plane's distance."""
        return len(self.lower) > self.tensions

    @cached_property
    def regimes(self) -> list[Code]:
        """Contact regime of every state in contact."""
        return [tuple(int(sign) for sign in code) for code in self.contact["regime"]]

    def field_slopes(self, kind: str, basis: np.ndarray) -> np.ndarray:
        """Derivatives of the displacement by the parameters in a basis, shape (states, k, p).

        They are by far the largest of a set, and read line by line.

        Args:
            kind: free or contact.
            basis: k columns of 3 nodes.
        """
        slopes = self._of.projected(kind, basis)
        return slopes if kind == "free" else slopes[self._touching]


def check_count(snapshots: SnapshotSet) -> None:
    """Refuse a set of too few states to estimate a model's error by leaving some out.

    Raises:
        SnapshotError: states at fewer different tensions than FEWEST times the number of tendons.
    """
    tensions, fewest = snapshots.description.tensions, FEWEST * snapshots.description.tensions
    count = len(np.unique(snapshots.answered("parameters")[:, :tensions], axis=0))
    if count < fewest:
        raise SnapshotError(
            f"{snapshots.path}: must have states with an answer at {fewest} different tensions at least, got {count}: "
            "from fewer, a model's error cannot be estimated; solve more lines"
        )


def read_training_states(snapshots: SnapshotSet, stored: Collection[str] | None = None) -> TrainingStates:
    """Read a set, and of the quantities that it stores besides those that always are only the named ones.

    Raises:
        SnapshotError: it is a held-out set, or has no free state or none that touches; or one is not as it should be.
    """
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set{uses_of(snapshots.path)}")
    for kind in ("free", "contact") if description.has_obstacle else ("free",):
        if not snapshots.count(kind):
            raise SnapshotError(f"{snapshots.path}: must have {kind} states with an answer, got none")
    with_slopes = all("pad_pressure_jacobian" in snapshots.task(name) for name in snapshots.tasks)
    if "pad_pressure" in description.stored and not with_slopes:
        raise SnapshotError(
            f"{snapshots.path}: must have derivatives of pad_pressure, which older versions did not store"
        )
    kept = description.stored if stored is None else stored
    scopes = {"state", *kept, *(["obstacle"] if description.has_obstacle else [])}
    touching = np.zeros(0, bool)
    contact: Table = {}
    if description.has_obstacle:
        touching = snapshots.states_of("contact", "contact_force") > 0
        contact = {name: snapshots.states_of("contact", name)[touching] for name in _names(scopes)}
    free = {name: snapshots.states_of("free", name) for name in _names(scopes | {"edges"})}
    if description.has_obstacle and np.abs(free["edge_heights"].max(axis=1) - free["touch_distance"]).max() > BULGE:
        raise SnapshotError(f"{snapshots.path}: somewhere a face bulges farther towards the plane than its edges")
    return TrainingStates(
        free=free,
        contact=contact,
        body=snapshots.body,
        lower=np.array([parameter["lower"] for parameter in description.parameters], float),
        upper=np.array([parameter["upper"] for parameter in description.parameters], float),
        tensions=description.tensions,
        _of=snapshots,
        _touching=touching,
    )


def _names(scopes: Collection[str]) -> list[str]:
    """Names of the quantities in scope and of their derivatives, but for the displacement's."""
    found = ["parameters"]
    for quantity in QUANTITIES:
        if quantity.scope in scopes:
            found.append(quantity.name)
            if quantity.jacobian and quantity.name not in FIELDS:
                found.append(f"{quantity.name}_jacobian")
    return found

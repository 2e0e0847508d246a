"""States of a training set that held-out states begin at: fewer iterations lead from there than from rest.

The set may be of the same finger on another mesh: its states are brought to this one, and solved there first. A
converged state does not depend on where it began, to its tolerance (`tests/fingerfem/snapshots/lines/test_held_out.py`
compares).
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from rom.snapshots import mesh_transfer
from rom.snapshots.snapshot_set import Description, SnapshotError, SnapshotSet


class Neighbour(NamedTuple):
    """A state that is known: tensions, shape (tensions,) [N], d [m] or None, displacement, shape (nodes, 3) [m]."""

    tensions: np.ndarray
    distance: float | None
    displacement: np.ndarray


class Neighbours:
    """The free and the contact states of a training set of the same finger.

    Attributes:
        nodes: of the set's mesh, shape (nodes, 3) [m].
        is_of_another_mesh: whether its states are no equilibria on the mesh of the set that begins there.

    Args:
        path: the set's folder; its states must have their displacement.
        description: of the set that begins there.

    Raises:
        SnapshotError: no such set, or one of another finger, or without what is needed.
    """

    def __init__(self, path: str | Path, description: Description):
        snapshots = SnapshotSet(path)
        own = snapshots.description
        if own.random:
            raise SnapshotError(f"{path}: must be a training set to begin at, got a held-out set")
        self.is_of_another_mesh = own.fingerprint != description.fingerprint
        if self.is_of_another_mesh:
            mesh_transfer.check_finger(snapshots, description.scene, "the set that begins there")
        self.nodes = snapshots.nodes
        if not own.has_field:
            raise SnapshotError(
                f"{path}: must store the displacement to begin at, got {', '.join(own.stored) or 'none'}"
            )
        self._tensions = description.tensions
        self._size = np.array([parameter["upper"] - parameter["lower"] for parameter in description.parameters])
        kinds = ("free", "contact") if description.has_obstacle else ("free",)
        self._points, self._fields = {}, {}
        for kind in kinds:
            points, fields = (snapshots.states_of(kind, name) for name in ("parameters", "displacement"))
            known = np.isfinite(points).all(axis=1) | (kind == "free")  # where contact begins there is no plane yet
            self._points[kind], self._fields[kind] = points[known], fields[known]

    def free(self, tensions: np.ndarray) -> Neighbour:
        """The free state nearest to tensions [N]."""
        return self._nearest("free", tensions)

    def contact(self, tensions: np.ndarray, distance: float) -> Neighbour:
        """The contact state nearest to tensions [N] and a plane's distance [m]."""
        return self._nearest("contact", np.append(tensions, distance))

    def _nearest(self, kind: str, point: np.ndarray) -> Neighbour:
        axes = len(point)
        away = (self._points[kind][:, :axes] - point) / self._size[:axes]
        k = int(np.argmin(np.sum(away**2, axis=1)))
        found = self._points[kind][k]
        distance = float(found[-1]) if kind == "contact" else None
        return Neighbour(found[: self._tensions], distance, self._fields[kind][k])

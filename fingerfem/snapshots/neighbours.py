"""Known states that others begin at: fewer iterations lead from there than from rest.

They are those of another set of the same finger. Those of another mesh are brought to this one, and solved there
first. A converged state does not depend on where it began, to its tolerance
(`tests/fingerfem/snapshots/lines/test_held_out.py` compares).

The field of a fit is no such state: from the field of a segment's map, some tenths of a millimetre off,
Newton's method ended at equilibria in which the rubber has crumpled, stable and wrong.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerfem.discretisation.node_order import NodeOrder
from fingerfem.equilibrium.failures import NotConverged
from fingerfem.model import FingerModel
from rom.dataset import mesh_transfer
from rom.dataset.snapshot_set import Description, SnapshotError, SnapshotSet, read_task
from rom.files.file_kinds import uses_of


class _State(NamedTuple):
    """A state that is known: tensions, shape (tensions,) [N], what else it has, displacement, shape (nodes, 3) [m]."""

    tensions: np.ndarray
    distance: float | None
    wrenches: np.ndarray | None
    displacement: np.ndarray


class KnownSet:
    """The states of a training set of the same finger, of this mesh or another; or of a held-out set of another mesh.

    Args:
        path: the set's folder; its states must have their displacement.
        description: of the set that begins there.

    Raises:
        SnapshotError: no such set, or one of another finger, or without what is needed.
    """

    def __init__(self, path: str | Path, description: Description):
        self._snapshots = snapshots = SnapshotSet(path)
        own = snapshots.description
        self._interpolation: Callable[[np.ndarray], np.ndarray] | None = None  # to the nodes of the one model
        self._is_of_another_mesh = own.fingerprint != description.fingerprint
        if own.random and not self._is_of_another_mesh:
            raise SnapshotError(f"{path}: must be a training set to begin at, or of another mesh{uses_of(path)}")
        if self._is_of_another_mesh:
            mesh_transfer.check_finger(snapshots, description.scene, "the set that begins there")
        if not own.has_field:
            raise SnapshotError(
                f"{path}: must store the displacement to begin at, got {', '.join(own.stored) or 'none'}"
            )
        self._tensions = description.actuators
        self._size = np.array([parameter["upper"] - parameter["lower"] for parameter in description.parameters])
        self._points, self._fields = {}, {}
        if description.has_load:
            self._points["pressed"], self._fields["pressed"] = _solved(snapshots)
            return
        for kind in ("free", "contact") if description.has_obstacle else ("free",):
            if own.random:
                points, fields = (snapshots.random(name) for name in ("parameters", "displacement"))
                touches = (
                    snapshots.random("contact_force") > 0 if description.has_obstacle else np.zeros(len(points), bool)
                )
                points, fields = (part[touches == (kind == "contact")] for part in (points, fields))
            else:
                points, fields = (snapshots.states_of(kind, name) for name in ("parameters", "displacement"))
            known = np.isfinite(points).all(axis=1) | (kind == "free")  # free states have no distance of a plane
            self._points[kind], self._fields[kind] = points[known], fields[known]

    def begin(
        self,
        model: FingerModel,
        numbering: NodeOrder,
        tensions: np.ndarray,
        distance: float | None = None,
        wrenches: np.ndarray | None = None,
    ) -> None:
        """Bring a model to an equilibrium near to a state.

        Args:
            model: that is brought.
            numbering: of its nodes.
            tensions: of the state, shape (tensions,) [N].
            distance: of the plane, if it is touched [m].
            wrenches: on the plates, if there are any, shape (plates, 6) [N, N m].

        Raises:
            NotConverged: there is no state, or Newton's method does not bring it to this mesh.
        """
        known = self._nearest(tensions, distance, wrenches)
        bring = self._bring(numbering.nodes) if self._is_of_another_mesh else None
        field = known.displacement if bring is None else bring(known.displacement.reshape(-1, 1)).reshape(-1, 3)
        continuation = model.continuation
        continuation.start(known.tensions, known.distance, numbering.scatter(field), known.wrenches)
        if bring is not None:
            continuation.settle()

    def _bring(self, nodes: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        if self._interpolation is None:
            self._interpolation = mesh_transfer.interpolation(self._snapshots.nodes, nodes)
        return self._interpolation

    def _nearest(self, tensions: np.ndarray, distance: float | None, wrenches: np.ndarray | None) -> _State:
        if "pressed" in self._points:
            kind, other = "pressed", np.zeros(len(self._size) - len(tensions)) if wrenches is None else wrenches.ravel()
        else:
            kind, other = ("free", np.zeros(0)) if distance is None else ("contact", np.array([distance]))
        point = np.append(tensions, other)
        axes = len(point)
        if not len(self._points[kind]):
            raise NotConverged(f"no state of {self._snapshots.path} is {kind}")
        away = (self._points[kind][:, :axes] - point) / self._size[:axes]
        k = int(np.argmin(np.sum(away**2, axis=1)))
        found = self._points[kind][k]
        return _State(
            found[: self._tensions],
            float(found[-1]) if kind == "contact" else None,
            found[self._tensions :].reshape(-1, 6) if kind == "pressed" else None,
            self._fields[kind][k],
        )


def _solved(snapshots: SnapshotSet) -> tuple[np.ndarray, np.ndarray]:
    """Parameters and displacements of all states of a set that have an answer."""
    points, fields = [], []
    for name in snapshots.plan.lines:
        task = read_task(snapshots.path, name, ("parameters", "converged", "displacement"))
        points.append(task["parameters"][task["converged"]])
        fields.append(task["displacement"][task["converged"]])
    return np.concatenate(points), np.concatenate(fields)

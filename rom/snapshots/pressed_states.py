"""The states of a set whose plates are pressed, read once into one frozen table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rom.brief import brief
from rom.file_kinds import uses_of
from rom.snapshots import mesh_transfer
from rom.snapshots.body import Body
from rom.snapshots.grid import levels
from rom.snapshots.rigid_motion import motions, rotations
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet, read_task

STATIONS = 8  # of skin points along an edge
SKIN_FROM = 0.15  # of the rubber's length, where the first one stands [-]: before, the clamp holds it


@brief
@dataclass(frozen=True, kw_only=True)
class PressedStates:
    """States of a segment with one plate, those without a wrench among them.

    A pose is where the clamp is, seen from the plate: its place [m], then the plate's unit quaternion [-].

    Attributes:
        inputs: tensions [N], then the wrench's force [N] and moment [N m] in the plate's frame, shape (n, t + 6).
        poses: shape (n, 7).
        jacobians: of the poses by the inputs, shape (n, 7, t + 6).
        lines: of states that were solved together, shape (n,).
        skin: where points of the rubber's long edges are, in the plate's frame, shape (n, m, 3) [m]; m = 0 where the
            set does not store the displacement.
        skin_jacobians: by the inputs, shape (n, m, 3, t + 6).
        corners: how far the plate's corners are from those of a box, in its frame, the first axis' sign alternating
            fastest, shape (n, 8, 3) [m]; (n, 0, 3) likewise.
        corner_jacobians: by the inputs, shape (n, 8, 3, t + 6).
        shortenings: of the tendons, shape (n, t) [m]; (n, 0) where the set does not store them.
        shortening_jacobians: by the inputs, shape (n, t, t + 6).
    """

    inputs: np.ndarray
    poses: np.ndarray
    jacobians: np.ndarray
    lines: np.ndarray
    skin: np.ndarray
    skin_jacobians: np.ndarray
    corners: np.ndarray
    corner_jacobians: np.ndarray
    shortenings: np.ndarray
    shortening_jacobians: np.ndarray

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return self.inputs.shape[1] - 6

    @property
    def forces(self) -> np.ndarray:
        """Size of the force on the plate, shape (n,) [N]."""
        return np.asarray(np.linalg.norm(self.inputs[:, self.tensions : self.tensions + 3], axis=1))

    @property
    def tension_rows(self) -> int:
        """Number of values and derivatives by tensions at distinct tensions.

        Wrenches at the same tensions add rows to a fit, but no information on what lies between these tensions.
        """
        return len(np.unique(self.inputs[:, : self.tensions], axis=0)) * (1 + self.tensions)

    def poses_alone(self) -> PressedStates:
        """The same without the rubber's points, the plate's corners and shortenings."""
        n, p = self.inputs.shape
        return replace(self, **_no_points(n, p), shortenings=np.zeros((n, 0)), shortening_jacobians=np.zeros((n, 0, p)))


def read_pressed_states(snapshots: SnapshotSet, on: SnapshotSet | None = None) -> PressedStates:
    """The states of a set that have an answer.

    Args:
        snapshots: the set.
        on: another of the same finger, on whose mesh the points are; by default its own.

    Raises:
        SnapshotError: it is no set of a scene with a load, or of a finger of several segments, or has no answer.
    """
    description = snapshots.description
    if not description.has_load:
        raise SnapshotError(f"{snapshots.path}: must be a set of a scene with a load{uses_of(snapshots.path)}")
    if len(description.scene["geometry"]["segments"]) > 1:
        raise SnapshotError(f"{snapshots.path}: must be of one segment, which others follow, got several")
    parts = [(k, snapshots.task(name)) for k, name in enumerate(snapshots.tasks)]
    if not any(part["converged"].any() for _, part in parts):
        raise SnapshotError(f"{snapshots.path}: must have states with an answer, got none")

    def together(name: str) -> np.ndarray:
        return np.concatenate([part[name][part["converged"]] for _, part in parts])

    poses, jacobians = (
        np.concatenate([together(f"{name}{suffix}")[:, 0] for name in ("clamp_place", "plate_rotation")], axis=1)
        for suffix in ("", "_jacobian")
    )
    inputs, (shortening, changes) = together("parameters"), ("channel_shortening", "channel_shortening_jacobian")
    n, p = inputs.shape
    stored = shortening in description.stored
    return PressedStates(
        inputs=inputs,
        shortenings=together(shortening) if stored else np.zeros((n, 0)),
        shortening_jacobians=together(changes) if stored else np.zeros((n, 0, p)),
        poses=poses,
        jacobians=jacobians,
        lines=np.concatenate([np.full(int(part["converged"].sum()), k) for k, part in parts]),
        **_points(snapshots, poses, jacobians, on or snapshots),
    )


def _no_points(n: int, p: int) -> dict[str, np.ndarray]:
    nothing, by_nothing = np.zeros((n, 0, 3)), np.zeros((n, 0, 3, p))
    return {"skin": nothing, "skin_jacobians": by_nothing, "corners": nothing, "corner_jacobians": by_nothing}


def _points(snapshots: SnapshotSet, poses: np.ndarray, jacobians: np.ndarray, on: SnapshotSet) -> dict[str, np.ndarray]:
    """Points of the long edges and the plate's corners seen from the plate, and their derivatives."""
    if not snapshots.description.has_field:
        return _no_points(len(poses), jacobians.shape[2])
    body = on.body
    stations = edge_sections(body)
    box = body.half_lengths * np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    at_rest = box + np.array([body.plates[-1].mean(), 0.0, 0.0])
    corners = np.linalg.norm(on.nodes[None] - at_rest[:, None], axis=2).argmin(axis=1)
    places, changes = seen_from_plate(snapshots, poses, jacobians, np.concatenate([stations, corners]), on)
    m = len(stations)
    return {
        "skin": places[:, :m],
        "skin_jacobians": changes[:, :m],
        "corners": places[:, m:] - box,
        "corner_jacobians": changes[:, m:],
    }


def seen_from_plate(
    snapshots: SnapshotSet, poses: np.ndarray, jacobians: np.ndarray, nodes: np.ndarray, on: SnapshotSet
) -> tuple[np.ndarray, np.ndarray]:
    """Places of nodes seen from the plate, R^T (x - c) = R^T x + q, and their derivatives by the inputs.

    Args:
        snapshots: a set that stores displacements.
        poses: of its states that have an answer, shape (n, 7).
        jacobians: shape (n, 7, p).
        nodes: which, shape (m,).
        on: the set whose nodes they are: the same, or another of the same finger.

    Returns:
        shapes (n, m, 3) and (n, m, 3, p) [m, per N and N m].
    """
    moved, changes = [], []
    bring = None if on is snapshots else mesh_transfer.interpolation(snapshots.nodes, on.nodes[nodes])
    for name in snapshots.tasks:
        stored = read_task(snapshots.path, name, ("converged", "displacement", "displacement_jacobian"))
        fields = stored["displacement"][stored["converged"]]
        slopes = stored["displacement_jacobian"][stored["converged"]].astype(float)
        if bring is None:
            moved.append(fields[:, nodes])
            changes.append(slopes[:, :, nodes])
        else:
            moved.append(_brought(bring, fields))
            changes.append(_brought(bring, slopes))
    turned = rotations(poses)
    places = np.einsum("nji,nmj->nmi", turned, on.nodes[nodes] + np.concatenate(moved)) + poses[:, None, :3]
    motion = motions(poses, jacobians)
    seen = np.einsum("nji,npmj->nmip", turned, np.concatenate(changes)) - motion[:, None, :3]
    seen -= np.cross(motion[:, None, 3:], places[..., None], axis=2)
    return places, seen


def _brought(bring: Callable[[np.ndarray], np.ndarray], fields: np.ndarray) -> np.ndarray:
    """Fields of one mesh's nodes, shape (..., nodes, 3), at those of another."""
    columns = fields.reshape(-1, fields.shape[-2] * 3).T
    return bring(columns).T.reshape(*fields.shape[:-2], -1, 3)


def edge_sections(body: Body) -> np.ndarray:
    """Nodes on the long edges of the last segment's rubber, at even sections before its plate; shape (m,)."""
    along, section = levels(body.nodes[body.edge_nodes, 0])
    plate = float(body.plates[-1, 0])
    rubber = np.flatnonzero((along > SKIN_FROM * plate) & (along < plate - body.tolerance))
    step = max((len(rubber) - 1) // (STATIONS - 1), 1)
    return body.edge_nodes[np.isin(section, rubber[::-1][: STATIONS * step : step])]

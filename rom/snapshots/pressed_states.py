"""The states of a set whose plates are pressed, read once into one frozen table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet


@dataclass(frozen=True, kw_only=True)
class PressedStates:
    """States of a segment with one plate, those without a wrench among them.

    A pose is where the clamp is, seen from the plate: its place [m], then the plate's unit quaternion [-].

    Attributes:
        inputs: tensions [N], then the wrench's force [N] and moment [N m] in the plate's frame, shape (n, t + 6).
        poses: shape (n, 7).
        jacobians: of the poses by the inputs, shape (n, 7, t + 6).
        lines: of states that were solved together, shape (n,).
    """

    inputs: np.ndarray
    poses: np.ndarray
    jacobians: np.ndarray
    lines: np.ndarray

    @property
    def tensions(self) -> int:
        """Number of tensions."""
        return self.inputs.shape[1] - 6

    @property
    def forces(self) -> np.ndarray:
        """Size of the force on the plate, shape (n,) [N]."""
        return np.asarray(np.linalg.norm(self.inputs[:, self.tensions : self.tensions + 3], axis=1))


def read_pressed_states(snapshots: SnapshotSet) -> PressedStates:
    """The states of a set that have an answer.

    Raises:
        SnapshotError: it is no set of a scene with a load, or of a finger of several segments, or has no answer.
    """
    description = snapshots.description
    if not description.has_load:
        raise SnapshotError(f"{snapshots.path}: must be a set of a scene with a load, got one without")
    if len(description.scene["geometry"]["segments"]) > 1:
        raise SnapshotError(f"{snapshots.path}: must be of one segment, which others follow, got several")
    parts = [(k, snapshots.task(name)) for k, name in enumerate(snapshots.plan.lines)]
    if not any(part["converged"].any() for _, part in parts):
        raise SnapshotError(f"{snapshots.path}: must have states with an answer, got none")

    def together(name: str) -> np.ndarray:
        return np.concatenate([part[name][part["converged"]] for _, part in parts])

    names = ("clamp_place", "plate_rotation")
    return PressedStates(
        inputs=together("parameters"),
        poses=np.concatenate([together(name)[:, 0] for name in names], axis=1),
        jacobians=np.concatenate([together(f"{name}_jacobian")[:, 0] for name in names], axis=1),
        lines=np.concatenate([np.full(int(part["converged"].sum()), k) for k, part in parts]),
    )

"""Full-order states of a finger as bodies in a row: its cross-sections from the clamp on, then its plate.

Every body has a place, a rotation, and the wrench that it transmits: what presses on the plate, moved there. Tendons
and the gas of chambers are internal to the finger, so they add nothing. Each comes with its derivatives by the t loads,
tensions [N] and then pressures [Pa], and by the plate's wrench.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rom.brief import brief
from rom.dataset.actuators import actuators_of, pressures_of
from rom.dataset.geometry import tip_at_rest
from rom.dataset.grid import nearest_weights
from rom.dataset.rigid_motion import motions, rotations
from rom.dataset.snapshot_set import SnapshotError, SnapshotSet
from rom.elements.samples.symmetry import Mirror, mirrors
from rom.files.file_kinds import uses_of

WRENCH = 6  # force [N] and moment [N m]
NEAREST = 6  # cross-sections that one between them is interpolated by


@brief
@dataclass(frozen=True, kw_only=True)
class Bodies:
    """The same body in n states; shapes with m as their second axis hold m bodies.

    Attributes:
        places: of its centre in space, shape (n, 3) [m].
        rotations: of its frame, shape (n, 3, 3) [-].
        motions: R^T dc and R^T dtheta by the inputs, shape (n, 6, t + 6) [m, rad].
    """

    places: np.ndarray
    rotations: np.ndarray
    motions: np.ndarray

    def __getitem__(self, k: int) -> Bodies:
        """Body k of several."""
        return Bodies(places=self.places[:, k], rotations=self.rotations[:, k], motions=self.motions[:, k])


@brief
@dataclass(frozen=True, kw_only=True)
class SectionStates:
    """States of a segment, those without a wrench among them.

    Attributes:
        scene: as plain data.
        inputs: loads [N, Pa], then force [N] and moment [N m] on the plate in its frame, shape (n, t + 6).
        lines: of states that were solved together, shape (n,).
        at: where cross-sections are at rest along the axis, shape (m,) [m]; the last one is the plate's near face.
        sections: these, m of them.
        plate: the plate, by its centre.
        shortenings: strokes of the actuators between clamp and cross-section, shape (n, m, t) [m, m^3].
        shortening_changes: by the inputs, shape (n, m, t, t + 6).
        corners: how far the corners of cross-sections are from those at rest, in their own frames, in the order
            -y -z, -y z, y -z, y z, shape (n, m, 4, 3) [m].
        corner_changes: by the inputs, shape (n, m, 4, 3, t + 6).
        mirrors: that map the finger onto itself.
    """

    scene: dict[str, Any]
    inputs: np.ndarray
    lines: np.ndarray
    at: np.ndarray
    sections: Bodies
    plate: Bodies
    shortenings: np.ndarray
    shortening_changes: np.ndarray
    corners: np.ndarray
    corner_changes: np.ndarray
    mirrors: Sequence[Mirror]

    @property
    def tensions(self) -> int:
        """Number of loads."""
        return self.inputs.shape[1] - WRENCH

    @property
    def pressures(self) -> int:
        """Number of pressures, the last ones of the loads."""
        return pressures_of(self.scene)

    @property
    def ranges(self) -> np.ndarray:
        """Lowest and highest of every load, shape (t, 2) [N, Pa]."""
        return np.array([(one.lower, one.upper) for one in actuators_of(self.scene)])

    @property
    def forces(self) -> np.ndarray:
        """Size of the force on the plate, shape (n,) [N]."""
        return np.asarray(np.linalg.norm(self.inputs[:, self.tensions : self.tensions + 3], axis=1))

    @property
    def length(self) -> float:
        """Length from the clamp to the plate's centre at rest [m]."""
        return float(tip_at_rest(self.scene["geometry"])[0])

    def body(self, k: int) -> Bodies:
        """Cross-section k; the plate if k is their number."""
        return self.plate if k == len(self.at) else self.sections[k]

    def transmitted(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """The wrench that body k transmits, in its own frame about its centre, and its derivatives by the inputs.

        With P = R_k^T R_p and the plate's centre at a = R_k^T (c_p - c_k): f = P f_p, m = P m_p + a x f.

        Returns:
            shapes (n, 6) and (n, 6, t + 6) [N, N m].
        """
        t, body, plate = self.tensions, self.body(k), self.plate
        relative = np.einsum("nji,njk->nik", body.rotations, plate.rotations)
        arm = np.einsum("nji,nj->ni", body.rotations, plate.places - body.places)
        force = np.einsum("nij,nj->ni", relative, self.inputs[:, t : t + 3])
        own = np.einsum("nij,nj->ni", relative, self.inputs[:, t + 3 :])
        moved, turned = (relative @ plate.motions[:, part] for part in (slice(3), slice(3, 6)))
        turn = turned - body.motions[:, 3:]
        arm_change = moved - body.motions[:, :3] - np.cross(body.motions[:, 3:], arm[..., None], axis=1)
        force_change = np.cross(turn, force[..., None], axis=1)
        force_change[:, :, t : t + 3] += relative
        moment_change = np.cross(turn, own[..., None], axis=1)
        moment_change[:, :, t + 3 :] += relative
        moment_change += np.cross(arm_change, force[..., None], axis=1) + np.cross(arm[..., None], force_change, axis=1)
        wrench = np.concatenate([force, own + np.cross(arm, force)], axis=1)
        return wrench, np.concatenate([force_change, moment_change], axis=1)


def read_section_states(snapshots: SnapshotSet, at: np.ndarray | None = None) -> SectionStates:
    """The states of a set that have an answer.

    Args:
        snapshots: the set.
        at: where cross-sections are wanted, between those of the mesh, shape (m,) [m]; those of the mesh if None.

    Raises:
        SnapshotError: it is no set of a scene with a load, or of a finger of several segments, or has no answer.
    """
    description = snapshots.description
    if not description.has_load:
        raise SnapshotError(f"{snapshots.path}: must be a set of a scene with a load{uses_of(snapshots.path)}")
    if len(description.scene["geometry"]["segments"]) > 1:
        raise SnapshotError(
            f"{snapshots.path}: must be of one segment: elements of it make fingers of several, got several"
        )
    parts = [(k, snapshots.task(name)) for k, name in enumerate(snapshots.tasks)]
    if not any(part["converged"].any() for _, part in parts):
        raise SnapshotError(f"{snapshots.path}: must have states with an answer, got none")

    def together(name: str) -> np.ndarray:
        return np.concatenate([part[name][part["converged"]] for _, part in parts])

    before_plate = snapshots.body.sections <= snapshots.body.plates[-1, 0] + snapshots.body.tolerance
    own = snapshots.body.sections[before_plate]
    weights = np.eye(len(own)) if at is None else _between(own, at)

    def sections(name: str) -> tuple[np.ndarray, np.ndarray]:
        values, changes = (together(f"section_{name}{end}")[:, before_plate] for end in ("", "_jacobian"))
        return np.einsum("mk,nk...->nm...", weights, values), np.einsum("mk,nk...->nm...", weights, changes)

    (place, place_changes), (shorter, shorter_changes), (corners, corner_changes) = map(
        sections, ("place", "shortening", "corners")
    )
    return SectionStates(
        scene=description.scene,
        inputs=together("parameters"),
        lines=np.concatenate([np.full(int(part["converged"].sum()), k) for k, part in parts]),
        at=own if at is None else at,
        sections=_in_space(place, place_changes, *_unit(*sections("rotation"))),
        plate=_seen_from_plate(
            *(together(f"clamp_place{end}")[:, 0] for end in ("", "_jacobian")),
            *(together(f"plate_rotation{end}")[:, 0] for end in ("", "_jacobian")),
        ),
        shortenings=shorter,
        shortening_changes=shorter_changes,
        corners=corners,
        corner_changes=corner_changes,
        mirrors=mirrors(description.scene, snapshots.body.section_nodes),
    )


def _between(own: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights of cross-sections, shape (k,), by which polynomials interpolate between them, shape (m, k)."""
    first, shares = nearest_weights(own, at, NEAREST)
    weights = np.zeros((len(at), len(own)))
    np.put_along_axis(weights, first[:, None] + np.arange(shares.shape[1]), shares, axis=1)
    return weights


def _unit(quaternions: np.ndarray, changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions of unit length, shape (..., 4), and their derivatives, shape (..., 4, p)."""
    size = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    units, changed = quaternions / size, changes / size[..., None]
    return units, changed - units[..., None] * np.sum(units[..., None] * changed, axis=-2, keepdims=True)


def _in_space(
    places: np.ndarray, place_changes: np.ndarray, quaternions: np.ndarray, quaternion_changes: np.ndarray
) -> Bodies:
    """Bodies by places in space and quaternions, shapes (n, m, ...), and their derivatives, (n, m, ..., t + 6)."""
    scalar, vector = quaternions[..., :1, None], quaternions[..., 1:, None]
    change, turning = quaternion_changes[..., :1, :], quaternion_changes[..., 1:, :]
    turned = 2 * (scalar * turning - change * vector - np.cross(vector, turning, axis=-2))
    matrices = Rotation.from_quat(quaternions.reshape(-1, 4), scalar_first=True).as_matrix()
    rotation = matrices.reshape(*quaternions.shape[:-1], 3, 3)
    moved = np.swapaxes(rotation, -1, -2) @ place_changes
    return Bodies(places=places, rotations=rotation, motions=np.concatenate([moved, turned], axis=-2))


def _seen_from_plate(
    clamp: np.ndarray, clamp_changes: np.ndarray, quaternions: np.ndarray, quaternion_changes: np.ndarray
) -> Bodies:
    """The plate by the clamp's place seen from it and its quaternion, shapes (n, ...), and their derivatives."""
    poses = np.concatenate([clamp, quaternions], axis=1)
    rotation = rotations(poses)
    return Bodies(
        places=-np.einsum("nij,nj->ni", rotation, clamp),
        rotations=rotation,
        motions=motions(poses, np.concatenate([clamp_changes, quaternion_changes], axis=1)),
    )

"""One map of two meshes: many states on a coarse mesh, few on a fine one.

What a finer mesh changes in a pose is small and as smooth in tensions and wrench as the pose itself. So the fine
states are fitted by what they say beyond the coarse map, by products of a low degree (a control variate, see
rom.snapshots.mesh_transfer). The map is then of the fine mesh. Its error counts both fits: that of fine states
predicted without their lines, and that of the coarse map, which has seen these tensions. Nodes and points of the rubber
stay where the coarse mesh has them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count

import numpy as np

from rom.error_statistics import quantiles
from rom.fit.chebyshev import Polynomial
from rom.fit.mesh_error import covering
from rom.segment.field import Field
from rom.segment.segment_map import SegmentMap
from rom.segment.training.contact_error import place_errors, relative_force_errors
from rom.segment.training.field_fit import pod_modes, single
from rom.segment.training.index_set import index_set, pure_degree
from rom.segment.training.mirrors import with_images
from rom.segment.training.pose_fit import SHARE, supported
from rom.segment.training.regression import Samples, correction
from rom.snapshots.pressed_states import PressedStates, read_pressed_states, seen_from_plate
from rom.snapshots.snapshot_set import SnapshotSet

PURE = 0, 1, 2, 3, 4, 6, 8  # degrees of tensions alone that are tried
LOWEST, STEP = 0.0, 0.5  # weighted degree a search begins with, and by how much it grows


def corrected(before: SegmentMap, coarse: SnapshotSet, fine: SnapshotSet) -> SegmentMap:
    """The map of a coarse set, corrected by a set on a finer mesh (`rom.snapshots.mesh_transfer.check_pair`).

    Args:
        before: the map of the coarse set.
        coarse: that set.
        fine: the set on the finer mesh.
    """
    description = fine.description
    own = read_pressed_states(fine, on=coarse)
    states = with_images(own, description.scene)
    weights = tuple(before.provenance["weights"])
    pose, poses = corrected_pose(before.pose, weights, states)
    errors = relative_force_errors(states, poses)
    free, by_force = place_errors(states, np.linalg.norm(poses[:, :3] - states.poses[:, :3], axis=1), covering)
    corners, _ = _others(before.corners, own, own.corners, own.corner_jacobians)
    skin, skin_off = _others(before.skin, own, own.skin, own.skin_jacobians)
    shortenings, short_off = _others(before.shortenings, own, own.shortenings, own.shortening_jacobians)
    return replace(
        before,
        pose=pose,
        force_error=float(np.hypot(covering(errors[~np.isnan(errors)]), before.force_error)),
        place_error=float(np.hypot(free, before.place_error)),
        place_error_by_force=float(np.hypot(by_force, before.place_error_by_force)),
        corners=corners,
        skin=skin,
        skin_error=_percentile(skin_off, 3),
        displacements=None if before.displacements is None else _field(before.displacements, fine, coarse, own),
        shortenings=shortenings,
        shortening_error=_percentile(short_off, 1),
        scene=description.scene,
        provenance={
            "fingerprint": description.fingerprint,
            "versions": description.versions,
            "states": fine.states,
            "failed": len(fine.failures),
            "weights": before.provenance["weights"],
            "degree": before.provenance["degree"],
            "left_out": quantiles(errors),
            "coarse": before.provenance | {"mesh": coarse.description.scene["mesh"]},
        },
    )


def corrected_pose(
    before: Polynomial, weights: tuple[float, ...], states: PressedStates
) -> tuple[Polynomial, np.ndarray]:
    """Poses of a coarse mesh, corrected by those products of fine states that predict best.

    Args:
        before: poses of the coarse mesh.
        weights: of its products.
        states: of the fine mesh, n with their images.

    Returns:
        the polynomial; and poses without each one's line, shape (n, 7).
    """
    samples = Samples.of(states, states.poses, states.jacobians)
    tried = [correction(before, samples, powers) for powers in _sets(weights, states, before.powers)]
    return min(tried, key=lambda one: float(np.nanquantile(relative_force_errors(states, one[1]), SHARE)))


def _sets(weights: tuple[float, ...], states: PressedStates, among: np.ndarray) -> Iterator[np.ndarray]:
    """Index sets of few products, all of them among others and supported by states with their images."""
    tensions, known = states.tensions, {tuple(row) for row in among.tolist()}
    each, seen = np.repeat(weights, [tensions, 3, 3]), set()
    for degree in count(LOWEST, STEP):
        sets = [index_set(each, degree, tensions, pure_degree(tensions, highest)) for highest in PURE]
        if not any(supported(found, states, len(found)) for found in sets):
            return
        for found in sets:
            powers = np.array([row for row in found.tolist() if tuple(row) in known])
            if supported(found, states, len(found)) and (key := powers.tobytes()) not in seen:
                seen.add(key)
                yield powers


def _others(
    before: Polynomial | None, states: PressedStates, values: np.ndarray, jacobians: np.ndarray
) -> tuple[Polynomial | None, np.ndarray]:
    """The correction of values that predicts best, and what is off where lines are left out, shape (n, m)."""
    if before is None:
        return None, np.zeros((0, 0))
    samples = Samples.of(states, values, jacobians)
    tried = [correction(before, samples, powers) for powers in _sets((1.0, 1.0, 1.8), states, before.powers)]
    found, predicted = min(
        tried, key=lambda one: float(np.quantile(np.abs(one[1] - samples.values).max(axis=1), SHARE))
    )
    return found, predicted - samples.values


def _percentile(off: np.ndarray, size: int) -> float:
    """95th percentile of vectors of a size in rows [m]; nan if there are none."""
    return float(np.quantile(np.linalg.norm(off.reshape(-1, size), axis=1), 0.95)) if off.size else np.nan


def _field(before: Field, fine: SnapshotSet, coarse: SnapshotSet, states: PressedStates) -> Field:
    """The coarse field with modes of what the fine states differ from it by."""
    n, p = states.inputs.shape
    everywhere = np.arange(len(coarse.nodes))
    places, changes = seen_from_plate(fine, states.poses, states.jacobians, everywhere, coarse)
    values, slopes = before.amounts.value_and_gradient(states.inputs)
    beyond = (places - before.mean).reshape(n, -1) - values @ before.modes
    modes = single(pod_modes(beyond))
    nothing = replace(before.amounts, coefficients=np.zeros((len(before.amounts.powers), len(modes))))
    jacobians = np.einsum("nmp,km->nkp", changes.reshape(n, -1, p), modes, optimize=True)
    jacobians -= np.einsum("nlp,lm,km->nkp", slopes, before.modes, modes, optimize=True)
    amounts, off = _others(nothing, states, beyond @ modes.T, jacobians)
    assert amounts is not None
    left = beyond - (beyond @ modes.T + off) @ modes
    most = np.linalg.norm(left.reshape(n, -1, 3), axis=2).max(axis=1)
    both = Polynomial.together([before.amounts, amounts])
    return replace(
        before,
        modes=np.concatenate([before.modes, modes]),
        amounts=replace(both, coefficients=single(both.coefficients)),
        error=float(np.quantile(most, 0.95)),
    )

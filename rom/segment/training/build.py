"""A set of pressed states -> the map of a segment, and its error on held-out ones."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np

from rom.error_statistics import quantiles
from rom.file_kinds import uses_of
from rom.fit.chebyshev import Polynomial, total_degree
from rom.segment.segment_map import SegmentMap
from rom.segment.training.contact_error import place_errors, relative_force_errors
from rom.segment.training.field_fit import field_fit
from rom.segment.training.index_set import index_set, pure_degree
from rom.segment.training.mesh_correction import corrected
from rom.segment.training.mirrors import with_images
from rom.segment.training.pose_fit import best_fit
from rom.segment.training.regression import Samples, regression
from rom.snapshots import mesh_transfer
from rom.snapshots.description import difference
from rom.snapshots.pressed_states import PressedStates, read_pressed_states
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.snapshots.training_states import check_count
from rom.terminal import Progress, quiet

logger = logging.getLogger(__name__)
# Of the rubber's points and of displacements: most products, the degree of tensions alone and most of their
# products. They err by some 10 um.
FEW_TERMS, FEW_PURE, FEW_PURE_TERMS = 400, 8, 100
FEW_ROWS = 1.5  # rows for every coefficient of these, at least [-]
BENDING = 3  # total degree of the tensions by which the plate is bent
TERMS = 2500  # most products of a map: a query takes as long as it has terms


def train(
    snapshots: SnapshotSet, terms: int = TERMS, coarse: SnapshotSet | None = None, *, progress: Progress = quiet
) -> SegmentMap:
    """Build the map of a training set; states may have failed.

    Args:
        snapshots: the set, of a scene with a load.
        terms: most products of polynomials.
        coarse: states of the same finger on a coarser mesh, whose map this set corrects.
        progress: is told how far it is.

    Raises:
        SnapshotError: a held-out set, one without a load, or of several segments, or without an answer; or the two do
            not belong together.
    """
    if coarse is not None:
        mesh_transfer.check_pair(snapshots, coarse)
        return corrected(train(coarse, terms, progress=progress), coarse, snapshots)
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set{uses_of(snapshots.path)}")
    for task, inputs, reason in snapshots.failures:
        logger.warning("done without the failed state of %s at %s: %s", task, inputs.tolist(), reason)
    own = read_pressed_states(snapshots)
    check_count(snapshots)
    states = with_images(own, description.scene)
    box = np.array([[one["lower"], one["upper"]] for one in description.parameters])
    found = best_fit(states, box, terms, progress)
    free, by_force = place_errors(states, found.left_out_places, lambda errors: quantiles(errors)["p95"])
    few = few_products(found.weights, own)
    corners = corner_fit(own, box)
    skin, skin_error = skin_fit(own, box, few)
    shortenings, shortening_error = shortening_fit(own, box, few)
    return SegmentMap(
        parameters=description.parameters,
        pose=found.polynomial,
        force_error=quantiles(found.left_out)["p95"],
        place_error=free,
        place_error_by_force=by_force,
        corners=corners,
        skin=skin,
        skin_error=skin_error,
        displacements=field_fit(snapshots, own, box, few),
        shortenings=shortenings,
        shortening_error=shortening_error,
        scene=description.scene,
        provenance={
            "fingerprint": description.fingerprint,
            "versions": description.versions,
            "states": snapshots.states,
            "failed": len(snapshots.failures),
            "weights": found.weights,
            "degree": found.degree,
            "left_out": quantiles(found.left_out),
        },
    )


def few_products(weights: tuple[float, float, float], states: PressedStates) -> np.ndarray:
    """The index set of what need not be as accurate as poses, shape (k, t + 6)."""
    tensions, (n, p) = states.tensions, states.inputs.shape
    most = min(FEW_TERMS, int(n * (1 + p) / FEW_ROWS))
    each = np.repeat(weights, [tensions, 3, 3])
    pure = pure_degree(tensions, FEW_PURE, min(FEW_PURE_TERMS, most // 3, int(states.tension_rows / FEW_ROWS)))
    sets = [index_set(each, degree, tensions, pure) for degree in np.arange(1.0, 12.0, 0.5)]
    return max((powers for powers in sets if len(powers) <= most), key=len)


def corner_fit(states: PressedStates, box: np.ndarray) -> Polynomial | None:
    """How far the plate's corners are from those of a box, by the tensions.

    What presses on the plate bends it a hundredth as much.
    """
    if not states.corners.shape[1]:
        return None
    tensions = total_degree(states.tensions, BENDING)
    known = Samples.of(states, states.corners, states.corner_jacobians)
    return regression(known, box, np.pad(tensions, [(0, 0), (0, 6)]))[0]


def skin_fit(states: PressedStates, box: np.ndarray, powers: np.ndarray) -> tuple[Polynomial | None, float]:
    """The rubber's points by products of the inputs, and the 95th percentile of their errors [m]."""
    if not states.skin.shape[1]:
        return None, np.nan
    found, predicted = regression(Samples.of(states, states.skin, states.skin_jacobians), box, powers)
    off = np.linalg.norm(predicted.reshape(states.skin.shape) - states.skin, axis=2)
    return found, float(np.quantile(off, 0.95))


def shortening_fit(states: PressedStates, box: np.ndarray, powers: np.ndarray) -> tuple[Polynomial | None, float]:
    """The tendons' shortenings by products of the inputs, and the 95th percentile of their errors [m]."""
    if not states.shortenings.shape[1]:
        return None, np.nan
    found, predicted = regression(Samples.of(states, states.shortenings, states.shortening_jacobians), box, powers)
    return found, float(np.quantile(np.abs(predicted - states.shortenings), 0.95))


def check(segment: SegmentMap, held_out: SnapshotSet) -> dict[str, Any]:
    """Compare a map with held-out or its training states: places, turns and contact forces that their errors mean.

    Raises:
        SnapshotError: a set of another scene.
    """
    description = held_out.description
    if description.fingerprint != segment.provenance["fingerprint"]:
        other = difference(segment.scene, description.scene)
        raise SnapshotError(f"{held_out.path}: must hold states of the map's scene: {other}")
    states = read_pressed_states(held_out)
    poses, _ = segment.pose.value_and_gradient(states.inputs)
    placed = segment.place(states.inputs)
    true = np.einsum("nij,nj->ni", placed.rotation, states.poses[:, :3])
    errors = relative_force_errors(states, poses)
    found: dict[str, Any] = {}
    if segment.displacements is not None and description.has_field:
        true_fields, fields = held_out.answered("displacement"), _on(held_out.nodes, segment, states.inputs)
        off, size = (np.linalg.norm(field, axis=(1, 2)) for field in (fields - true_fields, true_fields))
        found["displacement"] = quantiles(off[size > 0] / size[size > 0])  # a training set has the finger at rest
    if segment.shortenings is not None and states.shortenings.shape[1]:
        off = np.abs(segment.shortening(states.inputs) - states.shortenings).ravel()
        found["channel_shortening_m"] = quantiles(off)
    return found | {
        "states": len(states.inputs),
        "failed": len(held_out.failures),
        "training": not description.random,
        "place_m": quantiles(np.linalg.norm(placed.centre + true, axis=1)),
        "contact_force": quantiles(errors),
        "covered": float(np.mean(errors[~np.isnan(errors)] <= segment.force_error)),
    }


def _on(nodes: np.ndarray, segment: SegmentMap, inputs: np.ndarray) -> np.ndarray:
    """A map's displacements of nodes, shape (m, 3), at inputs, shape (n, t + 6); shape (n, m, 3) [m]."""
    assert segment.displacements is not None
    own, found = segment.displacements.nodes, segment.displacement(inputs)
    if len(own) == len(nodes):
        return found
    columns = found.reshape(len(inputs), -1).T
    return mesh_transfer.interpolation(own, nodes)(columns).T.reshape(len(inputs), -1, 3)

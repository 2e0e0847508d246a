"""A set of pressed states -> the map of a segment, and its error on held-out ones."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np

from rom.fit.chebyshev import Polynomial
from rom.segment.contact_error import relative_force_errors
from rom.segment.index_set import index_set, pure_degree
from rom.segment.mirrors import with_images
from rom.segment.pose_fit import best_fit
from rom.segment.regression import Samples, regression
from rom.segment.segment_map import SegmentMap, quantiles
from rom.snapshots.pressed_states import PressedStates, read_pressed_states
from rom.snapshots.snapshot_set import SnapshotError, SnapshotSet
from rom.terminal import Progress, quiet

logger = logging.getLogger(__name__)
SKIN_TERMS, SKIN_PURE = 400, 8  # most products of the skin, and the degree of tensions alone: it errs by some 10 um
SKIN_PURE_TERMS = 100  # most products of tensions alone in it
TERMS = 2500  # most products of a map: a query takes as long as it has terms


def train(snapshots: SnapshotSet, terms: int = TERMS, *, progress: Progress = quiet) -> SegmentMap:
    """Build the map of a training set; states may have failed.

    Args:
        snapshots: the set, of a scene with a load.
        terms: most products of polynomials.
        progress: is told how far it is.

    Raises:
        SnapshotError: a held-out set, one without a load, or of several segments, or without an answer.
    """
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set, got a held-out one")
    for task, inputs, reason in snapshots.failures:
        logger.warning("done without the failed state of %s at %s: %s", task, inputs.tolist(), reason)
    own = read_pressed_states(snapshots)
    states = with_images(own, description.scene)
    box = np.array([[one["lower"], one["upper"]] for one in description.parameters])
    found = best_fit(states, box, terms, progress)
    skin, skin_error = skin_fit(own, box, found.weights)
    return SegmentMap(
        parameters=description.parameters,
        pose=found.polynomial,
        force_error=quantiles(found.left_out)["p95"],
        place_error=quantiles(found.left_out_places[states.forces == 0])["p95"],
        skin=skin,
        skin_error=skin_error,
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


def skin_fit(
    states: PressedStates, box: np.ndarray, weights: tuple[float, float, float]
) -> tuple[Polynomial | None, float]:
    """The rubber's points by the inputs, of a low degree, and the 95th percentile of their errors [m]."""
    n, p = states.inputs.shape
    if not states.skin.shape[1]:
        return None, np.nan
    known = Samples(
        inputs=states.inputs,
        values=states.skin.reshape(n, -1),
        jacobians=states.skin_jacobians.reshape(n, -1, p),
        lines=states.lines,
    )
    each = np.repeat(weights, [states.tensions, 3, 3])
    pure = pure_degree(states.tensions, SKIN_PURE, SKIN_PURE_TERMS)
    sets = [index_set(each, degree, states.tensions, pure) for degree in np.arange(2.0, 12.0, 0.5)]
    powers = max((powers for powers in sets if len(powers) <= SKIN_TERMS), key=len)
    found, predicted = regression(known, box, powers)
    off = np.linalg.norm(predicted.reshape(states.skin.shape) - states.skin, axis=2)
    return found, float(np.quantile(off, 0.95))


def check(segment: SegmentMap, held_out: SnapshotSet) -> dict[str, Any]:
    """Compare a map with held-out states: places, turns and the contact forces that their errors mean.

    Raises:
        SnapshotError: not a held-out set of the same scene.
    """
    description = held_out.description
    if not description.random or description.fingerprint != segment.provenance["fingerprint"]:
        raise SnapshotError(f"{held_out.path}: must be a held-out set of the map's scene")
    states = read_pressed_states(held_out)
    poses, _ = segment.pose.value_and_gradient(states.inputs)
    placed = segment.place(states.inputs)
    true = np.einsum("nij,nj->ni", placed.rotation, states.poses[:, :3])
    errors = relative_force_errors(states, poses)
    return {
        "states": len(states.inputs),
        "failed": len(held_out.failures),
        "place_m": quantiles(np.linalg.norm(placed.centre + true, axis=1)),
        "contact_force": quantiles(errors),
        "covered": float(np.mean(errors[~np.isnan(errors)] <= segment.force_error)),
    }

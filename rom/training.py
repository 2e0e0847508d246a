"""A snapshot set -> a surrogate: the free states by tensions, the contact states in contact-aligned coordinates."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rom.completion import Known, complete
from rom.enrichment import EnrichmentOptions, separate
from rom.responses import contact_outputs, contact_response, free_outputs, free_response, onset_response
from rom.separated import Separated
from rom.snapshots import SnapshotError, SnapshotSet
from rom.surrogate import Surrogate

logger = logging.getLogger(__name__)


def train(snapshots: SnapshotSet, options: EnrichmentOptions) -> Surrogate:
    """Build the surrogate of a training set; lines that refine it may be missing or failed, its first grid may not.

    Raises:
        SnapshotError: a held-out set, a state that did not converge, or tensions that never reach the plane.
    """
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set, got a held-out set (made with --random)")
    snapshots.check_first_grid()
    for task, parameters, reason in snapshots.failures:
        logger.warning("done without the failed state of %s at %s: %s", task, parameters.tolist(), reason)
    if snapshots.missing:
        logger.warning("done without %d lines that are not solved yet", len(snapshots.missing))
    values, jacobian = free_outputs(snapshots)
    forms = {"free": _form("free", free_response(snapshots, values, jacobian), options)}
    if description.has_obstacle:
        heights, reach = snapshots.values("free", "edge_heights"), snapshots.values("free", "touch_distance")
        if np.abs(heights.max(axis=-1) - reach).max() > 1e-6:
            raise SnapshotError(f"{snapshots.path}: somewhere a face bulges farther towards the plane than its edges")
        forms["onset"] = _form("onset", onset_response(snapshots), options)
        forms["contact"] = _form("contact", contact_response(snapshots, *contact_outputs(snapshots)), options)
    if description.has_field:
        forms["free_displacement"] = _field("free", snapshots, free_response, options)
        if description.has_obstacle:
            forms["contact_displacement"] = _field("contact", snapshots, contact_response, options)
    return Surrogate(
        parameters=description.parameters,
        forms=forms,
        lead=description.lead,
        nodes=snapshots.nodes,
        scene=description.scene,
        accuracy={},
        provenance={
            "fingerprint": description.fingerprint,
            "versions": description.versions,
            "states": snapshots.states,
            "failed": len(snapshots.failures),
            "newton_iterations": snapshots.iterations,
            "tolerance": options.tolerance,
        },
    )


def _field(kind: str, snapshots: SnapshotSet, response: Callable[..., Known], options: EnrichmentOptions) -> Separated:
    """Separate the displacement of all nodes, in the basis of its principal components: far smaller arrays."""
    field = snapshots.values(kind, "displacement").reshape(-1, snapshots.nodes.size)
    basis = _principal(field.T, options)
    jacobian = None
    if snapshots.description.refines:
        slopes = snapshots.values(kind, "displacement_jacobian")
        slopes = slopes.reshape(*slopes.shape[:2], -1) @ basis.astype(slopes.dtype)
        jacobian = slopes.transpose(0, 2, 1).astype(float)
    form = _form(f"{kind}_displacement", response(snapshots, field @ basis, jacobian), options, proportions=True)
    return replace(form, modes=basis @ form.modes)


def _form(name: str, response: Known, options: EnrichmentOptions, proportions: bool = False) -> Separated:
    """Separate a function on a grid, by splines.

    Every component counts alike, whatever its unit, unless they have one unit and shall keep their proportions.
    """
    values = complete(response).values
    if not response.axes:
        return Separated(nodes=[], kinds=[], factors=[], modes=values.reshape(-1, 1), errors=np.zeros(1))
    unfolded = np.moveaxis(values, -1, 0)
    m, grid = unfolded.shape[0], unfolded.shape[1:]
    scale = np.full(m, 1.0)
    if not proportions:
        scale = np.abs(unfolded).reshape(m, -1).max(axis=1)
        scale[scale == 0] = 1.0
    matrix = unfolded.reshape(m, -1) / scale[:, None]
    basis = _principal(matrix, options)  # most of it first: fewer, better terms
    factors, errors = separate((basis.T @ matrix).reshape(-1, *grid), options)
    if errors[-1] > options.tolerance:
        logger.warning(
            "%s: %d terms leave %.1e of the snapshots, not %.1e", name, len(errors), errors[-1], options.tolerance
        )
    return Separated(
        nodes=list(response.axes),
        kinds=["cubic"] * len(response.axes),
        factors=factors[1:],
        modes=scale[:, None] * (basis @ factors[0]),
        errors=errors,
    )


def _principal(matrix: np.ndarray, options: EnrichmentOptions) -> np.ndarray:
    """Orthonormal basis, shape (m, kept), of columns, shape (m, states), to a hundredth of the tolerance."""
    basis, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
    return basis[:, : max(1, int(np.count_nonzero(sizes > 0.01 * options.tolerance * max(sizes[0], 1e-300))))]

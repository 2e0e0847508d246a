"""A snapshot set -> a surrogate: the free states by tensions, the contact states in contact-aligned coordinates."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from rom.enrichment import EnrichmentOptions, separate
from rom.separated import Separated
from rom.snapshots import SnapshotError, SnapshotSet
from rom.surrogate import Surrogate

logger = logging.getLogger(__name__)


def train(snapshots: SnapshotSet, options: EnrichmentOptions) -> Surrogate:
    """Build the surrogate of a complete training set.

    Raises:
        SnapshotError: a held-out set, a state that did not converge, or tensions that never reach the plane.
    """
    description = snapshots.description
    if description.random:
        raise SnapshotError(f"{snapshots.path}: must be a training set, got a held-out set (made with --random)")
    if description.has_obstacle and np.isnan(snapshots.onset()).any():
        raise SnapshotError(f"{snapshots.path}: at some tensions the finger never reaches the nearest plane")
    if snapshots.failures:
        task, parameters, reason = snapshots.failures[0]
        raise SnapshotError(
            f"{snapshots.path}: {len(snapshots.failures)} of {snapshots.states} states did not converge, "
            f"first {task} at {parameters.tolist()}: {reason}"
        )
    axes = [np.array(nodes) for nodes in description.tension_nodes]
    outputs = [snapshots.free("tip")]
    forms: dict[str, Separated] = {}
    if description.has_obstacle:
        heights = snapshots.free("edge_heights")
        if np.abs(heights.max(axis=-1) - snapshots.free("touch_distance")).max() > 1e-6:
            raise SnapshotError(f"{snapshots.path}: somewhere a face bulges farther towards the plane than its edges")
        outputs.append(heights[..., _first_to_touch(heights)])
        forms |= _contact_forms(snapshots, axes, options)
    forms["free"] = _form("free", np.concatenate(outputs, axis=-1), axes, options)
    if description.has_field:
        field = snapshots.free("displacement")
        forms["free_displacement"] = _form("free_displacement", field.reshape(*field.shape[:-2], -1), axes, options)
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
            "newton_iterations": snapshots.iterations,
            "tolerance": options.tolerance,
        },
    )


def _first_to_touch(heights: np.ndarray) -> np.ndarray:
    """Nodes that lead the finger's reach in some free state."""
    return np.unique(heights.reshape(-1, heights.shape[-1]).argmax(axis=1))


def _contact_forms(
    snapshots: SnapshotSet, axes: Sequence[np.ndarray], options: EnrichmentOptions
) -> dict[str, Separated]:
    description = snapshots.description
    lead = description.lead
    others = [axis for k, axis in enumerate(axes) if k != lead]
    onset = snapshots.onset()
    aligned = [np.array(description.onset_nodes) if k == lead else axis for k, axis in enumerate(axes)]
    aligned.append(np.array(description.contact_nodes))

    def added(name: str) -> np.ndarray:
        """What contact adds to the free state at the same tensions."""
        values = snapshots.contact(name)
        return values - np.take(values, [0], axis=len(axes))

    answers = np.concatenate([added("tip"), added("contact_force")[..., None]], axis=-1)
    forms = {
        "onset": _form("onset", onset[..., None], others, options),
        "contact": _form("contact", answers, aligned, options),
    }
    if description.has_field:
        field = added("displacement")
        flat = field.reshape(*field.shape[:-2], -1)
        forms["contact_displacement"] = _form("contact_displacement", flat, aligned, options)
    return forms


def _form(name: str, values: np.ndarray, axes: Sequence[np.ndarray], options: EnrichmentOptions) -> Separated:
    """Separate values, shape (n_1, ..., n_k, m), over axes 1 to k, by splines."""
    if not axes:
        return Separated(nodes=[], kinds=[], factors=[], modes=values.reshape(-1, 1), errors=np.zeros(1))
    unfolded = np.moveaxis(values, -1, 0)
    m, grid = unfolded.shape[0], unfolded.shape[1:]
    # Every component counts alike, whatever its unit; a field's have one unit and keep their proportions.
    scale = np.full(m, 1.0)
    if m < 100:
        scale = np.abs(unfolded).reshape(m, -1).max(axis=1)
        scale[scale == 0] = 1.0
    matrix = unfolded.reshape(m, -1) / scale[:, None]
    # Long fields are separated in the basis of their principal components: same answer, far smaller arrays.
    basis, sizes, rows = np.linalg.svd(matrix, full_matrices=False)
    kept = max(1, int(np.count_nonzero(sizes > 0.01 * options.tolerance * max(sizes[0], 1e-300))))
    factors, errors = separate((sizes[:kept, None] * rows[:kept]).reshape(kept, *grid), options)
    if errors[-1] > options.tolerance:
        logger.warning(
            "%s: %d terms leave %.1e of the snapshots, not %.1e", name, len(errors), errors[-1], options.tolerance
        )
    return Separated(
        nodes=list(axes),
        kinds=["cubic"] * len(axes),
        factors=factors[1:],
        modes=scale[:, None] * (basis[:, :kept] @ factors[0]),
        errors=errors,
    )

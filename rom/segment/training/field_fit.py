"""The field of a segment by tensions and wrench: POD modes of a set's fields, and the regression of their amounts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rom.segment.field import Field
from rom.segment.training.regression import Samples, regression
from rom.snapshots.pressed_states import PressedStates, seen_from_plate
from rom.snapshots.snapshot_set import SnapshotSet

MOST_MODES = 60
LEFT = 1e-6  # what modes leave out, root of the mean square over states and nodes [m]


def field_fit(snapshots: SnapshotSet, states: PressedStates, box: np.ndarray, powers: np.ndarray) -> Field | None:
    """The field of a set's states by products of these powers, shape (k, t + 6); None if the set does not store it."""
    if not snapshots.description.has_field:
        return None
    nodes = snapshots.nodes
    places, changes = seen_from_plate(snapshots, states.poses, states.jacobians, np.arange(len(nodes)), snapshots)
    (n, p), mean = states.inputs.shape, single(places.mean(axis=0))
    fields = (places - mean).reshape(n, -1)
    modes = single(pod_modes(fields))
    jacobians = np.einsum("nmp,km->nkp", changes.reshape(n, -1, p), modes, optimize=True)
    polynomial, predicted = regression(Samples.of(states, fields @ modes.T, jacobians), box, powers)
    amounts = replace(polynomial, coefficients=single(polynomial.coefficients))
    off = np.linalg.norm((predicted @ modes - fields).reshape(n, -1, 3), axis=2).max(axis=1)
    return Field(nodes=nodes, mean=mean, modes=modes, amounts=amounts, error=float(np.quantile(off, 0.95)))


def single(values: np.ndarray) -> np.ndarray:
    """As a file holds them."""
    return np.asarray(values, np.float32).astype(float)


def pod_modes(fields: np.ndarray) -> np.ndarray:
    """Orthonormal modes, shape (k, m), of rows, shape (n, m), as few as leave out little."""
    _, sizes, modes = np.linalg.svd(fields, full_matrices=False)
    outside = np.sqrt(np.append(np.cumsum(sizes[::-1] ** 2)[::-1][1:], 0.0) / (fields.size / 3))
    count = min(int(np.argmax(outside <= LEFT)) + 1, MOST_MODES)
    return np.asarray(modes[:count])

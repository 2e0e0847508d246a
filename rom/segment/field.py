"""Where a segment's nodes are, seen from its plate: POD modes, and their amounts by tensions and wrench.

Seen from there a rod under a wrench is marched from tip to base, and smooth in both; from the clamp it is not so much.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rom.fit.chebyshev import Polynomial
from rom.segment.regression import Samples, regression
from rom.snapshots.pressed_states import PressedStates, seen_from_plate
from rom.snapshots.snapshot_set import SnapshotSet

MOST_MODES = 60
LEFT = 1e-6  # what modes leave out, root of the mean square over states and nodes [m]


@dataclass(frozen=True, kw_only=True)
class Field:
    """Places of nodes by the inputs.

    Attributes:
        nodes: at rest, in the finger's axes, shape (nodes, 3) [m].
        mean: of their places seen from the plate, shape (nodes, 3) [m].
        modes: orthonormal, shape (k, 3 nodes) [-].
        amounts: of these by the inputs, k values [m].
        error: largest of a state's nodes, predicted without its line, 95th percentile of the states [m].
    """

    nodes: np.ndarray
    mean: np.ndarray
    modes: np.ndarray
    amounts: Polynomial
    error: float

    def places(self, inputs: np.ndarray) -> np.ndarray:
        """Seen from the plate at inputs, shape (n, t + 6); shape (n, nodes, 3) [m]."""
        return np.asarray(self.mean + (self.amounts.value(inputs) @ self.modes).reshape(len(inputs), -1, 3))


def field_fit(snapshots: SnapshotSet, states: PressedStates, box: np.ndarray, powers: np.ndarray) -> Field | None:
    """The field of a set's states by products of these powers, shape (k, t + 6); None if the set does not store it."""
    if not snapshots.description.has_field:
        return None
    nodes = snapshots.nodes
    places, changes = seen_from_plate(snapshots, states.poses, states.jacobians, np.arange(len(nodes)), snapshots)
    (n, p), mean = states.inputs.shape, single(places.mean(axis=0))
    fields = (places - mean).reshape(n, -1)
    modes = single(pod_modes(fields))
    known = Samples(
        inputs=states.inputs,
        values=fields @ modes.T,
        jacobians=np.einsum("nmp,km->nkp", changes.reshape(n, -1, p), modes, optimize=True),
        lines=states.lines,
    )
    polynomial, predicted = regression(known, box, powers)
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

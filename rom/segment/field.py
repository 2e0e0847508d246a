"""Where a segment's nodes are, seen from its plate: POD modes, and their amounts by tensions and wrench.

Seen from there a rod under a wrench is marched from tip to base, and smooth in both; from the clamp it is not so much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rom.brief import brief
from rom.fit.chebyshev import Polynomial


@brief
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

"""What a controller drives: a finger whose tendons are pulled and whose contact force is felt."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from rom import Surrogate


class Plant(Protocol):
    """A finger, real or simulated."""

    def pull(self, tensions: ArrayLike) -> float:
        """Set the tensions [N], shape (tensions,), let the finger come to rest, return the contact force felt [N]."""
        ...


class SimulatedPlant:
    """A finger played by a surrogate, in front of a plane that the controller does not know.

    Args:
        model: the surrogate.
        distance: of the plane [m].
        noise: standard deviation of the force sensor [N].
        seed: of the noise.
    """

    def __init__(self, model: Surrogate, distance: float, noise: float = 0.0, seed: int = 0):
        self._model, self._distance, self._noise = model, distance, noise
        self._random = np.random.default_rng(seed)

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant.

        Raises:
            ValueError: tensions or plane outside the trained box: the model cannot play such a finger.
        """
        point = np.append(tensions, self._distance)
        answer = self._model.evaluate(point)
        if not answer.inside:
            raise ValueError(f"tensions and d must lie in the trained box, got {point.tolist()}")
        return float(answer.contact_force) + self._noise * float(self._random.standard_normal())

"""The full-order model as what a controller drives: tendons pulled, contact force felt."""

import numpy as np
from numpy.typing import ArrayLike

from fingerfem.equilibrium.failures import LoadNotReached
from fingerfem.model import FingerModel


class FullOrderPlant:
    """The full-order finger in front of a plane; a plant as control.plant has them.

    A pull goes on from the last one's equilibrium, and begins from rest where there is none or where that does not lead
    there. Several plants may share a model.

    Attributes:
        contact_force: after the last pull [N].
        solves: how many there were.

    Args:
        model: of a scene with an obstacle.
        distance: of the plane [m].

    Raises:
        ValueError: a distance that the scene does not allow.
    """

    def __init__(self, model: FingerModel, distance: float):
        model.check_loads([one["lower"] for one in model.scene.parameters[: len(model.scene.actuators)]], distance)
        self.contact_force, self.solves = 0.0, 0
        self._model, self._distance = model, distance
        self._last: tuple[np.ndarray, np.ndarray] | None = None  # tensions and displacement

    def pull(self, tensions: ArrayLike) -> float:
        """Contact force [N] at these tensions [N], then pressures [Pa], shape (actuators,).

        Raises:
            ValueError: tensions that the scene does not allow.
            LoadNotReached: no equilibrium was found.
        """
        model, continuation = self._model, self._model.continuation
        model.check_loads(tensions, self._distance)
        if not self._goes_on(tensions):
            continuation.rest()
            continuation.advance(tensions, None)
            continuation.advance(tensions, self._distance)
        contact = model.problem.contact
        assert contact is not None
        self._last = np.array(tensions, float), model.problem.displacement.copy()
        self.solves += 1
        self.contact_force = contact.force()
        return self.contact_force

    def _goes_on(self, tensions: ArrayLike) -> bool:
        """Continues the last pull's equilibrium to these tensions; False if that fails."""
        if self._last is None:
            return False
        before, displacement = self._last
        self._model.continuation.start(before, self._distance, displacement)
        try:
            self._model.continuation.advance(tensions, self._distance)
        except LoadNotReached:
            return False
        return True

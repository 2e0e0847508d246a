"""The full-order model as what a controller drives: tendons pulled, contact force felt."""

from __future__ import annotations

from numpy.typing import ArrayLike

from fingerfem.model import FingerModel


class FullOrderPlant:
    """The full-order finger in front of a plane; a plant as control.plant has them.

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
        model.check_loads([tendon.tension[0] for tendon in model.scene.tendons], distance)
        self.contact_force, self.solves = 0.0, 0
        self._model, self._distance = model, distance

    def pull(self, tensions: ArrayLike) -> float:
        """Contact force [N] at these tensions [N], shape (tendons,), solved from rest.

        Raises:
            ValueError: tensions that the scene does not allow.
            LoadNotReached: no equilibrium was found.
        """
        state = self._model.solve(tensions, self._distance, sensitivities=False)
        assert state.contact_force is not None
        self.solves += 1
        self.contact_force = state.contact_force
        return self.contact_force

"""The interface of models for controllers."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from rom.answer import Answer
from rom.parameter import Parameter


class Model(Protocol):
    """A finger's answers by tensions and, where it has an obstacle, that one's distance: p parameters.

    `rom.TouchedSegment` is one, and `rom.SeparatedModel`.
    """

    @property
    def has_obstacle(self) -> bool:
        """True if the model has a distance and a contact force."""

    @property
    def has_pad(self) -> bool:
        """True if the model has a pad's pressure."""

    @property
    def parameters(self) -> list[Parameter]:
        """Tensions, then distances."""

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends, shapes (p,) [N, m]."""

    @property
    def lead(self) -> int:
        """The tension that pushes most towards the obstacle."""

    @property
    def scene(self) -> dict[str, Any]:
        """The trained scene."""

    @property
    def native(self) -> dict[str, Any]:
        """Its own fields of a struct control_finger."""

    def outputs(self, points: np.ndarray) -> np.ndarray:
        """Tip [m], contact force [N], touch distance [m], and pad pressure [Pa] if it has one, shape (n, 5 or 6)."""

    def evaluate(self, parameters: ArrayLike, d: ArrayLike | None = None) -> Answer:
        """The same with estimated errors, at one point or many."""

    def jacobian(self, parameters: ArrayLike) -> np.ndarray:
        """Derivatives of the outputs at one point, shape (5 or 6, p)."""

"""A finger that moves, simulated by rod elements in steps of time, before an object that is not seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from control.plant import Flaws, Sensor
from rom.rod.motion.moving_finger import MotionState, MovingFinger
from rom.rod.touched_rod import TouchedRod


class MovingPlant:
    """A finger pulled by tensions that change linearly in a period; it has mass, and does not come to rest between.

    Attributes:
        state: after the last pull; None before the first.
        age: of the last reading [s].

    Args:
        model: of the finger before one object.
        distance: of the object [m].
        density: of the rubber [kg/m^3]; that of the scene's [gravity] if left out.
        flaws: none if left out; their period is that from pull to pull [s].
        seed: of the noise.
        steps: of time in a period.

    Raises:
        ModelError: no density, or the object touches the finger without tensions.
    """

    def __init__(
        self,
        model: TouchedRod,
        distance: float,
        density: float | None = None,
        flaws: Flaws | None = None,
        seed: int = 0,
        steps: int = 1,
    ):
        self.state: MotionState | None = None
        self.age, self._distance, self._steps, self._flaws = 0.0, distance, steps, flaws or Flaws()
        self._sensor = Sensor(self._flaws, seed)
        rest = np.append(np.zeros(len(model.rod.names)), distance)
        self._finger, self._tensions = MovingFinger(model, rest, density), rest[:-1]

    @property
    def contact_force(self) -> float:
        """The true one, after the last pull [N]."""
        return 0.0 if self.state is None else (1 + self._flaws.force_error) * float(self.state.contact_forces[0])

    def pull(self, tensions: ArrayLike) -> float:
        """See Plant.

        Raises:
            ValueError: the finger moves out of the domain of its elements, or no step was found.
        """
        goal, begun, length = np.asarray(tensions, float), self._tensions, self._flaws.period / self._steps
        for k in range(1, self._steps + 1):
            now = goal if k == self._steps else begun + k / self._steps * (goal - begun)
            self.state = self._finger.step(np.append(now, self._distance), length)
            if self.state.status != "converged":
                raise ValueError(
                    f"tensions must keep the finger where its elements were trained, got {self.state.status} at "
                    f"{goal.tolist()}, {self.state.time:.4g} s"
                )
        self._tensions = goal
        felt, self.age = self._sensor.read(self.contact_force), self._sensor.age
        return felt

"""Random solids, errors of the gripper's position, and flaws of sensors: the same ones for a number, every time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from control import Flaws, GraspOptions
from control.mujoco.resting import at_rest
from control.mujoco.solids import Solid, random_error, random_solid

PERIOD = 0.005  # of the controllers and sensors [s]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A random solid at rest on a table, and how a gripper misses it.

    Attributes:
        number: of the trial.
        solid: at rest.
        rolled: whether it rolled to its rest from the orientation in which it was drawn.
        error: of the gripper's position, shape (3,) [m].
        flaws: of every finger's sensor.
    """

    number: int
    solid: Solid
    rolled: bool
    error: np.ndarray
    flaws: Flaws

    @property
    def options(self) -> GraspOptions:
        """Those that the noise of the sensors determines."""
        return GraspOptions(noise=self.flaws.noise, period=PERIOD)

    @property
    def least_felt(self) -> float:
        """Smallest contact force that a finger distinguishes from none [N]."""
        return 1.05 * self.options.least_target


def trial(number: int, shape: str) -> Trial:
    """The same one for a number, every time."""
    random = np.random.default_rng([2018, number])
    drawn = random_solid(random, shape)
    error = random_error(random)
    flaws = Flaws(noise=random.uniform(0.002, 0.02), resolution=0.005, delay=int(random.integers(0, 4)), period=PERIOD)
    solid = at_rest(drawn)
    rolled = abs(np.ptp(solid.corners[:, 2]) - np.ptp(drawn.corners[:, 2])) > 1e-9
    return Trial(number=number, solid=solid, rolled=bool(rolled), error=error, flaws=flaws)

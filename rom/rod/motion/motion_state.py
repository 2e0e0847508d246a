"""State of a moving finger at the end of a step."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rom.brief import brief

Status = Literal["converged", "out_of_domain", "no_equilibrium"]


@brief
@dataclass(frozen=True, kw_only=True)
class MotionState:
    """Position and velocity of a finger at the end of a step, seen from its base.

    Attributes:
        status: `out_of_domain` outside the trained domain of the elements; `no_equilibrium` if the shortest step has no
            solution: the finger then keeps its state from before the step, and numbers are nan.
        time: at the end of the step [s].
        tip: displacement of the tip plate's centre, shape (3,) [m].
        velocity: of the tip plate's centre, shape (3,) [m/s].
        contact_forces: mean over the last step on every object against its direction, shape (m,) [N].
        kinetic_energy: of the finger [J].
        dissipated: by friction of tendons in their guides since the beginning [J].
    """

    status: Status
    time: float
    tip: np.ndarray
    velocity: np.ndarray
    contact_forces: np.ndarray
    kinetic_energy: float
    dissipated: float

"""Tensions of motors that overcome friction of the tendons in their guides."""

from __future__ import annotations

import numpy as np

from control.tracking.inverse import Bounds
from rom.rod.guides.guided_finger import GuidedFinger
from rom.rod.touched_segment import TouchedSegment

ITERATIONS = 60  # largest number of a row; most are needed where a tendon reverses
CLOSE = 1e-4  # largest error of a mean tension, over its limits' range [-]


def motor_tensions(model: TouchedSegment, pulled: np.ndarray, friction: float, bounds: Bounds) -> np.ndarray:
    """Tensions of motors by which the free finger's elements have the means `pulled`, both of shape (n, t) [N].

    Rows are a history from rest. An increment without an equilibrium leaves its row without compensation.
    """
    finger, found, start = GuidedFinger(model=model.rod, friction=friction), pulled.copy(), pulled[0]
    close = CLOSE * (bounds[1] - bounds[0])
    for row, wanted in enumerate(pulled):
        before = finger.arrays.keep()
        for _ in range(ITERATIONS):
            finger.arrays.restore(before)
            state = finger.advance(np.clip(start, *bounds))
            if state.status == "no_equilibrium":
                break
            found[row] = np.clip(start, *bounds)
            missing = wanted - state.element_tensions.mean(axis=0)
            start = start + missing
            if (np.abs(missing) <= close).all():
                break
    return found

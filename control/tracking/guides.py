"""Tensions of motors that overcome friction of the tendons in their guides."""

from __future__ import annotations

import numpy as np

from control.tracking.inverse import Bounds
from rom.rod.guides.guided_finger import GuidedFinger
from rom.rod.touched_segment import TouchedSegment

ITERATIONS = 4  # of a row; friction of 0.2 leaves 0.1 % of its loss


def motor_tensions(model: TouchedSegment, pulled: np.ndarray, friction: float, bounds: Bounds) -> np.ndarray:
    """Tensions of motors by which the free finger's elements have the means `pulled`, both of shape (n, t) [N].

    Rows are a history from rest. An increment without an equilibrium leaves its row without compensation.
    """
    finger, found, start = GuidedFinger(model=model.rod, friction=friction), pulled.copy(), pulled[0]
    for row, wanted in enumerate(pulled):
        before = finger.arrays.keep()
        for _ in range(ITERATIONS):
            finger.arrays.restore(before)
            state = finger.advance(np.clip(start, *bounds))
            if state.status == "no_equilibrium":
                break
            found[row] = np.clip(start, *bounds)
            start = start + wanted - state.element_tensions.mean(axis=0)
    return found

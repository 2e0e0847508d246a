"""Tensions of motors that overcome friction of the tendons in their guides."""

from __future__ import annotations

import numpy as np

from control.tracking.inverse import Bounds
from control.tracking.plan import Plan
from rom.rod.guides.guided_finger import GuidedFinger
from rom.rod.touched_segment import TouchedSegment

ITERATIONS = 60  # largest number of a row; most are needed where a tendon reverses
CLOSE = 1e-4  # largest error of a tension, over its limits' range [-]


def motor_tensions(model: TouchedSegment, plan: Plan, friction: float, bounds: Bounds) -> np.ndarray:
    """Tensions of motors with which the free tip rests where the plan's tensions hold it without friction.

    Tension falls from the motor to the tip, and the clamp's end bends the finger with a longer lever: a tendon's mean
    alone does not determine the tip. It selects one of several solutions.

    Returns:
        Shape (n, t) [N]. Rows are a history from rest. A row without an equilibrium is not compensated.
    """
    pulled = plan.tensions
    finger, found, start = GuidedFinger(model=model.rod, friction=friction), pulled.copy(), pulled[0]
    tips = model.outputs(np.column_stack([pulled, np.full(len(pulled), np.inf)]))[:, 1:3]
    close = CLOSE * (bounds[1] - bounds[0])
    for row, wanted in enumerate(pulled):
        before, gains, motions = finger.arrays.keep(), plan.gains[row], plan.motions[row]
        for _ in range(ITERATIONS):
            finger.arrays.restore(before)
            state = finger.advance(np.clip(start, *bounds))
            if state.status == "no_equilibrium":
                break
            found[row] = np.clip(start, *bounds)
            means = wanted - state.element_tensions.mean(axis=0)
            missing = means + gains @ (tips[row] - state.tip[1:] - motions @ means)
            start = start + missing
            if (np.abs(missing) <= close).all():
                break
    return found

"""Tensions of motors that overcome friction of the tendons in their guides."""

import numpy as np

from control.outcomes import listed
from control.tracking.inverse import Bounds
from control.tracking.plan import Plan
from rom.rod.guides.guided_finger import GuidedFinger
from rom.rod.touched_segment import TouchedSegment

ITERATIONS = 60  # largest number of a row; most are needed where a tendon reverses
CLOSE = 1e-4  # largest error of a tension, over its limits' range [-]
NEAR = 1e-4  # largest distance of the resting tip from the plan's that counts as compensated [m]


def compensated(plan: Plan, model: TouchedSegment, friction: float, bounds: Bounds) -> Plan:
    """Return the plan with motor tensions with which the free tip rests where the plan holds it without friction.

    Tension falls from the motor to the tip, and the clamp's end bends the finger with a longer lever: a tendon's mean
    alone does not determine the tip. It selects one of several solutions. Rows are a history from rest. A plan with a
    row that is not compensated gets a reason to refuse it.
    """
    pulled, tensions, start = plan.tensions, plan.tensions.copy(), plan.tensions[0]
    finger = GuidedFinger(model=model.rod, friction=friction)
    tips = model.outputs(np.column_stack([pulled, np.full(len(pulled), np.inf)]))[:, 1:3]
    missed, close = np.full(len(pulled), np.inf), CLOSE * (bounds[1] - bounds[0])
    for row, wanted in enumerate(pulled):
        before, gains, motions = finger.arrays.keep(), plan.gains[row], plan.motions[row]
        for _ in range(ITERATIONS):
            finger.arrays.restore(before)
            state = finger.advance(np.clip(start, *bounds))
            if state.status == "no_equilibrium":
                break
            tensions[row] = np.clip(start, *bounds)
            error = tips[row] - state.tip[1:]
            missed[row] = np.linalg.norm(error)
            means = wanted - state.element_tensions.mean(axis=0)
            missing = means + gains @ (error - motions @ means)
            start = start + missing
            if (np.abs(missing) <= close).all():
                break
    k = int(np.argmax(missed))
    if missed[k] <= NEAR:
        return plan._replace(tensions=tensions)
    return plan._replace(
        reason=f"path row {k} must be reached against friction of {friction:g} by tensions from {listed(bounds[0])} to "
        f"{listed(bounds[1])} N, got a distance of {missed[k]:.3g} m: move the path"
    )

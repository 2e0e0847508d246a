"""States between those of a line that differ in their contact regime: short regimes get some, long ones get ends."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fingerfem.model import FingerModel
from fingerfem.record import Record

REGIME_ENDS = 0.02  # share of the plane's way from touch to its nearest, to which the end of a regime is found


def halve(model: FingerModel, record: Record, tensions: np.ndarray, nearest: float) -> int:
    """Halve the plane's way wherever two states beside each other differ in regime; returns the number of states.

    Args:
        model: the model, wherever it is.
        record: of a line at fixed tensions; the states are noted there.
        tensions: shape (tensions,) [N].
        nearest: distance of the plane [m].
    """
    states = sorted(record.contacts(), key=lambda state: -state.distance)
    if len(states) < 2:
        return 0
    shortest, count, added = REGIME_ENDS * (states[0].distance - nearest), len(states), 0
    pairs = list(pairwise(states))
    while pairs:
        far, near = pairs.pop(0)
        if np.array_equal(far.regime, near.regime) or far.distance - near.distance < 2 * shortest:
            continue
        model.stepper.start(tensions, far.distance, far.displacement)
        record.restarted()
        record.state(tensions, (far.distance + near.distance) / 2)
        added += 1
        found = record.contacts()
        if len(found) > count:  # else it has no answer, and says so
            count, middle = len(found), found[-1]
            pairs = [(far, middle), (middle, near), *pairs]
    return added

"""States between those of a line that differ in their contact regime: short regimes get some, long ones get ends.

A plate's edge or face that touches as a whole, as where a finger bends in the plane's normal, has its first state near
touch: unlike a corner's, its regime does not say by itself that the force begins at zero.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fingerfem.model import FingerModel
from fingerfem.snapshots.recorder import ContactState, Recorder
from rom.snapshots import contact_regimes

NEAR_TOUCH = 0.1  # share of the path from touch to the line's first distance past it
REGIME_ENDS = 0.02  # share of the whole contact path to which the end of a regime is found


def between(model: FingerModel, record: Recorder, tensions: np.ndarray, touch: float, nearest: float) -> int:
    """Solve what a line needs between its states; returns the number of states.

    Args:
        model: the model, wherever it is.
        record: of a line at fixed tensions; the states are noted there.
        tensions: shape (tensions,) [N].
        touch: distance of the plane where it is touched [m].
        nearest: distance of the plane [m].
    """
    states = sorted(record.contacts(), key=lambda state: -state.distance)
    if not states:
        return 0
    return _near_touch(model, record, tensions, touch, states[0]) + _halve(model, record, tensions, nearest, states)


def _near_touch(model: FingerModel, record: Recorder, tensions: np.ndarray, touch: float, first: ContactState) -> int:
    code = tuple(int(end) for end in first.regime)
    if contact_regimes.corner(code, model.scene.is_half) is not None:
        return 0
    _solve(model, record, tensions, first, touch - NEAR_TOUCH * (touch - first.distance))
    return 1


def _halve(
    model: FingerModel, record: Recorder, tensions: np.ndarray, nearest: float, states: list[ContactState]
) -> int:
    """Halve the path wherever two states beside each other differ in regime."""
    shortest, count, added = REGIME_ENDS * (states[0].distance - nearest), len(record.contacts()), 0
    pairs = list(pairwise(states))
    while pairs:
        far, near = pairs.pop(0)
        if np.array_equal(far.regime, near.regime) or far.distance - near.distance < 2 * shortest:
            continue
        _solve(model, record, tensions, far, (far.distance + near.distance) / 2)
        added += 1
        found = record.contacts()
        if len(found) > count:  # else it has no answer, and says so
            count, middle = len(found), found[-1]
            pairs = [(far, middle), (middle, near), *pairs]
    return added


def _solve(model: FingerModel, record: Recorder, tensions: np.ndarray, begin: ContactState, distance: float) -> None:
    model.continuation.start(tensions, begin.distance, begin.displacement)
    record.restarted()
    record.state(tensions, distance)

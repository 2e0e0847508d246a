"""A finger with friction of its tendons, along the poses of a log: its outputs and their derivatives.

The rows of a log are a history from rest. Between two poses tensions change along a straight line, without the object.
"""

from typing import NamedTuple

import numpy as np

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.rod.guides.guided_finger import GuidedFinger, GuideState
from rom.rod.touched_segment import TouchedSegment

INCREMENTS = 3  # between two poses
STEP = 0.05  # half width of central differences by a tension of the trained finger [N]


@brief
class GuidedValues(NamedTuple):
    """Outputs of a finger with t tendons in n poses, rows as in `control.calibration.scaled_finger.Outputs`.

    Attributes:
        values: shape (n, 7 + t), 0 for the turn.
        orientation: quaternions, shape (n, 4) [-].
        by_tension: by the tensions of the same pose, shape (n, 7 + t, t); None if not asked for.
        inside: whether the finger is within its trained domain, shape (n,).
    """

    values: np.ndarray
    orientation: np.ndarray
    by_tension: np.ndarray | None
    inside: np.ndarray


def along(model: TouchedSegment, points: np.ndarray, friction: float, derivatives: bool = True) -> GuidedValues:
    """The finger along points, shape (n, t + 1) [N, m], with d infinite where there is no object.

    Raises:
        ModelError: an increment without an equilibrium: one line with the pose's number.
    """
    touched = bool(np.isfinite(points[:, -1]).any())
    finger = GuidedFinger(model=model if touched else model.rod, friction=max(friction, 0.0))
    t, begun, states, rates = points.shape[1] - 1, finger.arrays.motors.copy(), list[GuideState](), []
    for row, point in enumerate(points):
        free = [np.inf] if touched else []
        for k in range(1, INCREMENTS):
            finger.advance([*(begun + k / INCREMENTS * (point[:t] - begun)), *free])
        before, was_inside, own = finger.arrays.keep(), finger.inside, point if touched else point[:t]
        if derivatives:  # at the ends of the domain, differences reach beyond
            rates.append(np.stack([_rate(finger, before, own, k) for k in range(t)], axis=-1))
            finger.arrays.restore(before)
            finger.inside = was_inside
        states.append(finger.advance(own))
        if states[-1].status == "no_equilibrium":
            raise ModelError(f"pose {row + 1} must have an equilibrium with friction {friction:g}, got none")
        begun = point[:t]
    values = np.array([_row(one, model.rod.rest) for one in states])
    inside = np.array([one.status == "converged" for one in states])
    orientation = np.array([one.orientation for one in states])
    return GuidedValues(values, orientation, np.array(rates) if derivatives else None, inside)


def _rate(finger: GuidedFinger, before: list[np.ndarray], point: np.ndarray, k: int) -> np.ndarray:
    """Central difference by one tension of the increment to a point, shape (7 + t,)."""
    ends = []
    for way in (STEP, -STEP):
        finger.arrays.restore(before)
        ends.append(finger.advance(point + way * (np.arange(len(point)) == k)))
    ahead, behind = ends
    difference = (_row(ahead, np.zeros(3)) - _row(behind, np.zeros(3))) / (2 * STEP)
    difference[3:6] = turn(behind.orientation[None], ahead.orientation[None])[0] / (2 * STEP)
    return difference


def _row(state: GuideState, rest: np.ndarray) -> np.ndarray:
    force = state.contact_forces if len(state.contact_forces) else np.zeros(1)
    return np.concatenate([state.tip + rest, np.zeros(3), state.shortenings, force])


def turn(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Small turns from first to second quaternions, shapes (n, 4), about the second's axes, shape (n, 3) [rad]."""
    w, x, y, z = first.T
    conjugate = np.moveaxis(np.array([[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]]), 2, 0)
    relative = np.einsum("nij,nj->ni", conjugate, second)
    return 2 * relative[:, 1:] * np.sign(relative[:, :1])

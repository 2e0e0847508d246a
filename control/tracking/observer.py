"""Gains of feedback from late and noisy tip readings: a Kalman filter along a plan, and optimal state feedback.

The filter estimates the states x and the disturbances E w. These are a random walk, and the relative errors of the
plan's stiffness and inertia.
"""

from typing import NamedTuple

import numpy as np

from control.tracking.linearised import Linearised
from control.tracking.regulator import regulator
from rom.brief import brief

SHARE = 0.1  # relative standard deviation of stiffness and inertia before any reading [-]


@brief
class Feedback(NamedTuple):
    """x' = A x + B v, y = C x + D v, v = u + E w; u = -gain x - E w.

    Attributes:
        effects: E at every row, for disturbances along y and z and relative errors of stiffness and inertia, shape
            (rows, 2, 4).
        observer: gain from the error of a predicted reading to corrections of x and w, shape (rows, n + 4, 2).
        gain: of the state feedback, shape (2, n).
    """

    effects: np.ndarray
    observer: np.ndarray
    gain: np.ndarray


def feedback(system: Linearised, shares: np.ndarray, noise: float, drift: float, effort: float) -> Feedback:
    """Minimise the mean square of tip error and effort.

    Args:
        system: linear model of the finger.
        shares: displacements of the tip per relative error of stiffness and inertia, shape (rows, 2, 2) [m].
        noise: standard deviation of a reading [m].
        drift: standard deviation of the disturbance's change in a period [m].
        effort: weight of u^2 over that of y^2 [-].
    """
    a, b, c, d = system[:4]
    n = len(a)
    effects = np.concatenate([np.broadcast_to(np.eye(2), shares.shape), shares], axis=2)
    walk, spread = np.zeros((n + 4, n + 4)), np.zeros((n + 4, n + 4))
    walk[:n, :n], walk[n : n + 2, n : n + 2] = b @ b.T, np.eye(2)
    walk *= (drift / noise) ** 2
    spread[n + 2 :, n + 2 :] = (SHARE / noise) ** 2 * np.eye(2)
    observer, ahead = np.empty((len(effects), n + 4, 2)), np.eye(n + 4)
    ahead[:n, :n] = a
    for k, effect in enumerate(effects):
        reading = np.hstack([c, d @ effect])
        observer[k] = np.linalg.solve(reading @ spread @ reading.T + np.eye(2), reading @ spread).T
        ahead[:n, n:] = b @ effect
        spread = ahead @ (spread - observer[k] @ reading @ spread) @ ahead.T + walk
        spread = (spread + spread.T) / 2
    return Feedback(effects, observer, regulator(system, effort)[0])

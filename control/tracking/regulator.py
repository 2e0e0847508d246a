"""The linear-quadratic regulator of a linearised finger, and its inputs for outputs that are set in advance."""

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.signal import lfilter

from control.tracking.linearised import Linearised

LONGER = 64  # rows after the last, with its output


def regulator(system: Linearised, effort: float) -> tuple[np.ndarray, np.ndarray]:
    """Gain K of u = -K x with the least sum of |y|^2 + effort |u|^2, shape (2, n), and the cost's Hessian by u."""
    a, b, c, d = system[:4]
    weight, cross = d.T @ d + effort * np.eye(2), c.T @ d
    cost = solve_discrete_are(a, b, c.T @ c, weight, s=cross)
    hessian = weight + b.T @ cost @ b
    return np.linalg.solve(hessian, b.T @ cost @ a + cross.T), hessian


def inputs(system: Linearised, outputs: np.ndarray, effort: float) -> np.ndarray:
    """Inputs u from rest with the least sum of |y - r|^2 + effort |u|^2, for outputs r, both of shape (n, 2) [m].

    A backward pass prepares for all later outputs (Anderson and Moore, Optimal Control, 1990, section 4.3).
    """
    a, b, c, d = system[:4]
    gain, hessian = regulator(system, effort)
    wanted = lfilter(*system.filter, np.concatenate([outputs, np.repeat(outputs[-1:], LONGER, axis=0)]), axis=0)
    later, state, found = np.zeros((len(wanted) + 1, len(a))), np.zeros(len(a)), np.empty_like(wanted)
    for k in reversed(range(len(wanted))):
        later[k] = (c - d @ gain).T @ wanted[k] + (a - b @ gain).T @ later[k + 1]
    for k, row in enumerate(wanted):
        found[k] = np.linalg.solve(hessian, b.T @ later[k + 1] + d.T @ row) - gain @ state
        state = a @ state + b @ found[k]
    return found[: len(outputs)]

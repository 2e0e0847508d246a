"""Linear model of a moving finger, from tensions to the tip, sampled at a controller's period.

The input u is the equilibrium position of the tip across the finger. The output y is its low-pass filtered position, so
that feedback does not excite high modes. `rom.MovingFinger` returns the pulse response. The eigensystem realisation
algorithm (Juang and Pappa, J. Guidance 8, 1985) computes the states.
"""

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, lfilter

from rom.brief import brief
from rom.files.checked_file import ModelError
from rom.rod.motion.moving_finger import MovingFinger
from rom.rod.touched_rod import TouchedRod

ORDER = 12  # largest number of states: two oscillations, the filter and relaxation, in two directions
RANK = 1e-9  # of singular values over the largest, below which there are no states [-]
RESPONSES = 256  # samples of the response
SAMPLES = 32  # smallest number of them in a cycle of the lowest mode
FEWEST = 32  # samples of a response at the controller's period, if that is longer
STEP = 1e-3  # of the tip, over the length of the finger [-]
CUT, HIGHEST = 1.5, 0.8  # of the filter, over the lowest natural frequency, and at most over half the sampling rate [-]
SUBSTEP = 1e-3  # longest time step of the finger [s]
PLANAR = 1e-2  # compliance across over that along, below which tendons move the tip in one direction alone [-]
ALIAS = 0.9  # over the lowest frequency: poles below this are aliases of higher modes, or relaxation [-]
LOW = 0.25  # frequency at which damping and inertia are measured, over the lowest natural one [-]


@brief
class Linearised(NamedTuple):
    """x' = A x + B u, y = C x + D u, from one period to the next; u changes linearly in a period.

    Attributes:
        a, b, c, d: shapes (n, n), (n, 2), (2, n), (2, 2).
        filter: numerator and denominator of a Butterworth filter of second order, shape (2, 3) [-].
        damping, inertia: C_eff / K_eff and M_eff / K_eff in u = y + damping y' + inertia y'' at low frequency,
            shapes (2, 2) [s, s^2].
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    filter: np.ndarray
    damping: np.ndarray
    inertia: np.ndarray


def linearised(model: TouchedRod, tensions: np.ndarray, density: float | None, period: float) -> Linearised:
    """Linearise the free finger about its equilibrium at tensions [N], shape (t,), moved inside their limits.

    The response is sampled at the controller's period, or in parts of it that resolve a cycle of the lowest mode.

    Raises:
        ModelError: no equilibrium at these tensions, see `rom.MovingFinger`, no motion about it, or too short a period.
    """
    away, t = np.full(len(model.objects), np.inf), len(tensions)
    rows = model.jacobian(np.append(tensions, away))[1:3, :t]
    size = STEP * float(model.rod.rest[0])
    changes = size * np.linalg.pinv(rows, rcond=PLANAR).T
    lower, upper = (end[:t] for end in model.limits)
    room = np.minimum(np.abs(changes).max(axis=0), (upper - lower) / 2)
    tensions = np.clip(tensions, lower + room, upper - room)  # no tendon pushes
    rest = np.append(tensions, away)
    frequency = float(MovingFinger(model, rest, density).frequencies(tensions, 1)[0])
    _require_long(period, frequency)
    parts = max(int(np.ceil(period * frequency * SAMPLES - 1e-9)), 1)
    sampling = period / parts
    substeps = int(np.ceil(sampling / SUBSTEP - 1e-9))
    pulses = []
    for change in changes:
        finger = MovingFinger(model, rest, density)
        steps = np.array(
            [
                _tip(finger, tensions + min(k / substeps, 1.0) * change, away, sampling / substeps)
                for k in range(1, 1 + substeps * RESPONSES)
            ]
        )[substeps - 1 :: substeps]
        if not np.isfinite(steps).all():
            raise ModelError(
                "path must have a middle about which the finger moves in its domain, got one by tensions "
                f"{tensions.tolist()} N"
            )
        begun = np.asarray(model.evaluate(rest).tip)[1:]
        pulses.append(np.diff(steps - begun, axis=0, prepend=0.0) / size)
    return realised(np.stack(pulses, axis=-1), period, frequency, parts)


def _require_long(period: float, frequency: float) -> None:
    """Raise unless a response lasts as long as a mode of the lowest frequency [Hz]."""
    shortest = 1 / (RESPONSES * frequency)
    if period < shortest:
        raise ModelError(
            f"period must be at least {shortest:.2g} s, {RESPONSES} of which last as long as the finger's lowest mode, "
            f"got {period:g}"
        )


def realised(pulses: np.ndarray, period: float, frequency: float, parts: int = 1) -> Linearised:
    """Compute the system at a period [s] from a pulse response sampled in parts of it.

    Args:
        pulses: shape (samples, 2, 2) [-].
        period: of the controller [s].
        frequency: the finger's lowest [Hz].
        parts: samples in a period.
    """
    a, b, c, d = _states(pulses)
    sampling = period / parts
    angles = np.abs(np.angle(np.linalg.eigvals(a)))
    lowest = float(angles[angles > ALIAS * 2 * np.pi * frequency * sampling].min(initial=np.pi))
    turn = LOW * lowest
    slow, still = (
        np.linalg.pinv(c @ np.linalg.solve(np.exp(1j * one) * np.eye(len(a)) - a, b) + d, rcond=PLANAR)
        for one in (turn, 0.0)
    )
    damping, inertia = slow.imag * sampling / turn, (still - slow).real * (sampling / turn) ** 2
    low_pass = np.array(butter(2, min(CUT * lowest * parts / np.pi, HIGHEST)))
    if parts > 1:
        pulses = _resampled((a, b, c, d), parts, max(len(pulses) // parts, FEWEST))
    return Linearised(*_states(lfilter(*low_pass, pulses, axis=0)), low_pass, damping, inertia)


def _resampled(system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], parts: int, count: int) -> np.ndarray:
    """Responses to an input that rises in one period of several parts and falls in the next, shape (count, 2, 2)."""
    a, b, c, d = system
    steps = np.arange(1, parts * count + 1)
    state, found = np.zeros(b.shape), np.empty((len(steps), 2, 2))
    for k, share in enumerate(np.maximum(1 - np.abs(steps - parts) / parts, 0.0)):
        found[k] = c @ state + share * d
        state = a @ state + share * b
    return found[parts - 1 :: parts]


def _states(pulses: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A, B, C and D from the Hankel matrices of a pulse response."""
    half = len(pulses) // 2 - 1
    known, shifted = (np.block([[pulses[i + j + k] for j in range(half)] for i in range(half)]) for k in (1, 2))
    left, values, right = np.linalg.svd(known)
    order = min(ORDER, int((values > RANK * values[0]).sum()))
    root = np.sqrt(values[:order])
    left, right = left[:, :order], right[:order]
    a = (left.T @ shifted @ right.T) / np.outer(root, root)
    return a, root[:, None] * right[:, :2], left[:2] * root, pulses[0]


def _tip(finger: MovingFinger, tensions: np.ndarray, away: np.ndarray, length: float) -> np.ndarray:
    """Position of the tip across the finger after a time step, shape (2,) [m]."""
    return finger.step(np.append(tensions, away), length).tip[1:]

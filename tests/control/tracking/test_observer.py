"""The filter finds a constant disturbance and wrong shares exactly; the state feedback damps."""

import numpy as np

from control.tracking.linearised import Linearised
from control.tracking.observer import feedback

TURN = 0.1  # of an undamped oscillation in a period [rad]


def oscillating() -> Linearised:
    """One undamped oscillation in each direction, of unit stiffness."""
    one = np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]])
    a, b = np.kron(np.eye(2), one), np.kron(np.eye(2), (np.eye(2) - one) @ [[1.0], [0.0]])
    c, none = np.kron(np.eye(2), [[1.0, 0.0]]), np.zeros((2, 2))
    return Linearised(a, b, c, none, np.zeros((2, 3)), none, none)


def test_disturbance_and_shares_are_found_from_readings_without_noise():
    system, rows = oscillating(), 600
    angle = 0.03 * np.arange(rows)[:, None, None]
    shares = np.concatenate([np.cos(angle), np.sin(2 * angle)], axis=2) * [[1.0, -1.0], [0.5, 2.0]]
    found = feedback(system, shares, noise=1e-5, drift=1e-7, effort=1.0)
    true = np.array([1e-3, -2e-3, 0.07, -0.04])
    state, ours, unknown = np.zeros(4), np.zeros(4), np.zeros(4)
    for k in range(rows):
        change = found.observer[k] @ (system.c @ state - system.c @ ours)
        ours, unknown = ours + change[:4], unknown + change[4:]
        state = system.a @ state + system.b @ found.effects[k] @ true
        ours = system.a @ ours + system.b @ found.effects[k] @ unknown
    assert np.abs(unknown / true - 1).max() < 0.05


def test_the_state_feedback_damps_what_swings_undamped():
    system = oscillating()
    found = feedback(system, np.zeros((2, 2, 2)), noise=1e-5, drift=1e-5, effort=1.0)
    assert np.isclose(np.abs(np.linalg.eigvals(system.a)).max(), 1.0)
    assert np.abs(np.linalg.eigvals(system.a - system.b @ found.gain)).max() < 0.98

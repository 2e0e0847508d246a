"""Inputs that are computed in advance lead an oscillator's output along its wanted one."""

import numpy as np
from scipy.signal import butter, lfilter

from control.tracking.linearised import Linearised
from control.tracking.regulator import inputs

TURN = 0.1  # of an undamped oscillation in a period [rad]


def test_outputs_of_the_inputs_are_the_wanted_ones_before_and_after_a_jump_of_acceleration():
    one = np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]])
    a, b = np.kron(np.eye(2), one), np.kron(np.eye(2), (np.eye(2) - one) @ [[1.0], [0.0]])
    none, low_pass = np.zeros((2, 2)), np.array(butter(2, 0.9))
    system = Linearised(a, b, np.kron(np.eye(2), [[1.0, 0.0]]), none, low_pass, none, none)
    time = np.arange(300)
    wanted = np.column_stack([np.where(time > 50, 1 - np.cos(0.05 * (time - 50)), 0.0), np.sin(0.02 * time) ** 2])
    state, outputs = np.zeros(4), np.empty((300, 2))
    for k, row in enumerate(inputs(system, wanted, 1e-6)):
        outputs[k] = system.c @ state
        state = a @ state + b @ row
    assert np.abs(outputs - lfilter(*low_pass, wanted, axis=0)).max() < 0.01

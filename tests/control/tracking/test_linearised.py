"""The realised system against the closed form of two oscillators in each of two directions."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, cont2discrete

import rom
from control.tracking.linearised import HIGHEST, RESPONSES, linearised, realised

PERIOD, SHARES = 1e-3, np.array([0.9, 0.1])
ANGULAR = 2 * np.pi * np.array([[9.0, 50.0], [11.0, 60.0]])  # of both modes in both directions [rad/s]


def pulses(angular: np.ndarray) -> np.ndarray:
    """Pulse response of modes with y_i'' = w_i^2 (a_i u - y_i), whose input changes linearly in a period."""
    a, b = np.zeros((4, 4)), np.zeros((4, 1))
    for k, (w, share) in enumerate(zip(angular, SHARES, strict=True)):
        a[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[0, 1], [-(w**2), 0]]
        b[2 * k + 1] = w**2 * share
    c = np.array([[1.0, 0, 1, 0]])
    one, two, three, four, _ = cont2discrete((a, b, c, np.zeros((1, 1))), PERIOD, "foh")
    found, state = [four.item()], two
    for _ in range(255):
        found.append((three @ state).item())
        state = one @ state
    return np.array(found)


def frequencies(system) -> np.ndarray:
    """Frequencies of the poles that are hardly damped, without the filter's [rad/s]."""
    poles = np.linalg.eigvals(system.a)
    return np.sort(np.abs(np.angle(poles[np.abs(poles) > 0.98]))) / PERIOD


def test_poles_and_inertia_are_those_of_the_oscillators():
    response = np.zeros((256, 2, 2))
    for k in range(2):
        response[:, k, k] = pulses(ANGULAR[k])
    found = realised(response, PERIOD, ANGULAR.min() / (2 * np.pi))
    assert frequencies(found)[:4] == pytest.approx(np.repeat(ANGULAR[:, 0], 2), rel=0.02)
    assert found.inertia == pytest.approx(np.diag((SHARES / ANGULAR**2).sum(axis=1)), rel=0.02, abs=1e-6)


def test_the_bundled_finger_has_the_frequency_of_its_modes():
    found = linearised(rom.load(), np.zeros(2) + 1.0, 1100.0, PERIOD)
    assert frequencies(found)[0] / (2 * np.pi) == pytest.approx(49.5, rel=0.02)  # fingerfem modes, straight
    assert np.abs(np.linalg.eigvals(found.a)).max() < 1.001


def test_a_slack_tendon_and_tendons_of_one_direction_change_little():
    """Steps of a tension that is 0 must not make it negative; along z nothing can be pulled."""
    finger = rom.load("round")
    tendons = finger.scene["tendons"]
    two = replace(finger, rod=finger.rod.assembled(finger.scene | {"tendons": [tendons[0], tendons[2]]}))
    taut = linearised(finger, np.array([3.0, 0.1, 0.1, 0.1]), None, 5e-3).inertia[0, 0]
    for own, tensions in ((finger, [3.0, 0.1, 0.0, 0.1]), (two, [3.0, 0.0])):
        assert linearised(own, np.array(tensions), None, 5e-3).inertia[0, 0] == pytest.approx(taut, rel=0.02)
    assert np.abs(linearised(two, np.array([3.0, 0.0]), None, 5e-3).inertia[1]).max() < 1e-9


def test_an_alias_of_a_higher_mode_is_not_the_lowest():
    """At 98 N a mode of some 196 Hz, sampled at 200 Hz, has a pole at 4 Hz; the lowest mode has 63 Hz."""
    system = linearised(rom.load(), np.array([98.0, 0.0]), 1100.0, 5e-3)
    assert system.filter == pytest.approx(np.array(butter(2, HIGHEST)))  # 1.5 times 63 Hz is near half of 200 Hz


@pytest.mark.parametrize("period", [2e-2, 1e-1])
def test_a_long_period_takes_no_more_steps_and_has_the_damping_and_inertia_of_a_short_one(period, monkeypatch):
    finger, tensions, steps = rom.load("round"), np.full(4, 0.5), []
    short, step = linearised(finger, tensions, None, 5e-3), rom.MovingFinger.step
    monkeypatch.setattr(rom.MovingFinger, "step", lambda *given: steps.append(1) or step(*given))
    found = linearised(finger, tensions, None, period)
    assert len(steps) <= 2 * RESPONSES * 5
    assert found.inertia == pytest.approx(short.inertia, rel=0.02, abs=1e-8)
    assert np.abs(np.linalg.eigvals(found.a)).max() < 1.001

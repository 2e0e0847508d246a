"""The PID that tracking is compared with: it integrates within its limits, and corrects tensions that are given."""

import numpy as np
import pytest

import rom
from control import Limits, TrackingOptions
from control.tracking import PidController

PATH, OPTIONS = np.full((60, 2), 0.010), TrackingOptions(period=5e-3, density=1100.0)
AWAY = [0.047, 0.008, 0.008]  # a tip that does not come nearer [m]


@pytest.fixture(scope="module")
def finger():
    return rom.load()


def test_it_integrates_an_error_by_the_tangent_and_does_not_wind_up(finger):
    pid = PidController(finger, PATH, (0.0, 2.0, 0.0), OPTIONS, Limits(upper=22.0, rate=100.0))
    begun, pulled = pid.tensions, [pid.step(tip=AWAY) for _ in range(50)]
    tip = finger.evaluate([*pulled[0], np.inf]).tip - finger.evaluate([*begun, np.inf]).tip
    assert tip[1:] == pytest.approx(2.0 * OPTIONS.period * 0.002 * np.ones(2), rel=0.02)
    assert np.max(pulled) == 22.0 and np.abs(np.diff(pulled, axis=0)).max() <= 0.5 + 1e-9
    beyond = [0.047, 0.012, 0.012]
    assert (pid.step(tip=beyond) < 22.0).all()  # it comes back at once


def test_without_gains_it_pulls_what_is_given(finger):
    pulled = np.linspace([10.0, 12.0], [14.0, 11.0], len(PATH))
    pid = PidController(finger, PATH, (0.0, 0.0, 0.0), OPTIONS, pulled=pulled)
    while not pid.done:
        assert pid.step(tip=AWAY) == pytest.approx(pulled[pid.row])


def test_without_a_reading_its_last_error_acts_and_after_the_path_nothing_does(finger):
    pid, other = (PidController(finger, PATH[:5], (1.0, 2.0, 0.1), OPTIONS) for _ in range(2))
    pid.step(tip=AWAY), other.step(tip=AWAY)
    assert np.array_equal(pid.step(tip=[0.047, 1e300, 0.0]), other.step(tip=AWAY))  # no finger's; the path stays
    assert np.array_equal(pid.step(tip=AWAY), pid.step(tip=[0.047, 0.0, 0.0])) and pid.done


@pytest.mark.parametrize(
    ("path", "gains", "pulled", "message"),
    [
        (PATH[:2], (0.0, 1.0, 0.0), None, "path must have at least three rows of y and z"),
        (PATH, (0.0, np.nan, 0.0), None, "gains must be finite numbers"),
        (PATH, (0.0, 1.0, 0.0), np.zeros((9, 2)), r"pulled must be finite numbers \[N\] of shape \(60, 2\), got shape"),
    ],
)
def test_wrong_input_is_refused_in_a_line(finger, path, gains, pulled, message):
    with pytest.raises(ValueError, match=message):
        PidController(finger, path, gains, OPTIONS, pulled=pulled)

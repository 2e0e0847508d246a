"""Paths begin at rest, and reach their rate; their points lie where a circle's and an eight's do."""

import numpy as np
import pytest

from control.tracking import circle, eight

CENTRE, RADIUS, RATE, PERIOD = np.array([0.01, -0.02]), 0.003, 2.0, 1e-3


def test_a_circle_begins_at_rest_at_its_least_y_and_turns_at_its_rate():
    path = circle(CENTRE, RADIUS, RATE, PERIOD, 2)
    assert len(path) == 1 + 1250 and path[0] == pytest.approx(CENTRE - [RADIUS, 0])
    assert np.linalg.norm(path - CENTRE, axis=1) == pytest.approx(RADIUS)
    speeds = np.linalg.norm(np.diff(path, axis=0), axis=1) / PERIOD
    assert speeds[0] < 1e-4 and speeds[501:] == pytest.approx(2 * np.pi * RATE * RADIUS, rel=1e-4)
    assert path[1000] == pytest.approx(path[500], abs=1e-9)  # a lap takes 1 / rate


def test_an_eight_crosses_its_centre_and_is_twice_as_wide_as_high():
    path = eight(CENTRE, RADIUS, RATE, PERIOD, 2)
    assert path[0] == pytest.approx(CENTRE) and path[1000] == pytest.approx(path[500], abs=1e-9)
    assert np.ptp(path, axis=0) == pytest.approx([RADIUS, 2 * RADIUS], rel=1e-3)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((0.0, PERIOD, 1.0), "rate must"),
        ((RATE, np.nan, 1.0), "period must"),
        (("2 Hz", PERIOD, 1.0), "rate must be a finite number above 0 Hz, got '2 Hz'"),
        ((RATE, 0.2, 1.0), "laps a row, got 0.4"),
        ((RATE, PERIOD, 1e12), r"laps must be at most 2000, in 1000000 rows, got 1e\+12"),
    ],
)
def test_rates_and_periods_that_are_none_are_refused(given, message):
    with pytest.raises(ValueError, match=message):
        circle(CENTRE, RADIUS, *given)


@pytest.mark.parametrize(
    ("centre", "radius", "message"),
    [
        ([0.0, np.nan], RADIUS, "centre must"),
        (CENTRE, -RADIUS, "radius must be a finite number of at least 0 m"),
        (CENTRE, "3 mm", "radius must"),
    ],
)
def test_a_circle_is_of_finite_numbers(centre, radius, message):
    with pytest.raises(ValueError, match=message):
        eight(centre, radius, RATE, PERIOD, 1.0)

"""Contact-aligned coordinates: touch is their face s = 0, and derivatives go by the chain rule."""

import numpy as np
import pytest

from rom.fit.contact_coordinates import ContactCoordinates

WAY = ContactCoordinates.over(0.001, 0.031, np.array([0.0008, 0.02]))


def height(tensions):
    """A made-up height of a corner [m] and its derivatives."""
    a, b = tensions
    return 0.01 * np.sin(0.03 * a) + 1e-6 * a * b, np.array([3e-4 * np.cos(0.03 * a) + 1e-6 * b, 1e-6 * a])


def test_a_corner_that_is_just_touched_lies_at_s_0_whatever_the_tensions():
    for tensions in ([10.0, 5.0], [90.0, 40.0]):
        reach, _ = height(tensions)
        assert WAY.of(np.array([[*tensions, reach]]), np.array([reach]))[0, 2] == 0.0
        nearest = WAY.of(np.array([[*tensions, 0.001]]), np.array([reach]))[0, 2]
        assert 0 < nearest < 1


def test_coordinates_are_regular_where_a_corner_never_reaches_the_nearest_plane():
    assert WAY.soft >= 0.3 * 0.03
    far = WAY.of(np.array([[0.0, 0.0, 0.001]]), np.array([0.0008]))
    assert np.isfinite(far).all() and abs(far[0, 2]) < 0.1


def test_derivatives_by_the_coordinates_are_differences_at_fixed_coordinates():
    """f(F, d) = F_1 d + F_2^2: moved along one coordinate while the others stay."""
    point = np.array([40.0, 20.0, 0.005])
    reach, rising = height(point[:2])
    slopes = WAY.slopes(point[None], np.array([reach]), rising[None], np.array([[[point[2], 2 * point[1], point[0]]]]))[
        0, 0
    ]
    s = WAY.of(point[None], np.array([reach]))[0, 2]

    def f(first, second, s):
        reach, _ = height([first, second])
        d = reach - s * (reach - WAY.nearest + WAY.soft)
        return first * d + second**2

    where = np.array([point[0], point[1], s])
    for k, h in enumerate((1e-4, 1e-4, 1e-6)):
        step = h * np.eye(3)[k]
        assert slopes[k] == pytest.approx((f(*(where + step)) - f(*(where - step))) / (2 * h), rel=1e-6)

"""Contact-aligned coordinates: touch is their face s = 0."""

import numpy as np

from rom.separated.parts import ContactCoordinates

WAY = ContactCoordinates(nearest=0.001, soft=0.009)


def height(tensions):
    """A made-up height of a corner [m]."""
    a, b = tensions
    return 0.01 * np.sin(0.03 * a) + 1e-6 * a * b


def test_a_corner_that_is_just_touched_lies_at_s_0_whatever_the_tensions():
    for tensions in ([10.0, 5.0], [90.0, 40.0]):
        reach = height(tensions)
        assert WAY.of(np.array([[*tensions, reach]]), np.array([reach]))[0, 2] == 0.0
        nearest = WAY.of(np.array([[*tensions, 0.001]]), np.array([reach]))[0, 2]
        assert 0 < nearest < 1

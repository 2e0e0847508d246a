"""Indentation of rubber (rom/native/shapes/indentation.c): Hertz's contact, and no dependence on the slices."""

import numpy as np
import pytest

from rom import AmongObjects, Sphere, TouchedSegment
from tests.rom.rod.outlined import HALF, rod_of


@pytest.fixture(scope="module")
def finger():
    return TouchedSegment.load().rod


def squeezed(finger, radius, depth, aside=0.0):
    """The force of two balls that press on both sides of the straight finger, which neither bends nor moves [N]."""
    middle, half = finger.rest[0] / 2 + aside, finger.half_lengths[1]
    balls = [
        Sphere(centre=(middle, way * (half + radius), 0), direction=(0, way, 0), distances=(-0.01, 0.1), radius=radius)
        for way in (1.0, -1.0)
    ]
    answer = AmongObjects(rod=finger, obstacles=balls).evaluate([0.0, 0.0, -depth, -depth])
    assert answer.inside
    return float(answer.contact_force[0])


@pytest.mark.parametrize("radius", [0.003, 0.005])
def test_a_ball_presses_as_in_contact_of_hertz(finger, radius):
    """4/3 E/(1 - nu^2) sqrt(R) delta^(3/2) of a half-space; the finger is as thick as 10 contact radii or more."""
    material = finger.scene["material"]
    shear, bulk = 2 * material["C1"], 2 / material["D1"]
    young, poisson = 9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))
    for depth in (5e-5, 1e-4, 2e-4):
        hertz = 4 / 3 * young / (1 - poisson**2) * np.sqrt(radius) * depth**1.5
        assert squeezed(finger, radius, depth) == pytest.approx(hertz, rel=0.2)


@pytest.mark.parametrize("radius", [0.003, 0.005])
def test_a_ball_presses_on_a_circle_as_in_contact_of_hertz(radius):
    """With the mean of the curvatures across and along the finger, the square root of their product."""
    circle = rod_of("circle")
    effective = np.sqrt(radius * radius * HALF / (radius + HALF))
    young, poisson = circle.segments[0].young_modulus, circle.segments[0].poisson
    for depth in (5e-5, 1e-4, 2e-4):
        hertz = 4 / 3 * young / (1 - poisson**2) * np.sqrt(effective) * depth**1.5
        assert squeezed(circle, radius, depth) == pytest.approx(hertz, rel=0.2)


def test_the_force_does_not_depend_on_where_slices_begin(finger):
    forces = [squeezed(finger, 0.005, 1e-4, aside) for aside in np.linspace(0.0, 7e-4, 8)]
    assert np.ptp(forces) < 0.02 * np.mean(forces)
